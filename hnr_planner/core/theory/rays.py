"""Rays for quadrature: many chords at once, and averages over all directions from a point."""

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

#: Beyond a point where a line touches a space one looks this part of the line on: is it inside?
PROBE = 1e-10
#: Order of the Gauss rule between two directions of corners.
ORDER = 12


def reach(space: Space, points: Floats, directions: Floats) -> Floats:
    """
    Distance from points to the end of free space, each in its own direction.

    Parameters
    ----------
    space : Space
        The set.
    points : (k, dim)
        Points; those that are not free reach nowhere: 0.
    directions : (k, dim)
        Unit vectors.

    Returns
    -------
    (k,) float64

    """
    return _reach(space.compiled, *_in_rows(points, directions))


def chords(space: Space, points: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Distances (k,) backwards and forwards to the ends of the chords, as for ``reach``."""
    points, directions = _in_rows(points, directions)
    return _reach(space.compiled, points, -directions), _reach(space.compiled, points, directions)


def pieces(
    space: Space, points: Floats, directions: Floats, lower: Floats, upper: Floats
) -> tuple[NDArray[np.int64], Floats, Floats]:
    """
    Cut lines with a space: all the connected parts that lie in it, not only the chord.

    Parameters
    ----------
    space : Space
        The set.
    points, directions : (k, dim)
        The lines ``point + s direction``.
    lower, upper : (k,)
        Where to begin and to end on each.

    Returns
    -------
    line : (m,) int64
        The line that each part belongs to; parts are in the order of the lines.
    first, last : (m,)
        The parameters at which it begins and ends.

    """
    points, directions = _in_rows(points, directions)
    return _pieces(space.compiled, points, directions, lower, upper)


def lengths_within(
    space: Space, points: Floats, directions: Floats, lower: Floats, upper: Floats
) -> Floats:
    """Length (k,) of the part of each line between two parameters (k,) that lies in a space."""
    line, first, last = pieces(space, points, directions, lower, upper)
    lengths = np.bincount(line, weights=last - first, minlength=len(points))
    return lengths.astype(np.float64)


def half_sphere(point: Floats, n_directions: int, *cornered: Space) -> tuple[Floats, Floats]:
    """
    Return directions and weights for a mean over all lines through a point.

    In the plane the rule is Gauss's between the directions of the corners of the spaces given, so
    that means over chords are exact to rounding where boundaries are straight. Smooth boundaries
    have no corners, and a rule of equal steps is as good for them. In space it is a product of the
    two. Each line counts once.

    Parameters
    ----------
    point : (dim,)
        Where the lines pass; dim is 2 or 3.
    n_directions : int
        How many there are, about.
    *cornered : Space
        Whose corners matter.

    Returns
    -------
    directions : (m, dim)
        Unit vectors.
    weights : (m,)
        Their sum is 1.

    Raises
    ------
    RequestError
        In more than three dimensions: a product rule is no use there.

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
    """Angles (m,) in [0, pi) and weights (m,) that sum to 1."""
    seen = [corners(space).points - point for space in cornered]
    ahead = np.concatenate(seen) if seen else np.empty((0, 2))
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
    place = np.arange(n_panels.sum()) - np.repeat(np.cumsum(n_panels) - n_panels, n_panels)
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    angles: Floats = (begin + step * place)[:, None] + step[:, None] * (nodes + 1.0) / 2.0
    parts: Floats = step[:, None] * weights / 2.0
    shares = parts.ravel() / parts.sum()
    return angles.ravel().astype(np.float64), shares.astype(np.float64)


def _in_rows(points: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Both as arrays (k, dim) in the order of memory that the kernels are compiled for."""
    directions = np.ascontiguousarray(np.atleast_2d(directions))
    return np.ascontiguousarray(np.broadcast_to(points, directions.shape)), directions


@kernel
def _reach(space, points, directions):
    space = borrowed(space)
    ends = np.zeros(len(points))
    for k in range(len(points)):
        if contains(space, points[k]):
            ends[k] = first_exit(space, points[k], directions[k], 0.0, math.inf)
    return ends


@kernel
def _pieces(space, points, directions, lower, upper):
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
                probe *= 2.0  # along a face: it touches for long, and never enters
    return np.array(line, dtype=np.int64), np.array(first), np.array(last)
