"""Transitions into a goal: the linear system against walks, and the estimate from mixing."""

import math
from test.core.theory.paths import (
    AROUND_THE_U,
    N_LINES,
    N_WALKS,
    theory_of,
    THROUGH_THE_DOOR,
    walks_of,
)
from test.core.theory.sets import two_rooms

from hnr_planner.core import GridSpace, RequestError
from hnr_planner.core.theory import (
    cell_flow,
    mixing_time,
)
import numpy as np
import pytest

PROBLEMS = pytest.mark.parametrize('problem', [AROUND_THE_U, THROUGH_THE_DOOR], ids=['U', 'rooms'])


@PROBLEMS
def test_the_expected_number_is_the_mean_of_walks(problem):
    """4000 walks, 6.5 standard errors (1e-10 false alarms), besides 3 % that cells forget."""
    theory, walks = theory_of(problem), walks_of(problem)
    error = walks.std() / math.sqrt(N_WALKS)
    assert abs(walks.mean() - theory.expected) < 6.5 * error + 0.03 * theory.expected
    assert error < 0.02 * theory.expected


@PROBLEMS
def test_what_mixing_says_is_enough(problem):
    """On these sets t_mix / sigma(G) is 3 and 4 times too many; the bound from t_rel holds."""
    theory = theory_of(problem)
    assert 2 < theory.by_mixing / theory.expected < 5
    assert theory.from_anywhere < theory.bound
    assert theory.expected < theory.bound * theory.warmth


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
