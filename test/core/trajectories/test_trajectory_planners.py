"""The planners for systems: what they find, what they count, what it depends on."""

from test.core.trajectories.worlds import (
    BLOCKED,
    CAR,
    faults,
    GOAL,
    in_map,
    INTEGRATOR,
    SPACE,
    START,
    state,
)
from test.sweeps import sweep
from typing import Any

from hnr_planner.core import plan_trajectory, PlannerStatus, TrajectoryResult
from hnr_planner.core.systems import System
from hnr_planner.core.trajectories.request import check_kinodynamic_request
import numpy as np
import pytest

PAPERS = ['kinodynamic_hit_and_run', 'kinodynamic_rrt']


def solve(algorithm: str, system: System = INTEGRATOR, **settings: Any) -> TrajectoryResult:
    """Plan from end to end of the serpentine; no clock limits it."""
    begin = START if system is INTEGRATOR else np.append(in_map(0.75, 0.75), [0.4, 0.0])
    given = {'goal_radius': 0.5, 'seed': 1, 'time_limit': np.inf, **settings}
    return plan_trajectory(SPACE, system, begin, GOAL, algorithm=algorithm, **given)


def assert_same(a: TrajectoryResult, b: TrajectoryResult) -> None:
    assert a.trajectory is not None and b.trajectory is not None
    for name in ('times', 'states', 'controls'):
        assert np.array_equal(getattr(a.trajectory, name), getattr(b.trajectory, name)), name
    assert np.array_equal(a.samples, b.samples) and np.array_equal(a.parents, b.parents)
    assert a.iterations == b.iterations and a.counts == b.counts


CASES = [
    ('kinodynamic_rrt', INTEGRATOR, {}),
    ('kinodynamic_rrt', INTEGRATOR, {'boundary': 'inelastic'}),
    ('kinodynamic_rrt', INTEGRATOR, {'boundary': 'inelastic', 'transition': 'step'}),
    pytest.param('kinodynamic_rrt', CAR, {}, marks=pytest.mark.interpreted),
    sweep('kinodynamic_rrt', CAR, {'boundary': 'inelastic'}),
    sweep('kinodynamic_hit_and_run', INTEGRATOR, {'time_step': 0.4}),
    ('kinodynamic_hit_and_run', INTEGRATOR, {'boundary': 'inelastic', 'time_step': 0.4}),
    ('kinodynamic_connect', INTEGRATOR, {}),
]


@pytest.mark.parametrize(('algorithm', 'system', 'settings'), CASES)
def test_a_trajectory_passes_the_checker(
    algorithm: str, system: System, settings: dict[str, Any]
) -> None:
    result = solve(algorithm, system, simplify=False, **settings)
    assert result.status is PlannerStatus.SOLVED
    trajectory = result.trajectory
    assert trajectory is not None
    begin = START if system is INTEGRATOR else np.append(in_map(0.75, 0.75), [0.4, 0.0])
    assert np.array_equal(trajectory.states[0], begin)
    assert np.hypot(*(result.path[-1] - GOAL)) <= 0.5 + 1e-9
    inelastic = settings.get('boundary') == 'inelastic'
    assert faults(result, system, BLOCKED, inelastic) == []
    assert result.length == pytest.approx(trajectory.length)
    assert np.array_equal(result.path, trajectory.states[:, :2])


@pytest.mark.parametrize('algorithm', PAPERS)
def test_an_inelastic_boundary_stops_and_a_forbidden_one_is_not_met(algorithm: str) -> None:
    jumps = {}
    for boundary in ('inelastic', 'forbidden'):
        result = solve(algorithm, simplify=False, boundary=boundary, time_step=0.4)
        trajectory = result.trajectory
        assert trajectory is not None
        ends = (
            trajectory.states[:-1, 2:] + np.diff(trajectory.times)[:, None] * trajectory.controls
        )
        jumps[boundary] = int((np.abs(ends - trajectory.states[1:, 2:]).max(axis=1) > 1e-6).sum())
    assert jumps['inelastic'] > 0 and jumps['forbidden'] == 0


@pytest.mark.parametrize('algorithm', PAPERS)
def test_transitions_and_steps_are_counted_in_both_readings(algorithm: str) -> None:
    one = solve(algorithm, simplify=False, transition='step')
    assert one.counts['integration_steps'] == one.iterations
    driven = solve(algorithm, simplify=False, transition='arrival')
    assert driven.counts['integration_steps'] > 1.5 * driven.iterations
    assert (driven.parents < np.arange(len(driven.samples))).all()
    assert driven.parents[0] == -1 and np.array_equal(driven.samples[0], START[:2])


@pytest.mark.parametrize('algorithm', [*PAPERS, 'kinodynamic_connect'])
def test_the_same_seed_gives_the_same_trajectory(algorithm: str) -> None:
    assert_same(solve(algorithm), solve(algorithm))


@pytest.mark.parametrize('begin', [START, state(0.75, 0.75, 1.5, 0.0), state(0.75, 0.9, 1.6, 1.0)])
@pytest.mark.parametrize('algorithm', [*PAPERS, 'kinodynamic_connect'])
def test_the_size_of_batches_does_not_matter(algorithm: str, begin: Any) -> None:
    request = check_kinodynamic_request(
        SPACE,
        INTEGRATOR,
        begin,
        GOAL,
        algorithm=algorithm,
        settings={},
        goal_radius=0.5,
        goal_speed=np.inf,
        boundary='inelastic' if algorithm in PAPERS else 'forbidden',
        simplify=False,
        seed=3,
    )
    searches = []
    for batch in (1, 7, 100):
        search = request.planner.start(request.problem, request.geometric.stream(0))
        while not search.solved and search.iterations < 100_000:
            search.advance(batch)
        assert search.solved
        searches.append(search)
    for search in searches[1:]:
        assert search.iterations == searches[0].iterations
        assert search.counts == searches[0].counts
        assert np.array_equal(search.samples, searches[0].samples)
        for mine, its in zip(search.motion, searches[0].motion, strict=True):
            assert np.array_equal(mine, its)


def test_a_start_in_motion_is_braked_or_turned_away() -> None:
    """Straight towards the far wall there is room; half a metre before a wall there is not."""
    for begin, turns in ((state(1.0, 0.75, 1.8, 0.0), False), (state(0.75, 0.9, 1.6, 1.0), True)):
        result = plan_trajectory(
            SPACE, INTEGRATOR, begin, GOAL, goal_radius=0.5, seed=2, time_limit=np.inf
        )
        assert result.status is PlannerStatus.SOLVED
        assert faults(result, INTEGRATOR, BLOCKED) == []
        assert result.trajectory is not None
        assert np.array_equal(result.trajectory.states[0], begin)
        assert (result.counts['braking_steps'] > 0) == turns


@pytest.mark.interpreted
def test_auto_is_the_hybrid_or_for_a_car_that_may_hit_the_wall_a_tree() -> None:
    assert solve('auto', max_iterations=1).planner == 'kinodynamic_connect'
    for_car = solve('auto', CAR, boundary='inelastic', max_iterations=1)
    assert for_car.planner == 'kinodynamic_rrt'
