"""
Transition density f_u of one step of Hit-and-Run from u.

Definition (paper, equation (2)): f_u(v) = 2 / (n pi_n |l(u, v)| |u - v|^(n-1)) for v visible from
u, else 0. l(u, v) is the chord through u and v, pi_n the volume of the unit ball.
"""

import math

from hnr_planner.core.checks import check_point, check_points, Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import ArrayLike


def log_ball_volume(dim: int) -> float:
    """Return the logarithm of the volume of the unit ball in ``dim`` dimensions: log pi_n."""
    return dim / 2.0 * math.log(math.pi) - math.lgamma(dim / 2.0 + 1.0)


def transition_density(space: Space, u: ArrayLike, points: ArrayLike) -> Floats:
    """
    Return the density at ``points`` of one step of Hit-and-Run from ``u``.

    The line through v is hit with density ``1 / (n pi_n |u - v|^(n-1))`` by each of its two
    directions; then the position on the chord has density ``1 / |chord|``. The density is 0 at
    points not visible from ``u``.

    Parameters
    ----------
    space : Space
        The set.
    u : (dim,)
        A free point.
    points : (k, dim)
        Points v; at ``u`` itself the density is infinite for dim > 1.

    Returns
    -------
    (k,) float64
        Density [1/m^dim] of the end of the step at each point.

    """
    u = check_point('u', u, space.dim)
    v = np.atleast_2d(check_points('points', points, space.dim))
    away = v - u
    distance = np.linalg.norm(away, axis=1)
    distinct = distance > 0.0
    directions = np.divide(
        away, distance[:, None], where=distinct[:, None], out=np.ones_like(away)
    )
    behind, ahead = chords(space, u, directions)
    density = np.zeros(len(v))
    visible = distinct & (ahead > distance)
    # (2): f_u(v) = 2 1{v in view(u)} / (n pi_n |l(u, v)| |u - v|^(n-1))
    density[visible] = 2.0 / (
        space.dim
        * math.exp(log_ball_volume(space.dim))
        * (behind + ahead)[visible]
        * distance[visible] ** (space.dim - 1)
    )
    density[~distinct] = math.inf
    return density
