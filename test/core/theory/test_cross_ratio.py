"""Laws of the cross-ratio distance."""

import math
from test.core.theory.sets import BALL, CUBE, DISC, L_SET, PLUS, scattered, SQUARE
from test.laws.maps import U_SHAPE

from hnr_planner.core import BoxSpace, GridSpace, PolytopeSpace
from hnr_planner.core.theory import cross_ratio_distance, hilbert_distance
import numpy as np
import pytest

SETS = pytest.mark.parametrize('space', [DISC, SQUARE, L_SET, PLUS, BALL, CUBE])
CONVEX = pytest.mark.parametrize('space', [DISC, SQUARE, BALL, CUBE])


def test_a_disc_by_hand():
    """Chord of length 2, points 1 apart and .5 from its ends: 2 * 1 / (.5 * .5)."""
    assert cross_ratio_distance(DISC, (-0.5, 0), (0.5, 0)) == pytest.approx(8)


def test_an_ell_by_hand():
    """Along the bottom of the L: chord 2, points 1 apart, .25 and .75 from its ends."""
    assert cross_ratio_distance(L_SET, (0.25, 0.5), (1.25, 0.5)) == pytest.approx(2 / 0.1875)


@SETS
def test_it_is_symmetric_and_finite_where_points_see_each_other(space):
    u, v = scattered(space, 300, 1), scattered(space, 300, 2)
    there = cross_ratio_distance(space, u, v)
    assert there == pytest.approx(cross_ratio_distance(space, v, u), rel=1e-9)
    seen = [space.is_motion_valid(a, b) for a, b in zip(u, v, strict=True)]
    assert np.isfinite(there).tolist() == seen
    assert (cross_ratio_distance(space, u, u) == 0).all()


@SETS
def test_it_is_at_least_four_lengths_by_the_diameter(space):
    """After Definition 1: d >= 4 |u - v| / D."""
    u, v = scattered(space, 300, 1), scattered(space, 300, 2)
    diameter = np.linalg.norm(np.ptp(space.bounds, axis=0))
    apart = np.linalg.norm(u - v, axis=1)
    assert (cross_ratio_distance(space, u, v) >= 4 * apart / diameter).all()


@SETS
def test_parts_of_a_chord_sum_up_to_less_and_their_hilbert_lengths_to_the_whole(space):
    """Lemma 9."""
    u, v = scattered(space, 300, 1), scattered(space, 300, 2)
    whole = cross_ratio_distance(space, u, v)
    u, v, whole = u[whole < 1e3], v[whole < 1e3], whole[whole < 1e3]
    assert len(u) > 50
    between = u + np.random.default_rng(3).random((len(u), 1)) * (v - u)
    parts = cross_ratio_distance(space, u, between), cross_ratio_distance(space, between, v)
    assert (sum(parts) < whole).all()
    assert sum(map(hilbert_distance, parts)) == pytest.approx(hilbert_distance(whole), rel=1e-6)


@CONVEX
def test_hilberts_distance_is_a_metric_in_convex_sets(space):
    a, b, c = (hilbert_distance(d) for d in distances_of_three(space))
    assert (a <= b + c + 1e-9).all()


def test_hilberts_distance_is_none_in_others():
    """A chain through the arms of the plus is shorter than the short chord across its middle."""
    middle = np.full((1, 2), 3.5)
    u, v, z = middle - 0.1, middle + 0.1, middle + (0.1, -0.1)
    direct = hilbert_distance(cross_ratio_distance(PLUS, u, v))
    around = [cross_ratio_distance(PLUS, u, z), cross_ratio_distance(PLUS, z, v)]
    assert direct > 3 * sum(map(hilbert_distance, around))


@CONVEX
def test_it_is_none_anywhere(space):
    a, b, c = distances_of_three(space)
    assert (a > b + c).any()


def distances_of_three(space):
    u, v, w = (scattered(space, 200, seed) for seed in (1, 2, 3))
    near = (u + v) / 2 + (w - (u + v) / 2) / 10
    yield cross_ratio_distance(space, u, v)
    yield cross_ratio_distance(space, u, near)
    yield cross_ratio_distance(space, near, v)


def test_similarities_keep_it():
    """The same grid, turned, moved and made smaller."""
    turned = GridSpace.from_blocked(U_SHAPE, 0.05, (3.0, -2.0, 0.7))
    plain = GridSpace.from_blocked(U_SHAPE)
    u, v = scattered(plain, 300, 1), scattered(plain, 300, 2)
    moved = [turned.from_kernel(plain.to_kernel(points)) for points in (u, v)]
    here, there = cross_ratio_distance(plain, u, v), cross_ratio_distance(turned, *moved)
    assert here[here < 1e6] == pytest.approx(there[here < 1e6], rel=1e-7)


@pytest.mark.interpreted
@pytest.mark.parametrize('dim', [2, 3, 6])
def test_affine_maps_keep_it(dim):
    rng = np.random.default_rng(4)
    matrix, offset = rng.normal(size=(dim, dim)), rng.normal(size=dim)
    sides = np.concatenate([np.eye(dim), -np.eye(dim)])
    limits = np.concatenate([np.ones(dim), np.zeros(dim)])
    image_sides = sides @ np.linalg.inv(matrix)
    image = PolytopeSpace(image_sides, limits + image_sides @ offset)
    cube = BoxSpace(np.zeros(dim), np.ones(dim))
    u, v = rng.random((100, dim)), rng.random((100, dim))
    there = cross_ratio_distance(image, u @ matrix.T + offset, v @ matrix.T + offset)
    assert cross_ratio_distance(cube, u, v) == pytest.approx(there, rel=1e-6)


def test_points_that_do_not_see_each_other_have_none():
    assert cross_ratio_distance(L_SET, (0.5, 1.9), (1.9, 0.5)) == math.inf
    assert cross_ratio_distance(L_SET, (0.5, 0.5), (1.5, 1.5)) == math.inf
    assert cross_ratio_distance(L_SET, (1.5, 1.5), (0.5, 0.5)) == math.inf
