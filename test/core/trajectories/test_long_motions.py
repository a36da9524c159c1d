"""Motions of hundreds of thousands of steps: reduced, refused or returned, and cancelled soon."""

import math
from test.core.trajectories.worlds import (
    BLOCKED,
    CAR,
    faults,
    GOAL,
    in_map,
    INTEGRATOR,
    SPACE,
    START,
)
from typing import Any

from hnr_planner.core import plan_trajectory, PlannerStatus, TrajectoryResult
from hnr_planner.core.planning.attempts import SEARCH
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.systems import System
from hnr_planner.core.trajectories.attempt import CHUNK, evaluate, Found
from hnr_planner.core.trajectories.reduce import STEPS_MAX
from hnr_planner.core.trajectories.request import check_kinodynamic_request
import numpy as np
import pytest


class Count:
    """An event that counts how often it is checked, and is set from a given check on."""

    def __init__(self, first_set: float = math.inf) -> None:
        self.first_set, self.looks = first_set, 0

    def is_set(self) -> bool:
        self.looks += 1
        return self.looks >= self.first_set


def solve(system: System = INTEGRATOR, **given: Any) -> TrajectoryResult:
    """Walk through the serpentine in short steps; no clock limits it."""
    begin = START if system is INTEGRATOR else np.append(in_map(0.75, 0.75), [0.4, 0.0])
    given = {'algorithm': 'kinodynamic_hit_and_run', 'time_step': 5e-3, 'seed': 0, **given}
    return plan_trajectory(
        SPACE, system, begin, GOAL, goal_radius=0.5, time_limit=math.inf, **given
    )


def test_a_long_motion_is_reduced_to_one_that_a_robot_drives() -> None:
    raw, result = solve(simplify=False), solve()
    assert raw.trajectory is not None and result.trajectory is not None
    assert len(raw.trajectory.controls) > 3 * CHUNK
    assert raw.first_solution is not None and result.first_solution is not None
    assert len(result.first_solution.path) == len(raw.path)
    assert result.first_solution.length == pytest.approx(raw.length, rel=1e-12)
    assert result.iterations == raw.iterations
    assert len(result.trajectory.controls) < 1000
    assert result.trajectory.duration < 0.1 * raw.trajectory.duration
    assert faults(result, INTEGRATOR, BLOCKED) == []


def test_a_long_motion_that_cannot_be_shortened_is_refused_unless_it_is_asked_for() -> None:
    refused = solve(CAR, time_step=4e-3)
    assert refused.status is PlannerStatus.ITERATION_LIMIT
    assert refused.trajectory is None and len(refused.path) == 0
    assert f'more than the {STEPS_MAX} that a robot would drive' in refused.message
    raw = solve(CAR, time_step=4e-3, simplify=False)
    assert raw.status is PlannerStatus.SOLVED
    assert raw.trajectory is not None and len(raw.trajectory.controls) > STEPS_MAX


@pytest.mark.parametrize('simplify', [None, False])
def test_all_that_follows_a_search_observes_the_budget(simplify: bool | None) -> None:
    """Cancelled at each of the checks, the work ends there; and every chunk has a check."""
    request = check_kinodynamic_request(
        SPACE,
        INTEGRATOR,
        START,
        GOAL,
        algorithm='kinodynamic_hit_and_run',
        settings={'time_step': 5e-3},
        goal_radius=0.5,
        goal_speed=math.inf,
        boundary='forbidden',
        simplify=simplify,
        seed=0,
    )
    search = request.planner.start(request.problem, request.geometric.stream(0, SEARCH, 0))
    while not search.solved:
        search.advance(1000)
    n_steps = len(search.motion.durations)

    def found(event: Count) -> Found | None:
        budget = Budget(math.inf, cancel=event)
        return budget.within(lambda: evaluate(request, search, budget, 0.0), None)

    undisturbed = Count()
    assert found(undisturbed) is not None
    passes = 2 if simplify is None else 3  # conversion, length; and a check of all steps
    assert undisturbed.looks >= passes * (n_steps // CHUNK)
    for k in range(1, undisturbed.looks + 1):
        event = Count(k)
        result = found(event)
        assert event.looks <= k + 1
        assert result is None or result.trajectory is None or len(result.motion.durations) < CHUNK


def test_a_cancelled_request_says_so() -> None:
    event = Count(1)
    result = solve(cancel=event)
    assert result.status is PlannerStatus.CANCELLED and result.cut_by_time
    assert result.trajectory is None and result.first_solution is None
