"""Results of legs as one result: what is summed, and what is named."""

from itertools import pairwise

from hnr_planner.core import GridSpace, plan, PlanResult
from hnr_planner.server.planning.waypoints import joined
import numpy as np
import pytest

#: Corners of a room with an island in its middle, and the algorithm of the leg from each.
CORNERS = np.array([(0.5, 0.5), (9.5, 9.5), (0.5, 9.5)])
ALGORITHMS = ('rrt', 'hit_and_run_connect')


@pytest.fixture(scope='module')
def legs() -> list[PlanResult]:
    """Return the results of two legs around an island."""
    blocked = np.zeros((10, 10), dtype=bool)
    blocked[3:7, 3:7] = True
    space = GridSpace.from_blocked(blocked)
    return [
        plan(space, start, goal, algorithm=algorithm, seed=3, time_limit=np.inf)
        for algorithm, (start, goal) in zip(ALGORITHMS, pairwise(CORNERS), strict=True)
    ]


def test_numbers_of_legs_are_summed(legs: list[PlanResult]) -> None:
    one = joined(legs)
    for name in ('length', 'lower_bound', 'iterations', 'elapsed'):
        assert getattr(one, name) == pytest.approx(sum(getattr(leg, name) for leg in legs)), name
    names = {name for leg in legs for name in leg.counts}
    assert names and one.counts == {
        name: sum(leg.counts.get(name, 0) for leg in legs) for name in names
    }
    assert 0.0 < one.lower_bound <= one.length
    assert one.path[[0, -1]].tolist() == CORNERS[[0, -1]].tolist()


def test_planners_of_all_legs_are_named(legs: list[PlanResult]) -> None:
    assert joined(legs).planner == 'rrt, hit_and_run_connect'
    assert joined(legs[:1] * 2).planner == 'rrt'


def test_one_leg_is_left_as_it_is(legs: list[PlanResult]) -> None:
    assert joined(legs[:1]) is legs[0]
