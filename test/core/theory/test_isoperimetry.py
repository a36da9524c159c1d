"""Theorem 7, computed: the third part of a convex set is as large as it says."""

from test.core.theory.sets import SQUARE
from test.core.theory.stars import DIVIDED, divided, strip
from test.sweeps import sweep_but

from hnr_planner.core import RequestError
from hnr_planner.core.theory import isoperimetry
import pytest


@pytest.mark.parametrize('name', sweep_but(['disc, ring of .2', 'square, corner'], DIVIDED))
def test_the_inequality_holds(name):
    """Errors of the drawn points are a few percent; the least ratio is 1.3."""
    assert divided(name).ratio > 1.1


@pytest.mark.sweep
def test_it_would_not_hold_without_the_third():
    """The mutant: h = min(1, d)."""
    assert sum(divided(name).ratio / 3.0 < 0.9 for name in DIVIDED) == 4


def test_a_strip_by_hand():
    """A thin strip in the middle of a square: along x, d = t / .25 for a width t."""
    thin = 1e-3
    sides = isoperimetry(SQUARE, strip(0.5 - thin / 2, 0.5 + thin / 2), n_directions=128)
    assert sides.third == pytest.approx(thin, rel=0.5)
    assert sides.smaller == pytest.approx(0.5, abs=0.02)
    # Chords through the strip's middle are at most sqrt(2) long, and d is then the least.
    assert thin * 4.0 / 3.0 * 0.9 < sides.expected < thin * 4.0 / 3.0 * 1.5


def test_no_second_part_means_no_condition():
    sides = isoperimetry(SQUARE, strip(0.5, 2.0), n_points=50, n_directions=4)
    assert sides.expected == pytest.approx(1.0 / 3.0)
    assert sides.smaller == 0.0


@pytest.mark.parametrize('name', ['n_points', 'n_directions'])
def test_bad_counts_are_refused(name):
    with pytest.raises(RequestError, match=name):
        isoperimetry(SQUARE, strip(0.4, 0.6), **{name: 0})
