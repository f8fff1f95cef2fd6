"""Will a pad stick? Its pull-off after a preload, and the probability that it holds against a restoring force.

Usage: python scripts/plot_pad.py [-o OUT.svg]      runs the template mems-pad of `stiction new`, half a minute

The figures `preloads` and `stuck` of the package, of more preloads than the template has.
"""

import tempfile
from pathlib import Path

from drawing import DOCS, open_run, options, run, save

from stiction.plot import page

PRELOADS = (10, 15, 22, 33, 47, 68, 100, 150, 220, 330, 470, 680, 1000)  # uN

if __name__ == "__main__":
    arguments = options(__doc__, DOCS / "pad.svg").parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene, output = Path(folder, "pad.toml"), Path(folder, "pad.h5")
        run("new", scene, "--template", "mems-pad")
        values = ", ".join(f'"{preload} uN"' for preload in PRELOADS)
        run("run", scene, "--set", f"instability.preload=[{values}]", "--above", "100 nN", "--replicas", 400,
            "--quiet", "-o", output)
        with open_run(output) as pad:
            save(page(pad, "95mm", what=["preloads", "stuck"]), arguments.output, arguments.dpi)
