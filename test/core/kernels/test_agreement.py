"""Both tiers of every kernel that Python calls give the same result, to the last bit."""

import os
from pathlib import Path
import subprocess
import sys
from test.core.kernels.replays import Replay, WORKLOADS, ZEROED

from hnr_planner.core.kernels.kernel import kernel
import numpy as np
import pytest


def run(*command: str, **environment: str) -> list[str]:
    """Run Python, in mode ``compiled``; return the lines it prints."""
    done = subprocess.run(
        [sys.executable, *command],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.sweep
def test_both_tiers_agree_on_every_call():
    """One process replays all: to import and to load machine code takes longer than most of it."""
    assert run('-m', 'test.core.kernels.replays', **ZEROED) == list(WORKLOADS)


NEEDED = """
import sys
from hnr_planner.core.kernels.kernel import calls_of
from hnr_planner.core.kernels.modes import Mode
from hnr_planner.core.warming import USES

for use in USES.values():
    calls = calls_of(use.run, Mode(sys.argv[1]))
for kernel, signature in calls:
    print('NEEDS', kernel.__module__, kernel.__qualname__, *map(str, signature))
"""


def needed(tier: str, **environment: str) -> set[str]:
    """Return what the uses of the package need, as found by calls of one tier."""
    lines = run('-c', NEEDED, tier, **environment)
    return {line for line in lines if line.startswith('NEEDS')}


@pytest.mark.sweep
def test_both_tiers_need_the_same_machine_code(tmp_path: Path):
    """What is compiled ahead is found by interpreted calls, with nothing in the cache."""
    found = needed('auto', NUMBA_CACHE_DIR=str(tmp_path))
    assert found == needed('compiled')


@kernel
def _pull(x):
    return 2.0 * x


def test_a_difference_in_the_last_bit_is_found(monkeypatch: pytest.MonkeyPatch):
    """Show that the tests above can fail."""
    pull = Replay(_pull)
    assert pull(0.1) == 0.2
    monkeypatch.setitem(vars(_pull), 'interpreted_form', lambda x: np.nextafter(2.0 * x, 1.0))
    with pytest.raises(AssertionError):
        pull(0.1)
