"""SIGINT and SIGTERM, whenever they come: exit code 0, at once, and an orderly log."""

from pathlib import Path
import signal
from signal import SIGINT, SIGTERM
from test.ros.harness import (
    Client,
    grid_message,
    maze,
    node_process,
    NodeProcess,
    pose,
    result_of,
    SOON,
)
from test.sweeps import sweep
import time

from hnr_planner.server.requests.outcomes import Outcome
import pytest

# One handler takes both.
BOTH = [(SIGINT,), (SIGTERM,)]
TWICE = [(SIGINT, SIGINT), (SIGINT, SIGTERM)]

#: Seconds: much less than a search would last, enough for a busy machine.
AT_ONCE = 10.0


def assert_clean_end(process: NodeProcess, *signals: signal.Signals) -> None:
    """Send signals and hold the process to a clean and prompt end."""
    began = time.monotonic()
    assert process.end(*signals) == 0, process.log
    assert time.monotonic() - began < AT_ONCE
    for word in ('Traceback', 'Error', 'Exception', 'exception', 'ignored'):
        assert word not in process.log, process.log


@pytest.mark.parametrize('signals', [BOTH[0], sweep(BOTH[1])])
def test_idle_node_ends_cleanly(tmp_path: Path, signals: tuple[signal.Signals, ...]) -> None:
    with node_process('planner_node', tmp_path / 'log') as process:
        assert_clean_end(process, *signals)


@pytest.mark.parametrize('signals', [sweep(BOTH[0]), BOTH[1], TWICE[0], sweep(TWICE[1])])
def test_searching_node_answers_and_ends_cleanly(
    tmp_path: Path, signals: tuple[signal.Signals, ...]
) -> None:
    with node_process('planner_node', tmp_path / 'log', time_limit=60.0) as process:
        client = Client()
        try:
            client.publish_map(grid_message(maze()))
            process.wait_for('map received')
            start, goal = pose(0.025, 0.025), pose(20, 20)
            # Discovery is over when everything about a first request has arrived.
            client.outcome_of(client.plan(start, start))
            futures = [client.send_plan(start, goal, 'plan_hit_and_run') for _ in range(3)]
            client.wait_for_running(len(futures))
            assert_clean_end(process, *signals)
            for future in futures:
                path = result_of(future).plan
                assert path.poses == []
                assert client.outcome_of(path)[0] is Outcome.CANCELLED
        finally:
            client.close()


@pytest.mark.parametrize('signals', [BOTH[0], sweep(BOTH[1])])
def test_node_that_was_just_started_ends_cleanly(
    tmp_path: Path, signals: tuple[signal.Signals, ...]
) -> None:
    with node_process('planner_node', tmp_path / 'log', ready='preparing') as process:
        assert_clean_end(process, *signals)


def test_parameter_that_cannot_be_ends_the_start_with_one_line(tmp_path: Path) -> None:
    with node_process('planner_node', tmp_path / 'log', ready='[FATAL]', time_limit=-1.0) as bad:
        assert bad.popen.wait(SOON) == 1
        (line,) = (line for line in bad.log.splitlines() if '[FATAL]' in line)
        assert 'time_limit' in line and '-1' in line
        assert 'Traceback' not in bad.log


@pytest.mark.parametrize(
    ('module', 'arguments', 'words'),
    [
        ('map_node', ('-p', 'yaml_filename:=5'), "'yaml_filename' to '5' of type 'INTEGER'"),
        sweep('map_node', ('-p', 'frame_id:=3'), "'frame_id' to '3' of type 'INTEGER'"),
        ('planner_node', ('-p', 'use_sim_time:=5'), "'use_sim_time' to '5' of type 'INTEGER'"),
        ('planner_node', ('--foo',), "unknown arguments after --ros-args: ['--foo']"),
        ('planner_node', ('-p', 'time_limit:=soon'), "parameter 'time_limit'"),
    ],
)
def test_wrong_arguments_end_the_start_with_one_line(
    tmp_path: Path, module: str, arguments: tuple[str, ...], words: str
) -> None:
    with node_process(module, tmp_path / 'log', '[FATAL]', *arguments) as process:
        assert process.popen.wait(SOON) == 1
        lines = [line for line in process.log.splitlines() if '[INFO]' not in line]
        assert len(lines) == 1 and words in lines[0], process.log
