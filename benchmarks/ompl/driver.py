"""Run OMPL's programs; ``planners.cpp`` describes the protocol."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FOLDER = Path(__file__).parent
BUILD = Path(__file__).resolve().parents[2] / 'build' / 'benchmarks'
INSTALL = 'sudo apt install g++ pkg-config libompl-dev'
SEED = '1'


class MissingOmpl(Exception):
    """OMPL's planners cannot run here; the message says what is missing."""


class Answer(NamedTuple):
    """Seconds of setup and solve, and the path (m, dim), in cells on grids; (0, dim) for none."""

    seconds: float
    path: Floats


def native(name: str = 'planners') -> list[str]:
    """Return the command of a C++ program, compiled if necessary, or raise MissingOmpl."""
    program, source = BUILD / name, FOLDER / f'{name}.cpp'
    for tool in ('g++', 'pkg-config'):
        if shutil.which(tool) is None:
            raise MissingOmpl(f'OMPL in C++: {tool} is missing ({INSTALL})')
    newest = max(file.stat().st_mtime for file in FOLDER.glob('*.[ch]pp'))
    if not program.exists() or program.stat().st_mtime < newest:
        # Debian's --libs name libraries of Boost that are not there: the one library is enough.
        flags = _output(['pkg-config', '--cflags', 'ompl']).split()
        BUILD.mkdir(parents=True, exist_ok=True)
        _output(['g++', '-std=c++17', '-O3', str(source), *flags, '-lompl', '-o', str(program)])
    return [str(program), SEED]


def native_version() -> str:
    """Return the version of the C++ library, or raise MissingOmpl."""
    return _output(['pkg-config', '--modversion', 'ompl']).strip()


def _output(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise MissingOmpl(
            f'OMPL in C++: version 1.5 or later is missing ({INSTALL})\n{done.stderr.strip()}'
        )
    return done.stdout


def wheel() -> list[str]:
    """Return the command of the program around OMPL's wheel, or raise MissingOmpl."""
    wheel_version()
    command = [sys.executable, '-m', 'benchmarks.ompl.wheel', SEED]
    done = subprocess.run(command, input='', capture_output=True, text=True)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ['it does not start'])[-1]
        raise MissingOmpl(f'OMPL from PyPI: {reason}')
    return command


def wheel_version() -> str:
    """Return the version of the wheel, or raise MissingOmpl."""
    try:
        return metadata.version('ompl')
    except metadata.PackageNotFoundError:
        raise MissingOmpl('OMPL from PyPI: pip install ompl') from None


class Session:
    """A running program that solves requests, on one grid after another."""

    def __init__(self, command: list[str]) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._file = Path(self._folder.name) / 'grid'
        self._blocked: NDArray[np.bool_] | None = None
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def use(self, blocked: NDArray[np.bool_]) -> None:
        """Set the grid (rows, columns) of the next requests; its rim is blocked."""
        if blocked is self._blocked:
            return
        write_grid(self._file, blocked)
        self._say(f'grid {self._file}')
        self._blocked = blocked

    def solve(self, planner: str, seconds: float, requests: Sequence[Floats]) -> list[Answer]:
        """Solve requests, each (2, 2) in cells: start and goal."""
        for request in requests:
            numbers = ' '.join(f'{value:.17g}' for value in (seconds, *request.ravel()))
            self._say(f'{planner} {numbers}')
        return [self._answer() for _ in requests]

    def close(self) -> None:
        """End the program."""
        self._process.communicate()
        self._folder.cleanup()

    def _say(self, line: str) -> None:
        assert self._process.stdin
        self._process.stdin.write(f'{line}\n')
        self._process.stdin.flush()

    def _line(self) -> str:
        assert self._process.stdout
        line = self._process.stdout.readline()
        if not line:
            raise MissingOmpl(f'{self._process.args} ended with {self._process.wait()}')
        return line

    def _answer(self) -> Answer:
        seconds, _, *numbers = self._line().split()
        return Answer(float(seconds), np.array(numbers, dtype=float).reshape(-1, 2))


def write_grid(file: Path, blocked: NDArray[np.bool_]) -> None:
    """Write a grid (rows, columns) as the programs read it."""
    with file.open('wb') as stream:
        np.array(blocked.shape, dtype=np.int32).tofile(stream)
        blocked.astype(np.uint8).tofile(stream)


def read_grid(file: str) -> NDArray[np.bool_]:
    """Read what ``write_grid`` has written."""
    with open(file, 'rb') as stream:
        shape = np.fromfile(stream, dtype=np.int32, count=2)
        return np.fromfile(stream, dtype=np.uint8).reshape(shape) != 0
