"""Quadrature along rays: chords of many lines at once, and means over directions at a point."""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import contains, first_entry, first_exit
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.corners import corners
import numpy as np
from numpy.typing import NDArray

#: Where a line touches a space, whether it enters is tested this fraction of the line farther on.
PROBE = 1e-10
#: Order of the Gauss rule between the directions of two corners.
ORDER = 12


def reach(space: Space, points: Floats, directions: Floats) -> Floats:
    """
    Return the distances from points to the boundary, from point k along direction k.

    Parameters
    ----------
    space : Space
        The set.
    points : (k, dim)
        Points; the distance from a point that is not free is 0.
    directions : (k, dim)
        Unit vectors.

    Returns
    -------
    (k,) float64
        Distances [m].

    """
    return _reach(space.compiled, *_in_rows(points, directions))


def chords(space: Space, points: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """
    Return the distances (k,) backward and forward from points to the ends of their chords.

    ``points`` and ``directions`` are (k, dim), and directions are unit vectors. Point k lies on a
    chord along direction k. Both distances [m] are 0 for points that are not free.
    """
    points, directions = _in_rows(points, directions)
    return _reach(space.compiled, points, -directions), _reach(space.compiled, points, directions)


def pieces(
    space: Space, points: Floats, directions: Floats, lower: Floats, upper: Floats
) -> tuple[NDArray[np.int64], Floats, Floats]:
    """
    Intersect lines with a space: return all maximal free intervals of each line.

    Parameters
    ----------
    space : Space
        The set.
    points, directions : (k, dim)
        The lines ``point + s direction``.
    lower, upper : (k,)
        Range of s on each line.

    Returns
    -------
    line : (m,) int64
        Index into ``points`` of the line of each interval, in ascending order.
    first, last : (m,)
        Values of s at the ends of each interval, cut off at the range of s on its line.

    """
    points, directions = _in_rows(points, directions)
    return _pieces(space.compiled, points, directions, lower, upper)


def lengths_within(
    space: Space, points: Floats, directions: Floats, lower: Floats, upper: Floats
) -> Floats:
    """
    Return the free length (k,) of each line ``point + s direction`` for lower <= s <= upper.

    The arguments are those of ``pieces``; the length is the sum of a line's free intervals.
    """
    line, first, last = pieces(space, points, directions, lower, upper)
    lengths = np.bincount(line, weights=last - first, minlength=len(points))
    return lengths.astype(np.float64)


def half_sphere(point: Floats, n_directions: int, *cornered: Space) -> tuple[Floats, Floats]:
    """
    Return directions and weights of a quadrature rule over all lines through a point.

    In the plane it is a Gauss rule between the directions of the corners of the given spaces, so
    that means over chords are exact to rounding where boundaries are straight; without corners it
    is a rule of equal steps. In three dimensions it is a product of a Gauss rule and a rule of
    equal steps. Each line counts once.

    Parameters
    ----------
    point : (dim,)
        Point on all lines; dim is 2 or 3.
    n_directions : int
        Approximate number of directions.
    *cornered : Space
        Spaces whose corners are kinks of the function to be averaged.

    Returns
    -------
    directions : (m, dim)
        Unit vectors.
    weights : (m,)
        Their sum is 1.

    Raises
    ------
    RequestError
        In more than three dimensions, where a product rule is too costly.

    """
    dim = len(point)
    if dim == 2:
        angles, weights = _half_circle(point, n_directions, *cornered)
        return np.stack([np.cos(angles), np.sin(angles)], axis=1), weights
    if dim != 3:
        raise RequestError(f'a mean over directions is for 2 or 3 dimensions, got {dim}')
    n_heights = max(2, int(math.sqrt(n_directions / 4.0)))
    nodes, weights = np.polynomial.legendre.leggauss(n_heights)
    height = (nodes + 1.0) / 2.0
    n_turns = 4 * n_heights
    turn = (np.arange(n_turns) + 0.5) * (2.0 * math.pi / n_turns)
    radius = np.sqrt(1.0 - height**2)[:, None]
    unit = np.stack(
        [
            radius * np.cos(turn),
            radius * np.sin(turn),
            np.repeat(height[:, None], n_turns, axis=1),
        ],
        axis=-1,
    )
    return unit.reshape(-1, 3), np.repeat(weights / 2.0, n_turns) / n_turns


def _half_circle(point: Floats, n_directions: int, *cornered: Space) -> tuple[Floats, Floats]:
    """
    Return the angles (m,) [rad] and weights (m,) of ``half_sphere`` in the plane.

    The angles cover a half circle, so that each line counts once; the weights sum to 1.
    """
    offsets = [corners(space).points - point for space in cornered]
    ahead = np.concatenate(offsets) if offsets else np.empty((0, 2))
    if len(ahead) == 0:
        middles = (np.arange(n_directions, dtype=np.float64) + 0.5) * (math.pi / n_directions)
        return middles, np.full(n_directions, 1.0 / n_directions)
    breaks = np.sort(np.arctan2(ahead[:, 1], ahead[:, 0]) % math.pi)
    breaks = np.concatenate([breaks, breaks[:1] + math.pi])
    first, width = breaks[:-1], np.diff(breaks)
    n_panels = np.maximum(1, np.ceil(width * n_directions / (ORDER * math.pi))).astype(int)
    n_panels[width < 1e-13] = 0
    begin = np.repeat(first, n_panels)
    step = np.repeat(width, n_panels) / np.repeat(n_panels, n_panels)
    index = np.arange(n_panels.sum()) - np.repeat(np.cumsum(n_panels) - n_panels, n_panels)
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    angles: Floats = (begin + step * index)[:, None] + step[:, None] * (nodes + 1.0) / 2.0
    widths: Floats = step[:, None] * weights / 2.0
    shares = widths.ravel() / widths.sum()
    return angles.ravel().astype(np.float64), shares.astype(np.float64)


def _in_rows(points: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Return points and directions as the C-contiguous arrays (k, dim) that kernels need."""
    directions = np.ascontiguousarray(np.atleast_2d(directions))
    return np.ascontiguousarray(np.broadcast_to(points, directions.shape)), directions


@kernel
def _reach(space, points, directions):
    """Return the distances (k,) from points along directions to the boundary; 0 if not free."""
    space = borrowed(space)
    ends = np.zeros(len(points))
    for k in range(len(points)):
        if contains(space, points[k]):
            ends[k] = first_exit(space, points[k], directions[k], 0.0, math.inf)
    return ends


@kernel
def _pieces(space, points, directions, lower, upper):
    """Return the arrays ``line``, ``first`` and ``last`` that ``pieces`` describes."""
    space = borrowed(space)
    line = []
    first = []
    last = []
    for k in range(len(points)):
        x, u = points[k], directions[k]
        s, probe = lower[k], PROBE * (upper[k] - lower[k])
        while s < upper[k]:
            begin = first_entry(space, x, u, s)
            if begin >= upper[k]:
                break
            s = begin + probe
            end = first_exit(space, x, u, s, math.inf)
            if end > s:
                s, probe = end, PROBE * (upper[k] - lower[k])
                line.append(k)
                first.append(begin)
                last.append(min(end, upper[k]))
            else:
                probe *= 2.0  # along a face: the line touches, but does not enter here
    return np.array(line, dtype=np.int64), np.array(first), np.array(last)
