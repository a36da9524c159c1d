"""The law of one step: density of where Hit-and-Run goes next (paper, equation (2), f_u)."""

import math

from hnr_planner.core.checks import check_point, check_points, Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import ArrayLike


def log_ball_volume(dim: int) -> float:
    """Logarithm of the volume of the ball of radius 1: the paper's pi_n."""
    return dim / 2.0 * math.log(math.pi) - math.lgamma(dim / 2.0 + 1.0)


def transition_density(space: Space, u: ArrayLike, points: ArrayLike) -> Floats:
    """
    Density at ``points`` of the point that one step of Hit-and-Run takes from ``u``.

    A direction falls on ``v`` with density 1 / (n pi_n |u - v|^(n-1)) from either side of the
    line, and then the place on the chord with density 1 / |chord|. Points that ``u`` does not see
    get 0.

    Parameters
    ----------
    space : Space
        The set.
    u : (dim,)
        A free point.
    points : (k, dim)
        Where to look; at ``u`` itself the density is infinite for dim > 1.

    Returns
    -------
    (k,) float64

    """
    u = check_point('u', u, space.dim)
    v = np.atleast_2d(check_points('points', points, space.dim))
    away = v - u
    distance = np.linalg.norm(away, axis=1)
    apart = distance > 0.0
    directions = np.divide(away, distance[:, None], where=apart[:, None], out=np.ones_like(away))
    behind, ahead = chords(space, u, directions)
    density = np.zeros(len(v))
    seen = apart & (ahead > distance)
    # (2): f_u(v) = 2 1{v in view(u)} / (n pi_n |l(u, v)| |u - v|^(n-1))
    density[seen] = 2.0 / (
        space.dim
        * math.exp(log_ball_volume(space.dim))
        * (behind + ahead)[seen]
        * distance[seen] ** (space.dim - 1)
    )
    density[~apart] = math.inf
    return density
