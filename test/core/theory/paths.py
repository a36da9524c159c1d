"""Two planning problems, with measured transitions and with those computed from the flow."""

from functools import cache
from test.core.theory.sets import Points, two_rooms, U_SET, walked
from typing import NamedTuple

from hnr_planner.core import BoxSpace, Space
from hnr_planner.core.theory import (
    cell_flow,
    expected_transitions,
    mixing_estimate,
    mixing_time,
    transitions_bound,
)
import numpy as np

N_WALKS = 4000
N_LINES = 1 << 17


class Problem(NamedTuple):
    """A walk in ``space``, divided into cells of ``shape``, from one box into another."""

    space: Space
    shape: tuple[int, int]
    start: BoxSpace
    goal: BoxSpace


AROUND_THE_U = Problem(U_SET, (18, 14), BoxSpace((0, 8), (1, 9)), BoxSpace((5, 8), (7, 9)))
THROUGH_THE_DOOR = Problem(
    two_rooms(0.2), (10, 20), BoxSpace((0, 0), (0.2, 0.2)), BoxSpace((1.8, 0.8), (2, 1))
)


class Theory(NamedTuple):
    """Quantities of ``path_length`` computed on cells."""

    fraction: float
    expected: float
    from_anywhere: float
    mixing: int
    by_mixing: float
    bound: float
    warmth: float


@cache
def theory_of(problem: Problem) -> Theory:
    """Compute the quantities of a problem from the flow between its cells."""
    flow = cell_flow(problem.space, problem.shape, N_LINES)
    begin, end = problem.start.contains(flow.centre), problem.goal.contains(flow.centre)
    area = flow.area.sum()
    fraction = flow.area[end].sum() / area
    expected = expected_transitions(flow, end)
    mixing = mixing_time(flow, int(np.flatnonzero(begin)[0]))
    return Theory(
        fraction,
        flow.area[begin] @ expected[begin] / flow.area[begin].sum(),
        flow.area @ expected / area,
        mixing,
        mixing_estimate(mixing, fraction),
        transitions_bound(flow.relaxation_time, fraction),
        area / flow.area[begin].sum(),
    )


@cache
def walks_of(problem: Problem) -> Points:
    """Count the steps (N_WALKS,) from uniform points of the start until a walk is in the goal."""
    rng = np.random.default_rng(1)
    at = rng.uniform(*problem.start.bounds, size=(N_WALKS, 2))
    counts, walking = np.zeros(N_WALKS), np.arange(N_WALKS)
    while len(walking):
        at[walking] = walked(problem.space, at[walking], int(rng.integers(2**40)))
        counts[walking] += 1
        walking = walking[~problem.goal.contains(at[walking])]
    return counts
