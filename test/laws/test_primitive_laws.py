"""
The laws of the primitives that composed spaces are made of, held on every compiled space.

``first_entry`` is held against points along the line: nothing is free before it, something after.
"""

from test.laws.test_space_laws import random_points, rounding, size, tolerance
from test.sweeps import IN_FULL
from typing import NamedTuple

from hnr_planner.core.kernels.kernel import interpreted, kernel
from hnr_planner.core.kernels.modes import Mode, mode_of_thread
from hnr_planner.core.spaces.primitives import (
    chord_or_empty,
    first_entry,
    first_exit,
    touches,
)
import numpy as np
import pytest

#: Lines, random points, and points along a line; interpreted, most of the time is theirs.
N, SCATTERED, ALONG = (300, 6000, 400) if IN_FULL else (150, 1200, 100)


class Line(NamedTuple):
    """What the primitives return about a line."""

    #: Whether the closure holds its point at 0.
    touches: bool
    #: The first parameter from ``t`` on at which it enters, and at which it leaves, the space.
    enters: float
    leaves: float


@kernel
def line(space, x, u, t):
    """Return all of it: one kernel is quicker to compile for each kind of space than three."""
    return Line(
        touches(space, x),
        first_entry(space, x, u, t),
        first_exit(space, x, u, t, np.inf),
    )


def touching(space, points):
    """Return which of ``points`` (k, dim) the closure holds."""
    return [line(space, x, np.ones_like(x), 0.0).touches for x in points]


def beyond_rounding(space):
    """
    Return a distance along a line after which a point is beyond a boundary in spite of rounding.

    A line may cross a boundary at an angle of 1e-3: for a space far from the origin, points are
    rounded across it up to 1e3 roundings from the crossing.
    """
    return max(tolerance(space), 1e4 * rounding(space))


def lines(space, rng):
    """Yield points around the space and directions of about its size, in the caller's frame."""
    for point in random_points(space, rng, N):
        yield point, rng.standard_normal(space.dim) * size(space)


def test_the_closure_holds_every_free_point(space, rng):
    points = random_points(space, rng, SCATTERED)
    assert all(touching(space.compiled, points[space.contains(points)]))


def test_the_closure_holds_the_ends_of_chords(space, rng):
    """Just inside an end is free, just beyond it, almost surely, no point of the closure."""
    for point, direction in lines(space, rng):
        lower, upper = chord_or_empty(space.compiled, point, direction)
        if lower == upper:
            continue
        step = beyond_rounding(space) / np.linalg.norm(direction)
        at = np.array([lower - step, lower + step, upper - step, upper + step])
        ends = point + at[:, np.newaxis] * direction
        assert touching(space.compiled, ends) == [False, True, True, False]


def test_nothing_is_free_before_a_line_enters_and_something_after_it(space, rng):
    verdicts = set()
    for point, direction in lines(space, rng):
        is_touched, first, _ = line(space.compiled, point, direction, 0.0)
        assert (first == 0.0) == is_touched
        before = np.linspace(0.0, min(first, 3.0), ALONG)[:-1, np.newaxis]
        assert first == 0.0 or not space.contains(point + before * direction).any()
        if first < np.inf:
            step = beyond_rounding(space) / np.linalg.norm(direction)
            assert space.contains(point + (first + step) * direction)
        verdicts.add(first if first in (0.0, np.inf) else 'ahead')
    assert verdicts == {0.0, np.inf, 'ahead'}


def test_a_line_that_is_in_stays_where_it_is_and_one_that_is_out_too(space, rng):
    for point, direction in lines(space, rng):
        t = rng.uniform(0.0, 1.0)
        _, entry, end = line(space.compiled, point, direction, t)
        if space.contains(point + t * direction):
            assert entry == t
            assert end > t
        else:
            assert end == t


def test_a_line_leaves_where_it_would_have_left_from_anywhere_before(space, rng):
    for point, direction in lines(space, rng):
        _, upper = chord_or_empty(space.compiled, point, direction)
        for t in rng.uniform(0.0, 1.0, 3) * upper:
            end = line(space.compiled, point, direction, t).leaves
            assert end == pytest.approx(upper, abs=1e-9)


@pytest.mark.sweep
def test_interpreted_and_compiled_answer_alike(space, rng):
    for (point, direction), _ in zip(lines(space, rng), range(30), strict=False):
        with mode_of_thread(Mode.COMPILED):
            compiled = line(space.compiled, point, direction, 0.0)
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            plain = interpreted(line)(space.compiled, point, direction, 0.0)
        assert compiled == plain
