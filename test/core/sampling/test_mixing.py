"""
How long a walk takes from one room to the other, against the theory.

Two unit squares share a wall, thin as numbers allow, with a door in its middle. The conductance
of the cut between them follows from the lines through the door, and bounds the relaxation time
from below by 1 / (2 Phi); as long as the door is narrow there is little else that takes time.
"""

from functools import cache
import math

from hnr_planner.core import BoxSpace, DifferenceSpace, relaxation_time, sample
import numpy as np
import pytest
from scipy.integrate import dblquad

WALL = 1e-6
CHAINS, DRAWS = 40, 50_000


@cache
def conductance(door: float) -> float:
    """
    Return the probability that a uniform point of one room steps to the other.

    A step from x to y has the density 1 / (pi |x - y| l), with l the length of their chord. Over
    all pairs on one line, a towards one end of the door's point and b towards the other, that is
    a b / (pi (a + b)); lines are counted by the height at which they cross the door, and by the
    sine of their angle to it.
    """

    def flow(height: float, angle: float) -> float:
        across, along = abs(math.cos(angle)), math.sin(angle)
        a = min(1 / across, (1 - height) / along) if along > 0 else 1 / across
        b = min(1 / across, height / along) if along > 0 else 1 / across
        return across * a * b / (math.pi * (a + b))

    total, _ = dblquad(flow, 0, math.pi / 2, 0.5 - door / 2, 0.5 + door / 2)
    return 2 * total


@cache
def walked(door: float):
    """Return points (CHAINS, DRAWS, 2) of chains of Hit-and-Run; the wall is at x = 0."""
    space = DifferenceSpace(
        BoxSpace((-1.0, 0.0), (1.0, 1.0)),
        BoxSpace((-WALL, -1.0), (WALL, 0.5 - door / 2)),
        BoxSpace((-WALL, 0.5 + door / 2), (WALL, 2.0)),
    )
    return sample(space, (-0.5, 0.5), DRAWS, n_chains=CHAINS, burn_in=300, seed=1)


def ninths(points):
    """Return which of nine squares of which room each point is in."""
    room = points[..., 0] > 0
    column, row = (np.minimum(np.abs(x) * 3, 2).astype(int) for x in np.moveaxis(points, -1, 0))
    return (room * 3 + column) * 3 + row


@pytest.mark.parametrize(('door', 'known'), [(0.05, 36.3), (0.2, 9.15)])
def test_moves_between_the_rooms_are_as_frequent_as_the_conductance_says(door, known):
    """Two million steps, 27000 of them through the narrower door: to a thirtieth, 5 sigma."""
    assert 1 / (2 * conductance(door)) == pytest.approx(known, rel=0.001)
    rooms = (walked(door)[:, :, 0] > 0).astype(int)
    assert relaxation_time(rooms) == pytest.approx(known, rel=0.03)


@pytest.mark.parametrize(('door', 'measured'), [(0.05, 38.2), (0.2, 10.4)])
def test_the_walk_relaxes_little_slower_than_the_conductance_allows(door, measured):
    """To a thirtieth of what ten million steps gave, and above 1 / (2 Phi)."""
    time = relaxation_time(ninths(walked(door)), lag=10)
    assert time == pytest.approx(measured, rel=0.03)
    assert 1 / (2 * conductance(door)) < time < 1.2 / (2 * conductance(door))
