"""
Cross-ratio distance d_Sigma(u, v) of two mutually visible points.

Definition (paper, Definition 1): |a - b| |u - v| / (|a - u| |v - b|), where a and b are the ends
of the chord through u and v, in the order a, u, v, b.
"""

from hnr_planner.core.checks import check_points, Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import ArrayLike


def cross_ratio_distance(space: Space, u: ArrayLike, v: ArrayLike) -> Floats:
    """
    Return the cross-ratio distances ``|a - b| |u - v| / (|a - u| |v - b|)`` of pairs of points.

    The distance has no unit and is invariant under affine maps. It is not a metric: on a chord,
    the distances of subsegments sum to less than that of the ends (Lemma 9).
    ``hilbert_distance`` is a metric in convex sets.

    Parameters
    ----------
    space : Space
        The set.
    u, v : (k, dim) or (dim,)
        Free points: point k of ``u`` is paired with point k of ``v``; a single point is paired
        with every point of the other argument.

    Returns
    -------
    (k,) float64
        Distance of each pair: inf where the two points are not mutually visible, 0 where they
        are equal.

    """
    u = np.atleast_2d(check_points('u', u, space.dim))
    v = np.atleast_2d(check_points('v', v, space.dim))
    u, v = np.broadcast_arrays(u, v)
    distance = np.linalg.norm(v - u, axis=1)
    distinct = distance > 0.0
    directions = np.divide(v - u, distance[:, None], where=distinct[:, None], out=np.ones(u.shape))
    behind, ahead = chords(space, u, directions)
    beyond = ahead - distance
    ratio = np.full(len(u), np.inf)
    visible = distinct & (behind > 0.0) & (beyond > 0.0)
    length = (behind + ahead)[visible]
    ratio[visible] = length * distance[visible] / (behind[visible] * beyond[visible])
    ratio[~distinct & (behind > 0.0)] = 0.0
    return ratio


def hilbert_distance(ratio: ArrayLike) -> Floats:
    """
    Return Hilbert's distance log(1 + d) of cross-ratio distances d.

    It is additive along a chord, so that it is the limit of the sum of d over ever shorter
    subsegments. In a convex set it is a metric (Hilbert 1895).
    """
    return np.log1p(np.asarray(ratio, dtype=np.float64))
