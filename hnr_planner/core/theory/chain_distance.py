"""
Chain distance d-tilde(u, v) of two points, bracketed by bounds.

Definition (paper, Definition 2): the infimum, over chains u, z_1, ..., v of tau segments in the
set, of the sum of the cross-ratio distances of the segments. Here tau is ``n_links``.

On one chord the distances of subsegments sum to less than the distance of the ends. So more links
always give less, also between mutually visible points. In the limit of many links a path costs its
Hilbert length: the integral of ds (1/|x - a| + 1/|x - b|), where a and b are the ends of the chord
along the path; a segment costs log(1 + d).

With k links of total Hilbert length H, the sum of the k distances is at least k (exp(H / k) - 1),
since exp is convex; equal subsegments attain it. In a convex set no detour is shorter, and d-tilde
is exactly k ((1 + d)^(1/k) - 1).
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, check_point, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces import BallSpace, BoxSpace, PolytopeSpace, Space
from hnr_planner.core.theory.corners import corners
from hnr_planner.core.theory.cross_ratio import cross_ratio_distance, hilbert_distance
import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import ConvexHull

#: Number of random points of the set that a chain may pass before it is improved.
N_POINTS = 400


class Bounds(NamedTuple):
    """Lower and upper bound of a number."""

    lower: float
    upper: float


def even_chain_distance(ratio: float, n_links: float = math.inf) -> float:
    """
    Return the sum of cross-ratio distances of ``n_links`` equal subsegments of one segment.

    Subsegments are equal when their Hilbert lengths are. The sum equals d-tilde of the ends in
    convex sets, and bounds d-tilde from above for mutually visible points in other sets.

    Parameters
    ----------
    ratio : float
        Cross-ratio distance d of the ends of the segment.
    n_links : float
        Number of subsegments; infinite for the limit log(1 + d).

    """
    return _total(math.log1p(ratio), n_links)


def chain_distance(
    space: Space, u: ArrayLike, v: ArrayLike, n_links: float = math.inf, *, seed: int = 0
) -> Bounds:
    """
    Return bounds on d-tilde of two points of a set in the plane.

    Upper bound: the sum of cross-ratio distances along the best chain found over points of the
    set, after continuous optimization; inf when no chain was found. Lower bound: the larger of
    the distance of ``u`` and ``v`` in the convex hull, and of a bound from the shortest path
    between them, whose Hilbert length is at least 4 / D times its length; D is the diameter.

    Parameters
    ----------
    space : Space
        The set.
    u, v : (2,)
        Free points.
    n_links : float
        Number of segments of a chain; infinite for the limit of many segments.
    seed : int
        Seed of the random points that chains may pass at first.

    """
    if space.dim != 2:
        raise RequestError(f'chains are for the plane, the space has {space.dim} axes')
    if n_links != math.inf:
        check_count('n_links', n_links, 1)
    u, v = check_point('u', u, 2), check_point('v', v, 2)
    turns = corners(space).turns
    nodes = np.concatenate([[u, v], turns, _scattered(space, seed)])
    ratios, n_first = _pairwise(space, nodes), 2 + len(turns)
    hull = hull_of(space)
    in_hull = float(hilbert_distance(cross_ratio_distance(hull, u, v))[0])
    shortest = _shortest_length(nodes[:n_first], ratios[:n_first, :n_first])
    by_length = 4.0 * shortest / _diameter(hull)
    lower = _total(max(in_hull, by_length), n_links)
    chain = _best_chain(nodes, ratios, n_links)
    if chain is None:
        return Bounds(lower, math.inf)
    upper = _improved(space, chain, n_links)
    return Bounds(lower, max(upper, lower))


def chain_cost(space: Space, chain: Floats, n_links: float) -> float:
    """
    Return the cost of a chain of points (m, dim), the ends of its m - 1 segments.

    The cost is the sum of the segments' cross-ratio distances; for infinite ``n_links``, the sum
    of their Hilbert distances. It is inf if a segment is not free.
    """
    ratios = cross_ratio_distance(space, chain[:-1], chain[1:])
    return float((hilbert_distance(ratios) if n_links == math.inf else ratios).sum())


def hull_of(space: Space) -> Space:
    """Return the convex hull of a set in the plane; its bounding box if corners are unknown."""
    if isinstance(space, BallSpace | BoxSpace | PolytopeSpace):
        return space
    points = corners(space).points
    if len(points) == 0:
        return BoxSpace(*space.bounds)
    sides = ConvexHull(points).equations
    return PolytopeSpace(sides[:, :2], -sides[:, 2])


def _total(hilbert: float, n_links: float) -> float:
    """Return the sum of cross-ratio distances of equal links of total length ``hilbert``."""
    return hilbert if n_links == math.inf else n_links * math.expm1(hilbert / n_links)


def _scattered(space: Space, seed: int) -> Floats:
    """Return up to ``N_POINTS`` uniform points (k, 2) of the set."""
    rng = np.random.default_rng(seed)
    drawn = rng.uniform(*space.bounds, size=(20 * N_POINTS, 2))
    return drawn[space.contains(drawn)][:N_POINTS]


def _diameter(hull: Space) -> float:
    """Return the diameter of a convex set [m]."""
    if isinstance(hull, BallSpace):
        return 2.0 * hull.radius
    points = corners(hull).points
    return float(np.linalg.norm(points[:, None] - points, axis=2).max())


def _pairwise(space: Space, nodes: Floats) -> Floats:
    """Return the cross-ratio distances (k, k) of points (k, 2); inf for pairs not visible."""
    first, second = np.triu_indices(len(nodes), 1)
    ratios = np.zeros((len(nodes), len(nodes)))
    ratios[first, second] = cross_ratio_distance(space, nodes[first], nodes[second])
    return ratios + ratios.T


def _shortest_length(nodes: Floats, ratios: Floats) -> float:
    """
    Return a lower bound [m] on the length of the shortest path from node 0 to node 1.

    The path runs over ``nodes`` (k, 2), between pairs with finite ``ratios`` (k, k). Where no path
    is found, the bound is the straight distance.
    """
    straight = float(np.linalg.norm(nodes[1] - nodes[0]))
    if len(nodes) == 2:
        return straight
    visible = np.isfinite(ratios)
    lengths = np.where(visible, np.linalg.norm(nodes[:, None] - nodes, axis=2), 0.0)
    found = float(dijkstra(lengths, indices=0)[1])
    # The path turns beside corners, not at them, and so is slightly longer than the shortest.
    return max(straight, found * (1.0 - 1e-6)) if math.isfinite(found) else straight


def _best_chain(nodes: Floats, ratios: Floats, n_links: float) -> Floats | None:
    """
    Return the cheapest chain (m, 2) over ``nodes`` (k, 2), from node 0 to node 1.

    ``ratios`` (k, k) are the cross-ratio distances of the nodes. None if no chain of ``n_links``
    segments joins node 0 to node 1.
    """
    if n_links == math.inf:
        costs = np.where(np.isfinite(ratios), np.log1p(np.minimum(ratios, 1e300)), 0.0)
        total, before = dijkstra(costs, indices=0, return_predecessors=True)
        steps = [1]
        while steps[-1] > 0:
            steps.append(int(before[steps[-1]]))
        return nodes[steps[::-1]] if math.isfinite(total[1]) else None
    cost, choices = ratios[0], []
    for _ in range(int(n_links) - 1):
        through = cost[:, None] + ratios
        choices.append(np.argmin(through, axis=0))
        cost = through.min(axis=0)
    if not math.isfinite(cost[1]):
        return None
    steps = [1]
    for choice in reversed(choices):
        steps.append(int(choice[steps[-1]]))
    return nodes[[0, *steps[::-1]]]


def _improved(space: Space, chain: Floats, n_links: float) -> float:
    """Return the cost of a chain (m, 2) after its inner points have been optimized."""
    cost = chain_cost(space, chain, n_links)
    if len(chain) == 2:
        return cost

    def moved(inner: Floats) -> float:
        points = np.concatenate([chain[:1], inner.reshape(-1, 2), chain[-1:]])
        return min(chain_cost(space, points, n_links), 1e6 * (1.0 + cost))

    found = minimize(moved, chain[1:-1].ravel(), method='Powell', options={'xtol': 1e-7})
    return min(cost, float(found.fun))
