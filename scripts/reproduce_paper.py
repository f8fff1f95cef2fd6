"""The figures and numbers of the publication that the model comes from, computed anew.

Shi and Polycarpou, J. Colloid Interface Sci. 290 (2005) 514: figures 1, 2 and 4 to 9 (3 is a sketch) as
figure_N.svg, and reproduction.csv with a row for every number and checkable statement of its text: the
paper's value, the direct solution's, that of the paper's curve fits, whether they agree to the tolerance of
the row, and the reason where they do not. The scenes are in configs/paper; the results of `stiction compare`
stay in the folder, as .h5.

Usage:
    cargo build --release
    python scripts/reproduce_paper.py [-o FOLDER] [--program PATH] [--keep] [--replicas N]

The program is target/release/stiction of this repository, unless the variable STICTION or --program names
another. It takes two minutes on two cores; --keep draws from the .h5 that are there.
Exit codes: 0 done, also when numbers differ from the paper; 2 the program is missing or failed, or a file
cannot be written.
"""

import argparse
import os
import sys
from pathlib import Path

from paper.data import PaperError, Program, compare_all
from paper.figures import draw_all
from paper.statements import all_rows, check_closed_forms, table, write

ROOT = Path(__file__).resolve().parent.parent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("reproduction"), metavar="FOLDER",
                        help="where everything goes, default reproduction/")
    parser.add_argument("--program", type=Path, metavar="PATH",
                        help="default: $STICTION, or target/release/stiction")
    parser.add_argument("--keep", action="store_true", help="use the .h5 files that are in the folder")
    parser.add_argument("--replicas", type=int, metavar="N",
                        help="of the scatter bands, default: as in the scenes")
    arguments = parser.parse_args()
    path = arguments.program or Path(os.environ.get("STICTION") or ROOT / "target" / "release" / "stiction")
    try:
        arguments.output.mkdir(parents=True, exist_ok=True)
        program = Program(path, ROOT / "configs" / "paper", arguments.output, arguments.keep,
                          arguments.replicas)
        runs = compare_all(program)
        print(check_closed_forms(program, runs))
        rows = all_rows(program, runs)
        write(rows, arguments.output / "reproduction.csv")
        print(table(rows))
        draw_all(program, runs)
    except (PaperError, OSError, ValueError) as error:
        print("reproduce_paper:", *str(error).split(), file=sys.stderr)
        return 2
    print(arguments.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
