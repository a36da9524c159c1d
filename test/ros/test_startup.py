"""The start of a real node: help, parameters, warnings, the first map, and its log."""

from collections.abc import Iterator
from pathlib import Path
import re
import subprocess
import sys
from test.ros.harness import (
    Client,
    free_map,
    grid_message,
    node_process,
    NodeProcess,
    pose,
    result_of,
    two_rooms,
    until,
)

from hnr_planner.server.parameters.settings import RULES
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.request_log import LONGEST_LINE
from lifecycle_msgs.srv import GetState
import pytest

#: A file with a name that is misspelt and one that is not.
PARAMETERS = '/**/hnr_planner: {ros__parameters: {robot_radious: 0.3, map_wait: 60.0}}\n'
START, GOAL = (0.5, 0.6), (4.5, 0.7)


@pytest.fixture(scope='module')
def planner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run a node with that file."""
    folder = tmp_path_factory.mktemp('planner')
    (folder / 'own.yaml').write_text(PARAMETERS)
    arguments = '--params-file', str(folder / 'own.yaml')
    with node_process('planner_node', folder / 'log', 'ready', *arguments) as process:
        yield process


def lines(planner: NodeProcess, words: str) -> list[str]:
    """Return the lines of the log that have some words in them."""
    return [line for line in planner.log.splitlines() if words in line]


def test_help_names_every_parameter_and_prepares_nothing() -> None:
    command = [sys.executable, '-m', 'hnr_planner.ros.node.planner_node', '--help']
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith('usage: planner_node') and done.stderr == ''
    assert 'preparing' not in done.stdout
    for name, rule in RULES.items():
        entry = re.escape(name) + (re.escape(f' [{rule.unit}]') if rule.unit else '')
        assert re.search(rf'^  {entry} \(', done.stdout, re.MULTILINE), name
    assert max(map(len, done.stdout.splitlines())) < 100


def test_ready_line_states_the_radius(planner: NodeProcess) -> None:
    (line,) = lines(planner, 'ready after')
    assert 'active, robot radius 0 m: /hnr_planner/plan,' in line


def test_node_starts_itself_by_default(client: Client) -> None:
    answer = client.call(GetState, '/hnr_planner/get_state', GetState.Request())
    assert answer.current_state.label == 'active'


def test_misspelt_parameter_is_warned_about_by_name(planner: NodeProcess, tmp_path: Path) -> None:
    (line,) = lines(planner, 'there is no parameter')
    assert '[WARN]' in line and "'robot_radious'" in line and 'mean robot_radius?' in line
    chosen = {'yaml_file_name': 'x', 'use_sim_time': False}
    with node_process('map_node', tmp_path / 'log', '[FATAL]', **chosen) as process:
        assert "no parameter 'yaml_file_name'" in process.log
        assert 'use_sim_time' not in process.log


def test_request_before_the_first_map_waits_for_it(client: Client, planner: NodeProcess) -> None:
    """Stands before the others with a map."""
    client.set_parameters(time_limit=60.0)
    future = client.send_plan(pose(*START, frame=''), pose(*GOAL, frame=''))
    draws = client.send_sample()
    client.wait_for_running(2)
    assert not future.done()
    client.publish_map(grid_message(two_rooms(), frame=''))
    assert client.outcome_of(result_of(future).plan)[0] is Outcome.SOLVED
    assert result_of(draws).success


def test_point_robot_and_missing_frame_are_warned_about_once(
    client: Client, planner: NodeProcess
) -> None:
    client.publish_map(grid_message(free_map(), resolution=0.0503, frame=''))
    until(lambda: 'of 0.0503 m' in planner.log, 'another map')
    client.plan(pose(*START, frame=''), pose(*GOAL, frame=''))
    for words in ('robot_radius is 0 m', 'the map has an empty frame_id'):
        (line,) = lines(planner, words)
        assert '[WARN]' in line


def test_only_the_first_solved_request_is_an_info(client: Client, planner: NodeProcess) -> None:
    client.set_parameters(time_limit=3600.0)
    for _ in range(3):
        path = client.plan(pose(*START, frame='map'), pose(*GOAL, frame=''))
        assert client.outcome_of(path)[0] is Outcome.BAD_FRAME
        path = client.plan(pose(*START, frame=''), pose(*GOAL, frame=''), service='plan_rrt')
        assert client.outcome_of(path)[0] is Outcome.SOLVED
    solved = lines(planner, 'plan_rrt: SOLVED')
    assert len(solved) == 3 and all('[DEBUG]' in line for line in solved)
    refused = lines(planner, 'plan: BAD_FRAME')
    assert len(refused) == 3 and all('[WARN]' in line for line in refused)
    # The one before, of the request that waited for the map or of the draws.
    assert len([line for line in lines(planner, 'ED after') if '[INFO]' in line]) == 1


def test_no_line_of_the_log_is_long(planner: NodeProcess) -> None:
    """Stands last."""
    # The logger puts level, time and name before what we say.
    assert max(map(len, planner.log.splitlines())) < LONGEST_LINE + 60
