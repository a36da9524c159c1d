"""
The isoperimetric inequality of convex sets, computed (paper, Theorem 7).

A convex set is divided in three parts. If h(z) <= (1/3) min(1, d(x, y)) for all x in the first
part and y in the second whose chord passes through z, then the third part is large:
vol(third) >= E(h) min(vol(first), vol(second)). d is the cross-ratio distance (Definition 1).

Here h is the largest function that the condition allows, as far as chords in finitely many
directions show. That is too large rather than too small, so that the inequality computed is
stronger than the theorem's.
"""

from collections.abc import Callable
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import NDArray

#: Number of points on a chord whose parts are asked for, and of bisections where they differ.
N_ON_CHORD, N_BISECTIONS = 48, 16
#: Points for the volumes of the parts, for each point for the mean of h.
N_FOR_VOLUMES = 50


class Isoperimetry(NamedTuple):
    """
    Both sides of the inequality, in fractions of the set's volume.

    Attributes
    ----------
    third : float
        Volume of the third part.
    expected : float
        Mean of h over the set.
    smaller : float
        Volume of the smaller one of the first two parts.

    """

    third: float
    expected: float
    smaller: float

    @property
    def ratio(self) -> float:
        """Left side over right side: at least 1 by Theorem 7."""
        return self.third / (self.expected * self.smaller)


def isoperimetry(
    space: Space,
    part: Callable[[Floats], NDArray[np.int64]],
    *,
    n_points: int = 600,
    n_directions: int = 32,
    seed: int = 0,
) -> Isoperimetry:
    """
    Compute both sides of Theorem 7 for a convex set that is divided in three parts.

    Parameters
    ----------
    space : Space
        A convex set.
    part : callable
        Maps points (k, dim) to the numbers (k,) of their parts: 1, 2 or 3.
    n_points : int
        Number of uniform points z over which the mean of h is taken.
    n_directions : int
        Number of random directions of the chords through each z.
    seed : int
        Seed of points and directions.

    """
    n_points = check_count('n_points', n_points, 1)
    n_directions = check_count('n_directions', n_directions, 1)
    rng = np.random.default_rng(seed)
    points = _uniform(space, n_points, rng)
    least = np.full(n_points, np.inf)
    for k in range(n_directions):
        directions = _directions(space.dim, n_points, k / n_directions, 1.0 / n_directions, rng)
        np.minimum(least, _least_ratio(space, part, points, directions), out=least)
    many = part(_uniform(space, N_FOR_VOLUMES * n_points, rng))
    shares = np.bincount(many, minlength=4)[1:] / len(many)
    return Isoperimetry(
        float(shares[2]), float(np.minimum(1.0, least).mean() / 3.0), float(shares[:2].min())
    )


def _uniform(space: Space, n_points: int, rng: np.random.Generator) -> Floats:
    """Draw uniform points (n_points, dim) of a set by rejection from its bounds."""
    found = np.empty((0, space.dim))
    while len(found) < n_points:
        drawn = rng.uniform(*space.bounds, size=(2 * n_points, space.dim))
        found = np.concatenate([found, drawn[space.contains(drawn)]])
    return found[:n_points]


def _directions(
    dim: int, count: int, begin: float, step: float, rng: np.random.Generator
) -> Floats:
    """Draw unit vectors (count, dim), in the plane from one part of the half-circle."""
    if dim == 2:
        angle = np.pi * (begin + step * rng.random(count))
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    directions = rng.normal(size=(count, dim))
    return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def _least_ratio(
    space: Space,
    part: Callable[[Floats], NDArray[np.int64]],
    points: Floats,
    directions: Floats,
) -> Floats:
    """
    Return the least d(x, y) on the chord through each point (k, dim) in its direction: (k,).

    It is that of two points of the first and of the second part between which the chord has none
    of either: d grows as its points move apart. It is inf where one of the parts is missing.
    """
    behind, ahead = chords(space, points, directions)
    begin, chord = points - behind[:, None] * directions, (behind + ahead)[:, None] * directions

    def parts(along: Floats, which: NDArray[np.intp]) -> NDArray[np.int64]:
        """Return the parts at fractions of the chords ``which``."""
        return part(begin[which] + along[:, None] * chord[which])

    along = (np.arange(N_ON_CHORD) + 0.5) / N_ON_CHORD
    every = np.arange(len(points))
    seen = np.stack([parts(np.full(len(points), s), every) for s in along])
    least = np.full(len(points), np.inf)
    last = np.full((4, len(points)), np.nan)  # where each part was last left
    for k in range(N_ON_CHORD - 1):
        which = np.flatnonzero(seen[k] != seen[k + 1])
        before, after = seen[k][which], seen[k + 1][which]
        last[before, which] = _bisect(parts, which, before, along[k], along[k + 1])
        entered = _bisect(parts, which, after, along[k + 1], along[k])
        x = np.where(after < 3, last[3 - np.minimum(after, 2), which], np.nan)
        ratio = np.maximum(entered - x, 0.0) / (x * (1.0 - entered))
        least[which] = np.fmin(least[which], ratio)
    return least


def _bisect(
    parts: Callable[[Floats, NDArray[np.intp]], NDArray[np.int64]],
    which: NDArray[np.intp],
    wanted: NDArray[np.int64],
    inside: float,
    outside: float,
) -> Floats:
    """Return the last fraction of each chord, towards ``outside``, that is in part ``wanted``."""
    near, far = np.full(len(which), inside), np.full(len(which), outside)
    for _ in range(N_BISECTIONS):
        middle = (near + far) / 2.0
        is_in = parts(middle, which) == wanted
        near, far = np.where(is_in, middle, near), np.where(is_in, far, middle)
    return near
