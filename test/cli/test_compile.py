"""The command ``compile``."""

from collections.abc import Callable
from pathlib import Path
import re
from test.cli.conftest import at, Ran, run_process

from hnr_planner.maps import OccupancyMap
import pytest


@pytest.mark.sweep
@pytest.mark.usefixtures('compiled')
def test_it_compiles_what_is_missing_and_says_how_much(run: Callable[..., Ran]) -> None:
    """All kernels of all uses: the tests do with less."""
    ran = run('compile')
    assert ran.code == 0
    first, *_, last = ran.out.splitlines()
    assert Path(first.removeprefix('compiling into ')).is_dir()
    ready = re.fullmatch(r'(\d+) kernels ready, (\d+) of them compiled now, \d+ s', last)
    assert ready is not None and int(ready[1]) > 50
    again = run('compile')
    assert f'{ready[1]} kernels ready, 0 of them compiled now' in again.out


def test_a_command_that_ran_interpreted_names_the_remedy(
    rooms_file: Path, rooms: OccupancyMap, tmp_path: Path
) -> None:
    ends = ['--start', *at(rooms, 5, 5), '--goal', *at(rooms, 8, 75)]
    command = ['plan', rooms_file, *ends, '--time-limit', 600]
    ran = run_process(*command, HNR_PLANNER_KERNELS='auto', NUMBA_CACHE_DIR=str(tmp_path))
    assert ran.code == 0
    assert ran.err.startswith('note: this ran interpreted') and ran.err.count('\n') == 1
    assert 'python3 -m hnr_planner compile' in ran.err


def test_a_cache_that_cannot_be_kept_is_an_error(tmp_path: Path) -> None:
    ran = run_process('compile', NUMBA_CACHE_DIR='/proc/nowhere', TMPDIR=str(tmp_path))
    assert (ran.code, ran.out) == (2, '')
    assert 'the cache folder cannot be written' in ran.err.splitlines()[-1]


@pytest.mark.parametrize(
    'switch', [{'NUMBA_DISABLE_JIT': '1'}, {'HNR_PLANNER_KERNELS': 'interpreted'}]
)
def test_compilation_that_is_switched_off_is_an_error(switch: dict[str, str]) -> None:
    ran = run_process('compile', **switch)
    assert (ran.code, ran.out) == (2, '')
    assert ran.err.startswith('error: compilation is switched off')
