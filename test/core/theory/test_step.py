"""Functionals of one step: additivity, lengths, overlap and visibility."""

import math
from test.core.theory.sets import BALL, CUBE, DISC, L_SET, SQUARE, U_SET, walked

from hnr_planner.core import BallSpace, BoxSpace, RequestError
from hnr_planner.core.theory import (
    step_length,
    step_mean,
    step_overlap,
    step_probability,
    transition_density,
    unseen_probability,
)
import numpy as np
import pytest

N = 40_000
STANDARD_ERRORS = 6.5


def boxes(space, shape):
    """Divide the bounds of a space into boxes."""
    lower, upper = space.bounds
    side = (upper - lower) / shape
    for cell in np.ndindex(*shape):
        yield BoxSpace(lower + side * cell, lower + side * (np.array(cell) + 1))


@pytest.mark.parametrize(
    ('space', 'u', 'shape', 'rounding'),
    [
        (DISC, (0.3, -0.8), (3, 4), 2e-6),
        (SQUARE, (0.9, 0.05), (5, 2), 1e-9),
        (L_SET, (1.6, 0.7), (2, 3), 1e-9),
        (U_SET, (0.7, 8.3), (7, 9), 1e-9),
        (CUBE, (0.2, 0.5, 0.9), (2, 2, 2), 1e-9),
    ],
    ids=['disc', 'square', 'ell', 'you', 'cube'],
)
def test_probabilities_add_up(space, u, shape, rounding):
    parts = [step_probability(space, u, box) for box in boxes(space, shape)]
    assert min(parts) >= 0
    assert sum(parts) == pytest.approx(1, abs=rounding)
    assert step_probability(space, u, space) == pytest.approx(1, abs=rounding)


def test_it_is_as_likely_as_the_walk_says():
    """N steps into each of nine cells of the U, at 6.5 standard errors: 1e-9 false alarms."""
    u = (3.2, 1.1)
    ends = walked(U_SET, np.tile(u, (N, 1)), seed=1)
    for box in boxes(U_SET, (3, 3)):
        p = step_probability(U_SET, u, box)
        assert abs(box.contains(ends).mean() - p) <= STANDARD_ERRORS * math.sqrt(p / N)


def test_half_of_the_steps_from_the_middle_go_either_way():
    assert step_probability(DISC, (0, 0), BoxSpace((0, -2), (2, 2))) == pytest.approx(0.5)
    assert step_probability(BALL, (0, 0, 0), BallSpace((0, 0, 0), 0.25)) == pytest.approx(0.25)


def test_a_mean_of_one_is_one_and_of_a_half_plane_its_probability():
    def right_half(points):
        return points[:, 0] > 0.5

    assert step_mean(L_SET, (1.6, 0.7), lambda points: np.ones(len(points))) == pytest.approx(1)
    p = step_probability(L_SET, (1.6, 0.7), BoxSpace((0.5, 0), (2, 2)))
    assert step_mean(L_SET, (1.6, 0.7), right_half) == pytest.approx(p, abs=2e-3)


@pytest.mark.parametrize('space', [DISC, BALL])
def test_the_short_steps_from_the_middle_of_a_ball(space):
    """Every half chord is 1, so the shortest eighth of the steps is shorter than 1/8: F = h/8."""
    assert step_length(space, np.zeros(space.dim)) == pytest.approx(1 / 8)
    assert step_length(space, np.zeros(space.dim), 0.5) == pytest.approx(1 / 2)


@pytest.mark.parametrize(
    ('space', 'u'), [(SQUARE, (0.9, 0.05)), (L_SET, (1.6, 0.7)), (CUBE, (0.2, 0.5, 0.9))]
)
def test_an_eighth_of_the_steps_is_shorter(space, u):
    """N steps: 6.5 standard errors of a fraction of 1/8; the ball of that radius says the same."""
    length = step_length(space, u)
    ends = walked(space, np.tile(u, (N, 1)), seed=2)
    shorter = (np.linalg.norm(ends - u, axis=1) < length).mean()
    assert abs(shorter - 1 / 8) < STANDARD_ERRORS * math.sqrt(1 / 8 * 7 / 8 / N)
    assert step_probability(space, u, BallSpace(u, length)) == pytest.approx(1 / 8, rel=1e-3)


@pytest.mark.parametrize(('space', 'v'), [(SQUARE, (0.6, 0.4)), (L_SET, (0.4, 1.7))])
def test_two_steps_have_in_common_what_draws_say(space, v):
    """The mean of min(1, f_v / f_u) over N steps from u, and the same from either side."""
    u = (0.9, 0.05)
    overlap = step_overlap(space, u, v)
    assert overlap == pytest.approx(step_overlap(space, v, u), abs=5e-3)
    ends = walked(space, np.tile(u, (N, 1)), seed=3)
    ratio = np.minimum(1, transition_density(space, v, ends) / transition_density(space, u, ends))
    assert abs(ratio.mean() - overlap) < STANDARD_ERRORS * 0.5 / math.sqrt(N)
    assert step_overlap(space, u, u) == 1


def test_what_another_point_misses():
    """N steps, as above; in a convex set nothing is missed."""
    u, v = (0.5, 0.4), (1.5, 0.5)
    ends = walked(L_SET, np.tile(u, (N, 1)), seed=4)
    missed = np.mean([not L_SET.is_motion_valid(v, end) for end in ends[:4000]])
    p = unseen_probability(L_SET, u, v)
    assert abs(missed - p) < STANDARD_ERRORS * math.sqrt(p / 4000)
    assert unseen_probability(SQUARE, (0.3, 0.4), (0.7, 0.1)) == 0


def test_what_has_no_answer_is_refused():
    with pytest.raises(RequestError, match='outside the box'):
        step_length(SQUARE, (2, 2))
    with pytest.raises(RequestError, match='2 or 3 dimensions, got 4'):
        step_length(BoxSpace(np.zeros(4), np.ones(4)), np.full(4, 0.5))
