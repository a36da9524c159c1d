"""
Probabilities, means and lengths of one step of Hit-and-Run from a free point u.

- step probability P_u(A): the integral of the density f_u over A (paper, Section 3.1);
- step length F(u): the length that a step does not exceed with probability 1/8 (Section 3.3,
  before equation (6));
- overlap of the steps from u and v: 1 minus the total variation distance of their
  distributions (Lemma 12);
- unseen probability: that a step from u is not visible from v (Lemma 11).
"""

from collections.abc import Callable

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.density import transition_density
from hnr_planner.core.theory.rays import chords, half_sphere, lengths_within, reach
import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

#: Approximate number of lines through a point in a quadrature, and of points on each line.
N_DIRECTIONS = 720
N_POSITIONS = 128


def step_probability(
    space: Space, u: ArrayLike, region: Space, n_directions: int = N_DIRECTIONS
) -> float:
    """
    Return the probability P_u(A) that a step from ``u`` (dim,) ends in ``region``.

    It is the mean, over all lines through ``u``, of the fraction of the chord in the region. The
    fraction is exact on each line. The mean is exact to rounding in the plane if the boundaries of
    space and region are straight and their corners are known.
    """
    u = _free_point(space, u)
    directions, weights = half_sphere(u, n_directions, space, region)
    behind, ahead = chords(space, u, directions)
    points = np.broadcast_to(u, directions.shape)
    inside = lengths_within(region, points, directions, -behind, ahead)
    return float(weights @ (inside / (behind + ahead)))


def step_mean(
    space: Space,
    u: ArrayLike,
    function: Callable[[Floats], Floats],
    n_directions: int = N_DIRECTIONS,
    n_positions: int = N_POSITIONS,
) -> float:
    """
    Return the mean of ``function`` at the end of a step from ``u`` (dim,).

    ``function`` takes points (k, dim) and returns values (k,). The mean over lines through ``u``
    is that of ``half_sphere``, the mean on each chord the midpoint rule with ``n_positions``
    points.
    """
    u = _free_point(space, u)
    directions, weights = half_sphere(u, n_directions, space)
    behind, ahead = chords(space, u, directions)
    fractions = (np.arange(n_positions) + 0.5) / n_positions
    s = -behind[:, None] + fractions * (behind + ahead)[:, None]
    points = u + s[:, :, None] * directions[:, None, :]
    values = function(points.reshape(-1, space.dim)).reshape(s.shape)
    return float(weights @ values.mean(axis=1))


def step_length(
    space: Space, u: ArrayLike, probability: float = 1.0 / 8.0, n_directions: int = N_DIRECTIONS
) -> float:
    """
    Return the length [m] that a step from ``u`` (dim,) does not exceed with ``probability``.

    With the default 1/8 it is the paper's F(u) (Section 3.3, before equation (6)).
    """
    u = _free_point(space, u)
    directions, weights = half_sphere(u, n_directions, space)
    behind, ahead = chords(space, u, directions)

    def excess(length: float) -> float:
        within = np.minimum(length, behind) + np.minimum(length, ahead)
        return float(weights @ (within / (behind + ahead))) - probability

    farthest = float(max(behind.max(), ahead.max()))
    return float(brentq(excess, 0.0, farthest, xtol=1e-14 * farthest))


def step_overlap(space: Space, u: ArrayLike, v: ArrayLike) -> float:
    """
    Return the overlap of the distributions of a step from ``u`` and of a step from ``v`` (dim,).

    The overlap is the integral of min(f_u, f_v), the smaller density: 1 minus the total variation
    distance of the two distributions. It is computed as the mean of min(1, f_v / f_u) over the
    end of a step from ``u``.
    """
    u, v = _free_point(space, u), _free_point(space, v)
    if (u == v).all():
        return 1.0

    def ratio(points: Floats) -> Floats:
        of_u = transition_density(space, u, points)
        return np.minimum(1.0, transition_density(space, v, points) / of_u)

    return step_mean(space, u, ratio)


def unseen_probability(space: Space, u: ArrayLike, v: ArrayLike) -> float:
    """Return the probability that a step from ``u`` ends at a point not visible from ``v``."""
    u, v = _free_point(space, u), _free_point(space, v)

    def unseen(points: Floats) -> Floats:
        away = points - v
        distance = np.linalg.norm(away, axis=1)
        return reach(space, v, away / distance[:, None]) <= distance

    return step_mean(space, u, unseen)


def _free_point(space: Space, u: ArrayLike) -> Floats:
    """Return ``u`` (dim,) as a free point, or raise RequestError."""
    point = check_point('point', u, space.dim)
    if not space.contains(point):
        raise RequestError(f'point {point.tolist()} is {space.why_not_free(point)}')
    return point
