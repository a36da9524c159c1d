"""
Link diameter tau of a set.

Definition (paper, Definition 2): the smallest number of segments that join any two points of the
set within it.

On a grid it is bounded from both sides by breadth-first search over squares. If the segment
between the centres of two squares misses the blocked cells grown by half a square, all points of
one square are visible from all points of the other: a path over such pairs of squares exists,
which gives the upper bound. If any point of one square is visible from any point of the other,
the segment between their centres misses the blocked cells shrunk by half a square: every path
consists of such pairs, which gives the lower bound. A polygon is divided into convex pieces, which
take the place of the squares.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces import GridSpace, PolygonSpace
from hnr_planner.core.spaces.grid.cells import Bools
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
import shapely

#: Allowance for rounding of a coordinate [squares].
ROUNDING = 1e-9


class LinkBounds(NamedTuple):
    """Bounds on the link diameter; ``upper`` is inf if the squares are too coarse to bound it."""

    lower: int
    upper: float


def link_diameter(space: GridSpace, subdivision: int = 2) -> LinkBounds:
    """
    Bound the link diameter of a grid, over all pairs of connected points.

    Two points are connected if they lie in the same component of free space. Points on the lines
    between squares do not count, for they are limits of points within the squares.

    Parameters
    ----------
    space : GridSpace
        The grid.
    subdivision : int
        Number of squares along the side of a cell: the bounds approach each other as it grows.

    """
    k = check_count('subdivision', subdivision, 1)
    row, column = np.nonzero(np.kron(~space.blocked, np.ones((k, k), dtype=bool)))
    centres = np.stack([column, row], axis=1) + 0.5
    if len(centres) == 0:
        raise RequestError('every cell of the grid is blocked')
    boxes = k * np.concatenate([_runs(space.blocked), _runs(space.blocked.T)[:, [1, 0, 3, 2]]])
    boxes = boxes.astype(np.float64)
    component = space.data.labels[1:-1, 1:-1][row // k, column // k]
    connected = component[:, None] == component
    upper = _link_distances(_visible_pairs(centres, boxes, 0.5 - ROUNDING))
    lower = _link_distances(_visible_pairs(centres, boxes, -0.5 + ROUNDING))
    return LinkBounds(int(lower[connected].max()), float(upper[connected].max()))


def polygon_link_diameter(space: PolygonSpace, n_squares: int = 16) -> LinkBounds:
    """
    Bound the link diameter of a polygon, over all pairs of connected points.

    Two pieces are mutually visible as a whole when the polygon covers their hull. If a point of
    one is visible from a point of the other, the segment between their middles is no farther from
    the polygon than the middle of a piece from its farthest point.

    Parameters
    ----------
    space : PolygonSpace
        The polygon; segments along its rings count as free, as limits of those inside.
    n_squares : int
        Number of squares along the longer side of the bounds.

    """
    n_squares = check_count('n_squares', n_squares, 1)
    side = float(np.subtract(*space.bounds[::-1]).max()) / n_squares
    pieces = _convex_pieces(space.polygon, side)
    middles = shapely.point_on_surface(pieces)
    reach = float(shapely.hausdorff_distance(middles, pieces).max())
    # A buffer's round corners are inscribed polygons, up to .5 % too small.
    around = shapely.buffer(space.polygon, reach * 1.01, quad_segs=16)
    within = shapely.buffer(space.polygon, ROUNDING * side)
    shapely.prepare([around, within])
    first, second = np.triu_indices(len(pieces))
    hulls = shapely.convex_hull(shapely.union(pieces[first], pieces[second]))
    between = shapely.linestrings(
        np.stack([shapely.get_coordinates(middles)[k] for k in (first, second)], axis=1)
    )
    visible = np.zeros((2, len(pieces), len(pieces)), dtype=np.bool_)
    visible[0, first, second] = shapely.covers(within, hulls)
    visible[1, first, second] = shapely.covers(around, between)
    upper, lower = (_link_distances(pairs | pairs.T) for pairs in visible)
    np.fill_diagonal(upper, np.where(visible[0].diagonal(), 1.0, 2.0))
    polygons = shapely.get_parts(space.polygon)
    member = np.array([[polygon.intersects(middle) for polygon in polygons] for middle in middles])
    connected = member.astype(int) @ member.T.astype(int) > 0
    return LinkBounds(int(lower[connected].max()), float(upper[connected].max()))


def _convex_pieces(polygon: Any, side: float) -> NDArray[Any]:
    """Cut a polygon into squares of this ``side``, and non-convex pieces into triangles."""
    left, bottom, right, top = polygon.bounds
    x, y = np.meshgrid(
        np.arange(left, right - ROUNDING * side, side),
        np.arange(bottom, top - ROUNDING * side, side),
    )
    squares = shapely.box(x, y, x + side, y + side).ravel()
    pieces = _with_area(shapely.intersection(squares, polygon), side)
    hulls = shapely.convex_hull(pieces)
    concave = shapely.area(pieces) < (1.0 - ROUNDING) * shapely.area(hulls)
    convex = [pieces[~concave]]
    for piece in pieces[concave]:
        triangles = shapely.get_parts(shapely.delaunay_triangles(piece))
        convex.append(_with_area(shapely.intersection(triangles, piece), side))
    return np.concatenate(convex)


def _with_area(geometries: NDArray[Any], side: float) -> NDArray[Any]:
    """Return the single polygons of geometries whose area is above ``ROUNDING * side**2``."""
    parts = shapely.get_parts(geometries)
    return parts[shapely.area(parts) > ROUNDING * side**2]


def annulus_sector_links(inner: float, outer: float, angle: float) -> int:
    """
    Return the link diameter of a sector (angle [rad]) of an annulus, in closed form.

    ``inner`` and ``outer`` are the radii, in one unit. With b = arccos(inner / outer), a segment
    between two points of the outer arc spans an angle of at most 2 b, and a segment from the inner
    arc to the outer arc at most b: k segments along the inner arc span 2 b (k - 1).

    Raises
    ------
    RequestError
        Unless 0 < ``inner`` < ``outer``.

    """
    if not 0.0 < inner < outer:
        raise RequestError(f'radii must be 0 < inner < outer, got {inner:g}, {outer:g}')
    return 1 + math.ceil(angle / (2.0 * math.acos(inner / outer)))


def _runs(blocked: Bools) -> NDArray[np.int64]:
    """
    Return a box for each maximal run of neighbouring blocked cells in a row.

    Boxes are (k, 4): left, bottom, right, top [cells], of the lower left and upper right corner.
    """
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, first = np.nonzero(edges == 1)
    _, last = np.nonzero(edges == -1)
    return np.stack([first, row, last, row + 1], axis=1)


def _link_distances(visible: Bools) -> Floats:
    """
    Return the least numbers of links (k, k) between k squares.

    ``visible`` is (k, k) bool: which pairs one link joins. The number is inf for pairs that no
    path joins, and 1 from a square to itself.
    """
    links: Floats = dijkstra(csr_array(visible), unweighted=True)
    np.fill_diagonal(links, 1.0)
    return links


@kernel
def _visible_pairs(centres, boxes, grow):
    """
    Return which pairs (k, k) bool of ``centres`` (k, 2) have a segment that misses all boxes.

    ``boxes`` are (m, 4): left, bottom, right, top. Each is open, and grown by ``grow`` on every
    side, or shrunk if ``grow`` is negative. All lengths are in units of squares.
    """
    visible = np.ones((len(centres), len(centres)), dtype=np.bool_)
    for i in range(len(centres)):
        for j in range(i):
            for box in boxes:
                if _crosses(centres[i], centres[j], box, grow):
                    visible[i, j] = visible[j, i] = False
                    break
    return visible


@kernel
def _crosses(a, b, box, grow):
    """Return whether segment ``a`` to ``b`` meets the interior of ``box`` grown by ``grow``."""
    first, last = 0.0, 1.0
    for i in range(2):
        lower, upper, along = box[i] - grow - a[i], box[i + 2] + grow - a[i], b[i] - a[i]
        if lower >= upper:
            return False
        if along == 0.0:
            if not lower < 0.0 < upper:
                return False
        else:
            s, t = lower / along, upper / along
            first, last = max(first, min(s, t)), min(last, max(s, t))
    return first < last
