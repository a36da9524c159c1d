"""Build the C++ program and talk to it; what is said is described in ``planners.cpp``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
import shutil
import subprocess
import tempfile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SOURCE = Path(__file__).with_name('planners.cpp')
PROGRAM = Path(__file__).resolve().parents[2] / 'build' / 'benchmarks' / 'planners'
INSTALL = 'sudo apt install g++ pkg-config libompl-dev'


class MissingOmpl(Exception):
    """OMPL's planners cannot be built here; the message says what is missing."""


class Answer(NamedTuple):
    """Seconds of setup and solve, and the path (m, 2) in cells, (0, 2) for none."""

    seconds: float
    path: Floats


def build() -> Path:
    """Compile the program where that has not been done, or raise MissingOmpl."""
    for tool in ('g++', 'pkg-config'):
        if shutil.which(tool) is None:
            raise MissingOmpl(f'{tool} is missing: {INSTALL}')
    if PROGRAM.exists() and PROGRAM.stat().st_mtime > SOURCE.stat().st_mtime:
        return PROGRAM
    # Debian's --libs name libraries of Boost that are not there: the one library is enough.
    flags = _output(['pkg-config', '--cflags', 'ompl']).split()
    PROGRAM.parent.mkdir(parents=True, exist_ok=True)
    command = ['g++', '-std=c++17', '-O3', str(SOURCE), *flags, '-lompl', '-o', str(PROGRAM)]
    _output(command)
    return PROGRAM


def version() -> str:
    """Return the version of OMPL, or raise MissingOmpl."""
    return _output(['pkg-config', '--modversion', 'ompl']).strip()


def _output(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise MissingOmpl(f'OMPL 1.5 or later is missing: {INSTALL}\n{done.stderr.strip()}')
    return done.stdout


class Session:
    """
    A running program with one grid.

    Parameters
    ----------
    blocked : (rows, columns) bool
        With a blocked rim.
    seed : int
        Of all requests of the session; OMPL takes it once.

    """

    def __init__(self, blocked: NDArray[np.bool_], seed: int) -> None:
        with tempfile.NamedTemporaryFile(suffix='.grid', delete=False) as file:
            np.array(blocked.shape, dtype=np.int32).tofile(file)
            blocked.astype(np.uint8).tofile(file)
        self._grid = Path(file.name)
        self._process = subprocess.Popen(
            [build(), self._grid, str(seed)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def solve(self, planner: str, seconds: float, requests: Sequence[Floats]) -> list[Answer]:
        """Solve requests, each (2, 2) in cells: start and goal."""
        assert self._process.stdin and self._process.stdout
        for request in requests:
            numbers = ' '.join(f'{value:.17g}' for value in (seconds, *request.ravel()))
            self._process.stdin.write(f'{planner} {numbers}\n')
        self._process.stdin.flush()
        return [_parse(self._process.stdout.readline()) for _ in requests]

    def close(self) -> None:
        """End the program."""
        self._process.communicate()
        self._grid.unlink()


def _parse(line: str) -> Answer:
    seconds, _, *numbers = line.split()
    return Answer(float(seconds), np.array(numbers, dtype=float).reshape(-1, 2))
