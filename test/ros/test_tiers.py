"""
A node without machine code: ready and serving before there is any, and the same answers after.

What these tests wait for are events, however long those take on this machine.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import shutil
from test.ros.harness import Client, grid_message, node_process, NodeProcess, points_of, pose
from test.ros.rooms import DATA, GOAL, ORIGIN, RESOLUTION, START
import time
from typing import Any

from hnr_planner.core.kernels.cache_folder import cache_folder
from hnr_planner.core.kernels.modes import VARIABLE
from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest

#: Longest time [s] that compilation may take, on any machine and beside anything else.
PATIENCE = 3600.0
#: A kernel that every request for a path calls, and that is compiled in a moment.
MISSING = '_components_of_ends'
#: No clock cuts anything here, so the same seed gives the same path.
SETTINGS = {'time_limit': PATIENCE, 'optimize_for': 0.0, 'seed': 7}
#: A search that needs few kernels.
SIMPLE = {'algorithm': 'hit_and_run', 'simplify': False}


@contextmanager
def node_with_cache(
    monkeypatch: pytest.MonkeyPatch, home: Path, log: Path, **settings: Any
) -> Iterator[tuple[NodeProcess, Client]]:
    """Run a node that compiles in the background into a cache of its own, and a client of it."""
    monkeypatch.setenv(VARIABLE, 'auto')
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(home))
    with node_process('planner_node', log, **SETTINGS, **settings) as planner:
        client = Client()
        try:
            client.publish_map(grid_message(DATA, RESOLUTION, ORIGIN))
            planner.wait_for('map received')
            yield planner, client
        finally:
            client.close()


def solved(client: Client) -> tuple[np.ndarray, dict[str, str]]:
    """Ask for a path from room to room; return its points (n, 2) and the outcome's values."""
    path = client.plan(pose(*START), pose(*GOAL))
    outcome, values = client.outcome_of(path)
    assert outcome is Outcome.SOLVED, values['why']
    assert values['cut_by_time'] == 'false'
    return points_of(path), values


def ask_until_compiled(client: Client, first: np.ndarray) -> None:
    """
    Ask the same until machine code responds; every path on the way is the first one.

    The pauses leave the processor to the compiler.
    """
    deadline = time.monotonic() + PATIENCE
    tier = 'interpreted'
    while tier == 'interpreted':
        assert time.monotonic() < deadline, 'the compilation takes too long'
        time.sleep(0.2)
        path, values = solved(client)
        assert np.array_equal(path, first)
        tier = values['tier']


def lines(planner: NodeProcess, words: str) -> list[str]:
    """Return the lines of the log that have some words in them."""
    return [line for line in planner.log.splitlines() if words in line]


@pytest.mark.sweep
def test_node_without_machine_code_serves_before_it_is_compiled(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    cache, log = tmp_path / 'cache', tmp_path / 'log'
    with node_with_cache(monkeypatch, cache, log, **SIMPLE) as (planner, client):
        first, values = solved(client)
        assert values['tier'] == 'interpreted'
        # What the request has asked for comes first, long before all the rest.
        ask_until_compiled(client, first)
        health = client.wait_for_health(lambda values: True, 'a report of health')
        assert int(health['kernels_compiled']) > 0 and health['kernels_failed'] == '0'
        (line,) = lines(planner, 'compilation of kernels runs in the background')
        assert '[INFO]' in line


def test_compilation_that_is_done_is_in_the_log_and_in_the_health(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """All but one kernel is compiled already, so that it is done soon."""
    cache = tmp_path / 'cache' / 'hnr_planner' / cache_folder().name
    missing = f'*{MISSING}*'
    shutil.copytree(cache_folder(), cache, ignore=shutil.ignore_patterns(missing))
    assert list(cache_folder().rglob(missing)) and not list(cache.rglob(missing))
    with node_with_cache(monkeypatch, tmp_path / 'cache', tmp_path / 'log') as (planner, client):
        first, values = solved(client)
        assert values['tier'] == 'interpreted'
        health = client.wait_for_health(
            lambda values: values['tier'] == 'compiled', 'the end of the compilation', PATIENCE
        )
        assert int(health['kernels_compiled']) > 0
        assert (health['kernels_pending'], health['kernels_failed']) == ('0', '0')
        assert float(health['compilation_time']) > 0.0
        path, values = solved(client)
        assert values['tier'] == 'compiled'
        assert np.array_equal(path, first)
        planner.wait_for('compilation is done', PATIENCE)
        for words in ('compilation of kernels runs in the background', 'compilation is done'):
            (line,) = lines(planner, words)
            assert '[INFO]' in line
