"""Trajectories of a robot with inertia as free polylines."""

from test.brute_force import path_collisions

from hnr_planner.core import GridSpace
from hnr_planner.core.systems import DoubleIntegrator, Trajectory
from hnr_planner.server.geometry.poses import MOST_POSES
from hnr_planner.server.geometry.trajectories import SAG, trajectory_path, yaws_along
from hnr_planner.server.requests.outcomes import Outcome, Refusal
import numpy as np
import pytest

CELL = 0.1


def go_on() -> None:
    """Let the work go on."""


def zigzag(n_steps: int) -> Trajectory:
    """Return a trajectory that swings up and down while it goes to the right at 0.5 m/s."""
    system = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=2.0)
    controls = np.zeros((n_steps, 2))
    controls[:, 1] = np.where(np.arange(n_steps) % 2, -1.0, 1.0)
    states = [np.array([0.15, 1.0, 0.5, -0.25])]
    for control in controls:
        states.append(system.propagate(states[-1], control, 0.5))
    times = np.linspace(0.0, 0.5 * n_steps, n_steps + 1)
    return Trajectory(system, times, np.array(states, dtype=np.float64), controls)


def test_polyline_is_near_the_curve_and_has_its_ends() -> None:
    space = GridSpace.from_blocked(np.zeros((20, 80), dtype=bool), CELL)
    trajectory = zigzag(20)
    path = trajectory_path(trajectory, space, go_on)
    assert path[[0, -1]].tolist() == trajectory.positions[[0, -1]].tolist()
    curve = trajectory.at(np.linspace(0.0, trajectory.duration, 4001))[:, :2]
    distances = np.linalg.norm(path[:, np.newaxis] - curve, axis=2)
    assert distances.min(axis=1).max() < 1e-3, 'vertices lie on the curve'
    along = np.interp(curve[:, 0], path[:, 0], path[:, 1])
    assert np.abs(along - curve[:, 1]).max() <= SAG * CELL * (1.0 + 1e-6)


def test_polyline_is_free_where_a_coarser_one_is_not() -> None:
    # A jump over one blocked cell, 2 mm above it; chords may be 10 mm from the curve.
    system = DoubleIntegrator(dim=2)
    states = [(0.13, 0.802, 0.5, 0.2), (2.13, 0.802, 0.5, -0.2)]
    jump = Trajectory(system, np.array([0.0, 4.0]), np.array(states), np.array([(0.0, -0.1)]))
    blocked = np.zeros((20, 30), dtype=bool)
    coarse = trajectory_path(jump, GridSpace.from_blocked(blocked, CELL), go_on)
    blocked[9, 11] = True
    assert path_collisions(coarse, blocked, CELL) != []
    path = trajectory_path(jump, GridSpace.from_blocked(blocked, CELL), go_on)
    assert path_collisions(path, blocked, CELL) == []
    assert len(path) > len(coarse)


def test_long_trajectory_has_no_more_poses_than_are_sent() -> None:
    space = GridSpace.from_blocked(np.zeros((20, 15_010), dtype=bool), CELL)
    trajectory = zigzag(6000)
    path = trajectory_path(trajectory, space, go_on)
    assert 6000 < len(path) <= MOST_POSES
    assert {tuple(point) for point in trajectory.positions} <= {tuple(point) for point in path}


def test_work_ends_when_it_has_to() -> None:
    blocked = np.zeros((20, 80), dtype=bool)
    blocked[12:, :] = True

    def stop() -> None:
        raise Refusal(Outcome.CANCELLED, 'cancelled')

    with pytest.raises(Refusal):
        trajectory_path(zigzag(20), GridSpace.from_blocked(~blocked, CELL), stop)


def test_robot_at_rest_looks_where_it_is_about_to_go() -> None:
    system = DoubleIntegrator(dim=2)
    states = np.array([(0, 0, 0, 0), (0, 1, 0, 1), (0, 2, 0, 0), (0, 2, 0, 0)], dtype=float)
    controls = np.array([(0, 1), (0, -1), (0, 0)], dtype=float)
    trajectory = Trajectory(system, np.arange(4.0), states, controls)
    assert yaws_along(trajectory) == pytest.approx([np.pi / 2] * 4)
    still = Trajectory(system, np.arange(2.0), np.zeros((2, 4)), np.zeros((1, 2)))
    assert yaws_along(still).tolist() == [0.0, 0.0]
