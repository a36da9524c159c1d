"""
The life of the node: every state, every transition, and what is answered in each.

The tests share a node, which each of them finds unconfigured; the last one ends it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
import signal
import subprocess
import sys
from test.ros.harness import (
    Client,
    grid_message,
    MANY,
    maze,
    node_process,
    NodeProcess,
    pose,
    result_of,
    two_rooms,
    until,
)
from test.ros.transitions import (
    ACTIVATE,
    ACTIVE,
    change,
    CLEANUP,
    CONFIGURE,
    DEACTIVATE,
    FINALIZED,
    INACTIVE,
    SHUTDOWN,
    state,
    UNCONFIGURED,
    WAY_BACK,
)

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.server.requests.outcomes import Outcome
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
import pytest

START, GOAL = pose(0.5, 0.6), pose(4.5, 0.7)
#: Draws that take hours, and so end by a cancellation; and the usual ones.
ENDLESS = {'sample_count': 1_000_000, 'sample_thin': 100_000, 'time_limit': 60.0}
USUAL = {'sample_count': 1000, 'sample_thin': 1, 'time_limit': 1.0}


@pytest.fixture(scope='module')
def planner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run a planning node that waits for transitions from outside."""
    log = tmp_path_factory.mktemp('planner') / 'log'
    with node_process('planner_node', log, autostart=False) as process:
        yield process


@pytest.fixture(autouse=True)
def unconfigured(client: Client) -> None:
    """Lead the node back from where the test before left it."""
    assert all(change(client, *WAY_BACK[state(client)]))


def outcome(client: Client) -> Outcome:
    """Ask for a path and return how that ended."""
    return client.outcome_of(client.plan(START, GOAL))[0]


def outcome_of_both(client: Client) -> Outcome:
    """Ask for a path and for draws, which end alike, and return how."""
    ended, answer = outcome(client), client.sample()
    sampled = client.outcome_of(answer)[0]
    assert answer.success == sampled.is_success == ended.is_success
    assert sampled.is_success or sampled is ended
    return ended


def set_radius(client: Client, radius: float) -> None:
    """Set a parameter, which then has its value."""
    (answer,) = client.set_parameters(robot_radius=radius)
    assert answer.successful, answer.reason
    assert client.get_parameters('robot_radius') == [radius]


@contextmanager
def new_map(planner: NodeProcess) -> Iterator[None]:
    """Wait, at the end of a ``with`` block, for a map that came since its beginning."""
    received = planner.log.count('map received')
    yield
    until(lambda: planner.log.count('map received') > received, 'a map')


def health(client: Client) -> str:
    """Return what the node says of itself from now on."""
    heard = client.listen(DiagnosticArray, '/diagnostics', MANY)
    return until(lambda: heard, 'a report of health')[0].status[0].message


def test_transition_that_the_state_does_not_allow_is_refused_and_changes_nothing(
    client: Client, planner: NodeProcess
) -> None:
    assert change(client, ACTIVATE) == [False]
    assert state(client) == UNCONFIGURED
    assert change(client, CONFIGURE, ACTIVATE) == [True, True]
    assert change(client, CONFIGURE, ACTIVATE, CLEANUP) == [False, False, False]
    assert state(client) == ACTIVE
    assert change(client, DEACTIVATE, DEACTIVATE) == [True, False]
    unknown = ChangeState.Request(transition=Transition(label='fly'))
    assert not client.call(ChangeState, '/hnr_planner/change_state', unknown).success
    assert state(client) == INACTIVE
    assert 'no transition 1 from active' in planner.log
    assert planner.popen.poll() is None and 'Traceback' not in planner.log


def test_deactivation_ends_searches(client: Client, planner: NodeProcess) -> None:
    change(client, CONFIGURE, ACTIVATE)
    client.set_parameters(**ENDLESS)
    with new_map(planner):
        client.publish_map(grid_message(maze()))
    ends = pose(0.025, 0.025), pose(20, 20)
    futures = [client.send_plan(*ends, service='plan_hit_and_run') for _ in range(3)]
    sampling = client.send_sample()
    client.wait_for_running(len(futures) + 1)
    assert change(client, DEACTIVATE) == [True]
    for future in futures:
        path = result_of(future).plan
        assert path.poses == []
        assert client.outcome_of(path)[0] is Outcome.CANCELLED
    assert client.outcome_of(result_of(sampling))[0] is Outcome.CANCELLED
    assert outcome(client) is Outcome.NOT_ACTIVE
    client.set_parameters(**USUAL)


@pytest.mark.skipif(find_spec('bondpy') is not None, reason='there is a bond')
def test_bond_that_cannot_be_is_on_the_log(client: Client, planner: NodeProcess) -> None:
    change(client, CONFIGURE, ACTIVATE)
    planner.wait_for('bond_timeout')


def test_parameters_change_in_every_state(client: Client) -> None:
    """But the last one, which test_every_state_... has."""
    for transition in (CONFIGURE, ACTIVATE, DEACTIVATE, CLEANUP):
        set_radius(client, 0.01 * transition)
        assert change(client, transition) == [True]
    set_radius(client, 0.0)


def test_node_survives_many_changes_while_requests_come(
    client: Client, planner: NodeProcess
) -> None:
    """Subscriptions come and go under the executor's eyes; every request is answered by name."""
    client.publish_map(grid_message(two_rooms()))
    with new_map(planner):
        change(client, CONFIGURE, ACTIVATE)
    known = {Outcome.SOLVED, Outcome.NOT_ACTIVE, Outcome.NO_MAP, Outcome.MAP_NOT_READY}
    futures = []
    for turn in range(20):
        futures += [client.send_plan(START, GOAL) for _ in range(5)]
        client.set_parameters(rviz_clicks=bool(turn % 2))
        assert all(change(client, DEACTIVATE, CLEANUP, CONFIGURE, ACTIVATE))
    outcomes = {client.outcome_of(result_of(future).plan)[0] for future in futures}
    assert outcomes <= known | {Outcome.CANCELLED}
    until(lambda: outcome(client) is Outcome.SOLVED, 'the map again')
    assert 'Traceback' not in planner.log and planner.popen.poll() is None


FAILING = """
import rclpy
from hnr_planner.ros.node.managed_node import ManagedNode


class Failing(ManagedNode):
    held = 0

    def configure(self):
        self.held += 1

    def activate(self):
        raise ValueError('no power')

    def cleanup(self):
        self.held = 0


rclpy.init()
node = Failing('failing')
said = [node.trigger_configure().name, node.state, node.held]
said += [node.trigger_activate().name, node.state, node.held]
said += [node.trigger_configure().name, node.state, node.held]
node.destroy_node()
print(said, node.state, node.held)
rclpy.try_shutdown()
"""


def test_transition_that_fails_is_told_and_undone() -> None:
    done = subprocess.run(
        [sys.executable, '-c', FAILING], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    steps = ['SUCCESS', INACTIVE, 1, 'ERROR', UNCONFIGURED, 0, 'SUCCESS', INACTIVE, 1]
    assert done.stdout.strip() == f'{steps} {FINALIZED} 0'
    assert 'ValueError: no power' in done.stderr


def test_every_state_answers_at_once_and_only_the_active_one_plans(
    client: Client, planner: NodeProcess
) -> None:
    """Stands last: a shut down node does nothing more but end."""
    client.publish_map(grid_message(two_rooms()))
    assert state(client) == UNCONFIGURED
    assert outcome_of_both(client) is Outcome.NOT_ACTIVE
    assert health(client).startswith('NOT_ACTIVE')

    with new_map(planner):
        assert change(client, CONFIGURE) == [True]
    assert state(client) == INACTIVE
    assert outcome_of_both(client) is Outcome.NOT_ACTIVE

    assert change(client, ACTIVATE) == [True]
    assert state(client) == ACTIVE
    assert outcome_of_both(client) is Outcome.SOLVED
    assert health(client) == 'ready'

    assert change(client, DEACTIVATE) == [True]
    assert outcome_of_both(client) is Outcome.NOT_ACTIVE
    assert change(client, ACTIVATE) == [True]
    assert outcome_of_both(client) is Outcome.SOLVED, 'the map was kept'

    assert change(client, DEACTIVATE, CLEANUP) == [True, True]
    assert state(client) == UNCONFIGURED
    assert outcome_of_both(client) is Outcome.NOT_ACTIVE

    with new_map(planner):
        assert change(client, CONFIGURE, ACTIVATE) == [True, True]
    assert outcome_of_both(client) is Outcome.SOLVED

    assert change(client, SHUTDOWN[ACTIVE]) == [True]
    assert state(client) == FINALIZED
    assert outcome_of_both(client) is Outcome.NOT_ACTIVE
    set_radius(client, 0.1)
    assert planner.end(signal.SIGTERM) == 0
    assert 'Traceback' not in planner.log
