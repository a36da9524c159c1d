"""The cross-ratio distance of two points that see each other (paper, Definition 1, d_Sigma)."""

from hnr_planner.core.checks import check_points, Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import ArrayLike


def cross_ratio_distance(space: Space, u: ArrayLike, v: ArrayLike) -> Floats:
    """
    Cross-ratio distance |a - b| |u - v| / (|a - u| |v - b|) on the chord [a, u, v, b].

    It has no unit, and stays the same under affine maps. It is no metric: on a chord the parts sum
    up to less than the whole (Lemma 9). ``hilbert_distance`` of it is one in convex sets.

    Parameters
    ----------
    space : Space
        The set.
    u, v : (k, dim) or (dim,)
        Free points, paired.

    Returns
    -------
    (k,) float64
        inf for points that do not see each other.

    """
    u = np.atleast_2d(check_points('u', u, space.dim))
    v = np.atleast_2d(check_points('v', v, space.dim))
    u, v = np.broadcast_arrays(u, v)
    distance = np.linalg.norm(v - u, axis=1)
    apart = distance > 0.0
    directions = np.divide(v - u, distance[:, None], where=apart[:, None], out=np.ones(u.shape))
    behind, ahead = chords(space, u, directions)
    beyond = ahead - distance
    ratio = np.full(len(u), np.inf)
    seen = apart & (behind > 0.0) & (beyond > 0.0)
    ratio[seen] = (behind + ahead)[seen] * distance[seen] / (behind[seen] * beyond[seen])
    ratio[~apart & (behind > 0.0)] = 0.0
    return ratio


def hilbert_distance(ratio: ArrayLike) -> Floats:
    """
    Hilbert's distance log(1 + d) of cross-ratio distances d.

    Along a chord it adds up, so it is what ever shorter steps make of d; in a convex set it is a
    metric (Hilbert 1895).
    """
    return np.log1p(np.asarray(ratio, dtype=np.float64))
