"""Processes of their own, in mode ``auto`` and with an empty cache, for tests of the tiers."""

from collections.abc import Callable, Iterator
import os
from pathlib import Path
import subprocess
import sys
import textwrap
from typing import TypeAlias

import pytest

Start: TypeAlias = Callable[..., 'subprocess.Popen[str]']

#: Time [s] after which a test that waits for something has failed.
PATIENCE = 600.0
ROOT = Path(__file__).resolve().parents[3]

PREPARATION = """
import logging, sys, time
logging.basicConfig(level=logging.INFO, format='LOG %(levelname)s %(message)s', stream=sys.stdout)
from hnr_planner.core.kernels import compilation
from hnr_planner.core.kernels.kernel import interpreted_calls
from test.core.kernels import samples

def wait(condition):
    end = time.monotonic() + 600.0
    while not condition():
        assert time.monotonic() < end, compilation.status()
        time.sleep(0.01)

def say(*words):
    sys.stdout.write(' '.join(map(str, words)) + '\\n')  # in one piece: threads write log lines
    sys.stdout.flush()
"""


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Return a function that starts a script in mode ``auto``; its output is a pipe of lines."""
    started: list[subprocess.Popen[str]] = []

    def start(script: str, **variables: str) -> 'subprocess.Popen[str]':
        environment = {
            **os.environ,
            'HNR_PLANNER_KERNELS': 'auto',
            'NUMBA_CACHE_DIR': str(tmp_path / 'cache'),
            'PYTHONPATH': str(ROOT),
            'HNR_TEST_GATE': str(tmp_path),
            **variables,
        }
        process = subprocess.Popen(
            [sys.executable, '-c', PREPARATION + textwrap.dedent(script)],
            cwd=tmp_path,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


def output(process: 'subprocess.Popen[str]') -> list[str]:
    """Return the lines that a script has still to print; fail if it failed."""
    text, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, text
    return text.splitlines()


def next_line(process: 'subprocess.Popen[str]', beginning: str) -> str:
    """Return the rest of the next line that begins so, skipping others."""
    assert process.stdout is not None
    seen = []
    for line in process.stdout:
        if line.startswith(beginning):
            return line.removeprefix(beginning).strip()
        seen.append(line)
    raise AssertionError(f'no line begins with {beginning!r}: {"".join(seen)}')
