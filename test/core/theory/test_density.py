"""
The density of a step is a density, and the one that the walk has.

Integrals are means over N points; each is compared at 6.5 standard errors, which 15 right ones
would exceed once in 1e9 runs.
"""

import math
from test.core.theory.sets import BALL, CUBE, DISC, L_SET, SQUARE, walked

from hnr_planner.core import BoxSpace
from hnr_planner.core.theory import step_probability, transition_density
from hnr_planner.core.theory.rays import chords
import numpy as np
import pytest

N = 200_000
STANDARD_ERRORS = 6.5

PLACES = pytest.mark.parametrize(
    ('space', 'u'),
    [
        (DISC, (0.3, -0.2)),
        (SQUARE, (0.9, 0.05)),
        (L_SET, (1.6, 0.7)),
        (BALL, (0.1, 0.5, -0.6)),
        (CUBE, (0.2, 0.5, 0.9)),
    ],
    ids=['disc', 'square', 'ell', 'ball', 'cube'],
)


def standard_errors_from_one(density, space, u, seed):
    """Integrate over space, in directions and distances from u, and compare with 1."""
    rng = np.random.default_rng(seed)
    dim, farthest = space.dim, float(np.linalg.norm(np.ptp(space.bounds, axis=0)))
    directions = rng.normal(size=(N, dim))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    distance = farthest * rng.random(N)
    sphere = 2 * math.pi ** (dim / 2) / math.gamma(dim / 2)
    values = density(space, np.array(u), u + distance[:, None] * directions)
    values = values * (sphere * farthest * distance ** (dim - 1))
    return abs(values.mean() - 1) / (values.std() / math.sqrt(N))


@PLACES
def test_it_integrates_to_one(space, u):
    assert standard_errors_from_one(transition_density, space, u, 1) < STANDARD_ERRORS


def half_of_it(space, u, v):
    return transition_density(space, u, v) / 2


def power_of_the_dimension(space, u, v):
    return transition_density(space, u, v) / np.linalg.norm(v - u, axis=1)


def ray_instead_of_chord(space, u, v):
    away = v - u
    behind, ahead = chords(space, u, away / np.linalg.norm(away, axis=1, keepdims=True))
    return transition_density(space, u, v) * (behind + ahead) / ahead


def through_walls(space, u, v):
    unseen = space.contains(v) & (transition_density(space, u, v) == 0)
    lengths = np.linalg.norm(v - u, axis=1)
    return transition_density(space, u, v) + unseen / (math.pi * 2 * lengths)


@pytest.mark.parametrize(
    ('mutant', 'space', 'u'),
    [
        (half_of_it, SQUARE, (0.9, 0.05)),
        (power_of_the_dimension, CUBE, (0.2, 0.5, 0.9)),
        (ray_instead_of_chord, DISC, (0.3, -0.2)),
        (through_walls, L_SET, (1.6, 0.7)),
    ],
    ids=lambda value: getattr(value, '__name__', ''),
)
def test_what_is_no_density_is_caught(mutant, space, u):
    assert standard_errors_from_one(mutant, space, u, 1) > STANDARD_ERRORS


@PLACES
def test_the_way_back_is_as_likely(space, u):
    """Reversibility: f_u(v) = f_v(u)."""
    rng = np.random.default_rng(2)
    others = rng.uniform(*space.bounds, size=(100, space.dim))
    others = others[space.contains(others)]
    there = transition_density(space, u, others)
    back = [transition_density(space, v, u)[0] for v in others]
    assert there == pytest.approx(back, rel=1e-9)
    assert (there > 0).tolist() == [space.is_motion_valid(u, v) for v in others]


def test_it_is_infinite_at_the_point_itself():
    assert transition_density(DISC, (0.3, 0), [(0.3, 0), (0.3, 2)]).tolist() == [math.inf, 0]


@pytest.mark.parametrize(
    ('space', 'u', 'part'),
    [
        (L_SET, (1.6, 0.7), BoxSpace((0, 0), (0.5, 1))),
        (SQUARE, (0.9, 0.05), BoxSpace((0, 0.4), (0.7, 1))),
        (CUBE, (0.2, 0.5, 0.9), BoxSpace((0, 0, 0), (0.7, 0.3, 0.4))),
    ],
    ids=['ell', 'square', 'cube'],
)
def test_its_integral_over_a_part_is_how_often_the_walk_goes_there(space, u, part):
    """N steps; and P_u(A) by quadrature over directions, to 2e-3 of itself."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    lower, upper = part.bounds
    axes = [a + (b - a) * (nodes + 1) / 2 for a, b in zip(lower, upper, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing='ij'), axis=-1).reshape(-1, space.dim)
    each = np.stack(np.meshgrid(*[weights / 2] * space.dim, indexing='ij'), axis=-1).prod(axis=-1)
    integral = each.ravel() @ transition_density(space, u, points) * np.prod(upper - lower)
    assert step_probability(space, u, part, 20_000) == pytest.approx(integral, rel=2e-3)
    ends = walked(space, np.tile(u, (N, 1)), seed=3)
    there = part.contains(ends).mean()
    assert abs(there - integral) < STANDARD_ERRORS * math.sqrt(integral / N)
