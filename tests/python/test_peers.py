"""The solvers that the program is compared with meet the same reference values, so that times are those of the same work."""

import subprocess
import sys

import numpy as np
import pytest
from program import ROOT

PEERS = ROOT / "benches" / "peers"
sys.path.insert(0, str(PEERS))
peers = pytest.importorskip("peers")


@pytest.mark.parametrize("kind, branch", [(peers.Contact, "contact"), (peers.Before, "noncontact")])
@pytest.mark.parametrize(
    "prepare", [peers.with_brentq(1e-300, 4 * peers.EPSILON), peers.with_newton(10, None), peers.with_newton(4, 256)],
    ids=["brentq", "newton", "table"],
)
def test_the_tightest_setting_meets_every_row(kind, branch, prepare):
    with np.errstate(invalid="ignore", divide="ignore"):
        error, text = peers.worst(peers.read_reference()[branch], lambda lam, rows: prepare(kind(lam), rows.deltas)(rows.deltas))
    assert error < 5e-14 and "failed" not in text, text


@pytest.mark.parametrize("arguments", [["-o", "absent/peers.csv"], ["--stiction", "absent"], ["--unknown"]])
def test_what_cannot_be_done_ends_with_2(tmp_path, arguments):
    done = subprocess.run([sys.executable, PEERS / "peers.py", *arguments], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr and "Traceback" not in done.stderr
