"""
View of a point u.

Definition (paper, Section 3.1): the set of points v for which the segment from u to v is free.
"""

import math

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.corners import corners
from hnr_planner.core.theory.rays import reach
import numpy as np
from numpy.typing import ArrayLike

#: Directions that differ by less than this count as one [rad].
NARROWEST = 1e-12


def view(space: Space, u: ArrayLike, n_directions: int = 720) -> Floats:
    """
    Return the vertices (m, 2) of the polygon of points visible from ``u``, counter-clockwise.

    Between the directions of two neighbouring corners the view ends on one straight wall, which
    two rays determine exactly. For a space without known corners, the vertices are the boundary
    points in ``n_directions`` equally spaced directions, which are unused otherwise.

    Raises
    ------
    RequestError
        When the space is not in the plane, or ``u`` (2,) is not free.

    """
    if space.dim != 2:
        raise RequestError(f'a view is a polygon in the plane, the space has {space.dim} axes')
    u = check_point('u', u, 2)
    if not space.contains(u):
        raise RequestError(f'u {u.tolist()} is {space.why_not_free(u)}')
    away = corners(space).points - u
    if len(away) == 0:
        turn = _unit(
            (np.arange(n_directions, dtype=np.float64) + 0.5) * (2.0 * math.pi / n_directions)
        )
        return u + reach(space, u, turn)[:, None] * turn
    breaks = np.unique(np.arctan2(away[:, 1], away[:, 0])).astype(np.float64)
    first, width = breaks, np.diff(breaks, append=breaks[0] + 2.0 * math.pi)
    first, width = first[width > NARROWEST], width[width > NARROWEST]
    # Walls are lines a . (p - u) = 1, so a . e(angle) = 1 / reach: two rays give a (2,).
    rays = [_unit(first + fraction * width) for fraction in (0.25, 0.75)]
    inverse = np.stack([1.0 / reach(space, u, ray) for ray in rays], axis=1)
    walls = np.linalg.solve(np.stack(rays, axis=1), inverse[:, :, None])[:, :, 0]
    ends = [_unit(first), _unit(first + width)]
    vertices = [ray / (walls * ray).sum(axis=1)[:, None] for ray in ends]
    return u + np.stack(vertices, axis=1).reshape(-1, 2)


def polygon_area(polygon: Floats) -> float:
    """Return the signed area of a polygon of vertices (m, 2): positive if counter-clockwise."""
    x, y = (polygon - polygon[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0


def _unit(angles: Floats) -> Floats:
    """Return the unit vectors (k, 2) of angles (k,) [rad]."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
