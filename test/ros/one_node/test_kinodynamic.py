"""Motions by a real node: the path and the trajectory that it publishes for one request."""

from test.brute_force import path_collisions
from test.curve_brute_force import double_integrator_faults
from test.ros.harness import Client, grid_message, NodeProcess, points_of, pose
from test.ros.rooms import DATA, GOAL, ORIGIN, RESOLUTION, START
from typing import Any

from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest
from trajectory_msgs.msg import MultiDOFJointTrajectory

SERVICES = ('plan_kinodynamic_connect', 'plan_kinodynamic_hit_and_run', 'plan_kinodynamic_rrt')


@pytest.fixture(scope='module')
def trajectories(client: Client, planner: NodeProcess) -> list[MultiDOFJointTrajectory]:
    """Publish the rooms, turned and moved; return where trajectories arrive."""
    client.publish_map(grid_message(DATA, RESOLUTION, ORIGIN))
    planner.wait_for('map received')
    client.set_parameters(max_acceleration=1.0, max_speed=0.8, time_limit=20.0)
    return client.listen(MultiDOFJointTrajectory, '/hnr_planner/trajectory')


def read(message: MultiDOFJointTrajectory) -> tuple[Any, Any, Any]:
    """Return times, states and controls of a trajectory."""
    points = message.points
    times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in points]
    rows = [(p.transforms[0].translation, p.velocities[0].linear) for p in points]
    states = [(x.x, x.y, v.x, v.y) for x, v in rows]
    controls = [(p.accelerations[0].linear.x, p.accelerations[0].linear.y) for p in points[:-1]]
    return np.array(times), np.array(states), np.array(controls)


@pytest.mark.parametrize('service', SERVICES)
def test_path_and_trajectory_of_a_request_are_free_and_within_the_limits(
    client: Client, trajectories: list[MultiDOFJointTrajectory], service: str
) -> None:
    client.set_parameters(goal_radius=0.3)
    path = client.plan(pose(*START), pose(*GOAL), service=service)
    client.set_parameters(goal_radius=0.0)
    outcome, values = client.outcome_of(path)
    assert outcome is Outcome.SOLVED, values['why']
    assert values['algorithm'] == service.removeprefix('plan_')
    message = client.stamped(trajectories, path)
    times, states, controls = read(message)
    assert message.header.frame_id == 'map' and message.joint_names == ['base']
    assert (
        double_integrator_faults(
            times,
            states,
            controls,
            DATA >= 65,
            max_acceleration=1.0,
            max_speed=0.8,
            resolution=RESOLUTION,
            origin=ORIGIN,
        )
        == []
    )
    assert states[0].tolist() == [*START, 0.0, 0.0]
    points = points_of(path)
    assert path_collisions(points, DATA >= 65, RESOLUTION, ORIGIN) == []
    assert np.allclose(points[[0, -1]], states[[0, -1], :2], atol=1e-12)
    assert np.hypot(*(states[-1, :2] - GOAL)) <= 0.3 + 1e-9
    if service == 'plan_kinodynamic_connect':
        assert states[-1, 2:].tolist() == [0.0, 0.0]


def test_the_path_follows_the_curve(
    client: Client, trajectories: list[MultiDOFJointTrajectory]
) -> None:
    path = client.plan(pose(*START), pose(*GOAL), service='plan_kinodynamic_connect')
    times, states, controls = read(client.stamped(trajectories, path))
    assert states[-1].tolist() == [*GOAL, 0.0, 0.0]
    moments = np.linspace(0.0, times[-1], 2000)[:-1]
    step = np.searchsorted(times, moments, side='right') - 1
    after = (moments - times[step])[:, np.newaxis]
    curve = states[step, :2] + after * states[step, 2:] + after**2 / 2 * controls[step]
    points = points_of(path)
    nearest = np.linalg.norm(points[:, np.newaxis] - curve, axis=2).min(axis=1)
    assert nearest.max() < 0.2 * RESOLUTION


def test_requests_without_inertia_and_failures_have_no_trajectory(
    client: Client, trajectories: list[MultiDOFJointTrajectory]
) -> None:
    path = client.plan(pose(*START), pose(*GOAL))
    assert client.outcome_of(path)[0] is Outcome.SOLVED
    assert client.stamped(trajectories, path).points == []
    path = client.plan(pose(*START), pose(-50.0, 0.0), service=SERVICES[0])
    assert client.outcome_of(path)[0] is Outcome.INVALID_GOAL
    assert client.stamped(trajectories, path).points == []


def test_samples_need_a_region_to_fall_into(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL), service='plan_kinodynamic_rrt')
    outcome, values = client.outcome_of(path)
    assert outcome is Outcome.BAD_REQUEST
    assert 'goal_radius must be above 0 for kinodynamic_rrt' in values['why']
    assert path.poses == []
