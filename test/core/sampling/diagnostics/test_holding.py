"""Repeated draws and holding times are counted for each chain."""

from itertools import pairwise

from hnr_planner.core.sampling.diagnostics.holding import frozen, longest_holding_time, repeats
import numpy as np
import pytest


def draws(*chains):
    """Return draws in the plane of chains of digits; the second coordinate never changes."""
    x = np.array([[float(digit) for digit in chain] for chain in chains])
    return np.stack([x, np.ones_like(x)], axis=2)


@pytest.mark.parametrize(
    ('chain', 'count', 'longest'),
    [
        ('12345', 0, 1),
        ('11234', 1, 2),
        ('12344', 1, 2),
        ('11233', 2, 2),
        ('12223', 2, 3),
        ('11111', 4, 5),
        ('12121', 0, 1),
        ('22122', 2, 2),
    ],
)
def test_repeats_and_the_longest_holding_time(chain, count, longest):
    both = draws(chain, '98765')
    assert repeats(both).tolist() == [count, 0]
    assert longest_holding_time(both).tolist() == [longest, 1]


def test_a_draw_repeats_when_all_of_its_coordinates_do():
    zigzag = np.array([[[0, 0], [0, 1], [1, 1], [1, 1], [1, 0.0]]])
    assert repeats(zigzag).tolist() == [1]


def test_a_frozen_coordinate_differs_from_one_that_comes_back():
    both = draws('1211', '1111')
    assert frozen(both).tolist() == [[False, True], [True, True]]


def test_against_loops():
    x = np.random.default_rng(0).integers(2, size=(50, 40, 1)).astype(float)
    for k, chain in enumerate(x):
        times = [1]
        for before, now in pairwise(chain):
            times[-1:] = [times[-1] + 1] if before == now else [times[-1], 1]
        assert repeats(x)[k] == 40 - len(times)
        assert longest_holding_time(x)[k] == max(times)
