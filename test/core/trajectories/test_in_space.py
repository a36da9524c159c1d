"""A double integrator in three dimensions, among spheres and boxes."""

import math
from test.sweeps import sweep

from hnr_planner.core import BallSpace, BoxSpace, DifferenceSpace, plan_trajectory, PlannerStatus
from hnr_planner.core.systems import DoubleIntegrator
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

SYSTEM = DoubleIntegrator(dim=3, max_acceleration=1.0, max_speed=1.5)
SPACE = DifferenceSpace(
    BoxSpace((0, 0, 0), (4, 4, 4)),
    BallSpace((2, 2, 2), 1.2),
    BoxSpace((1.5, -1, -1), (2.5, 1.5, 5)),
    BoxSpace((1.5, 2.5, -1), (2.5, 5, 3)),
)
START, GOAL = np.array([0.5, 0.5, 0.5, 0.0, 0.0, 0.0]), np.array([3.5, 3.5, 0.5])


# Each planner and each speed once; the other two pairs are sweeps.
@pytest.mark.parametrize(
    ('algorithm', 'speed'),
    [
        ('kinodynamic_connect', 0.8),
        sweep('kinodynamic_rrt', 0.0),
        sweep('kinodynamic_connect', 0.0),
        sweep('kinodynamic_rrt', 0.8),
    ],
)
def test_a_trajectory_among_spheres_is_free_and_keeps_the_limits(
    algorithm: str, speed: float
) -> None:
    """Looked at every thousandth of a step, and simulated again from the start."""
    begin = START + [0, 0, 0, 0, speed, 0]
    result = plan_trajectory(
        SPACE,
        SYSTEM,
        begin,
        GOAL,
        algorithm=algorithm,
        goal_radius=0.5,
        time_limit=math.inf,
        seed=1,
    )
    assert result.status is PlannerStatus.SOLVED
    trajectory = result.trajectory
    assert trajectory is not None
    x, v = begin[:3], begin[3:]
    for u, duration in zip(trajectory.controls, np.diff(trajectory.times), strict=True):
        t = np.linspace(0.0, duration, 1000)[:, np.newaxis]
        assert SPACE.contains(x + t * v + t**2 / 2 * u).all()
        assert np.linalg.norm(u) <= 1.0 + 1e-9
        x, v = x + duration * v + duration**2 / 2 * u, v + duration * u
        assert np.linalg.norm(v) <= 1.5 + 1e-9
    assert np.append(x, v) == pytest.approx(trajectory.states[-1], abs=1e-6)
    assert math.dist(x, GOAL) <= 0.5 + 1e-6


def test_a_start_that_cannot_stop_before_the_box_ends_is_named() -> None:
    begin = START + [0, 0, 0, -1.2, 0, 0]
    result = plan_trajectory(SPACE, SYSTEM, begin, GOAL, time_limit=math.inf)
    assert result.status is PlannerStatus.INEVITABLE_COLLISION
