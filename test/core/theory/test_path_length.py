"""How long paths of Hit-and-Run are: the linear system against walks, and what mixing says."""

import math
from test.core.theory.sets import two_rooms, walked, YOU

from hnr_planner.core import BoxSpace, GridSpace, RequestError
from hnr_planner.core.theory import (
    cell_flow,
    expected_transitions,
    mixing_estimate,
    mixing_time,
    transitions_bound,
)
import numpy as np
import pytest

N_WALKS = 4000
N_LINES = 1 << 17

PROBLEMS = pytest.mark.parametrize(
    ('space', 'shape', 'start', 'goal'),
    [
        (YOU, (18, 14), BoxSpace((0, 8), (1, 9)), BoxSpace((5, 8), (7, 9))),
        (two_rooms(0.2), (10, 20), BoxSpace((0, 0), (0.2, 0.2)), BoxSpace((1.8, 0.8), (2, 1))),
    ],
    ids=['you', 'rooms'],
)


def transitions(space, start, goal, seed):
    """Count the steps (N_WALKS,) from uniform points of ``start`` until a walk is in ``goal``."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(*start.bounds, size=(N_WALKS, 2))
    counts, walking = np.zeros(N_WALKS), np.arange(N_WALKS)
    while len(walking):
        at[walking] = walked(space, at[walking], int(rng.integers(2**40)))
        counts[walking] += 1
        walking = walking[~goal.contains(at[walking])]
    return counts


@PROBLEMS
def test_the_expected_number_is_the_mean_of_walks(space, shape, start, goal):
    """4000 walks, 6.5 standard errors (1e-10 false alarms), besides 3 % that cells forget."""
    flow = cell_flow(space, shape, N_LINES)
    begin, end = start.contains(flow.centre), goal.contains(flow.centre)
    expected = expected_transitions(flow, end)
    mean = flow.area[begin] @ expected[begin] / flow.area[begin].sum()
    counts = transitions(space, start, goal, seed=1)
    error = counts.std() / math.sqrt(N_WALKS)
    assert abs(counts.mean() - mean) < 6.5 * error + 0.03 * mean
    assert (expected[end] == 0).all()
    assert error < 0.02 * mean


@PROBLEMS
def test_what_mixing_says_is_enough(space, shape, start, goal):
    """On these sets t_mix / sigma(G) is 2.9 and 4 times too many; the bound from t_rel holds."""
    flow = cell_flow(space, shape, N_LINES)
    begin, end = start.contains(flow.centre), goal.contains(flow.centre)
    fraction = flow.area[end].sum() / flow.area.sum()
    expected = expected_transitions(flow, end)
    said = mixing_estimate(mixing_time(flow, int(np.flatnonzero(begin)[0])), fraction)
    assert 2 < said / expected[begin].mean() < 5
    from_anywhere = flow.area @ expected / flow.area.sum()
    assert from_anywhere < transitions_bound(flow.relaxation_time, fraction)
    from_start = flow.area[begin] @ expected[begin] / flow.area[begin].sum()
    warmth = flow.area.sum() / flow.area[begin].sum()
    assert from_start < transitions_bound(flow.relaxation_time, fraction, warmth)


def test_a_walk_that_mixes_at_once():
    """One cell is mixed before the first step; of two halves of a square one step is enough."""
    square = GridSpace.from_blocked(np.zeros((2, 2), dtype=bool))
    assert mixing_time(cell_flow(square, (1, 1), 1000), 0) == 0
    assert mixing_time(cell_flow(square, (1, 2), N_LINES), 0) == 1


def test_the_law_is_nearer_the_longer_one_walks():
    flow = cell_flow(two_rooms(0.05), (4, 8), N_LINES)
    steps = [mixing_time(flow, 0, epsilon) for epsilon in (0.4, 0.2, 0.1, 0.01)]
    assert steps == sorted(steps)
    per_e = (steps[3] - steps[2]) / math.log(10)
    assert per_e == pytest.approx(flow.relaxation_time, rel=0.05)


def test_what_never_mixes_is_refused():
    apart = GridSpace.from_blocked([[False, True, False]])
    with pytest.raises(RequestError, match='not mixed after'):
        mixing_time(cell_flow(apart, (1, 3), 2000), 0)
