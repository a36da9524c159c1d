"""
How many segments join any two points: the paper's tau (Definition 2), the link diameter.

On a grid it is bounded from both sides by breadth-first search over squares. Two squares see each
other wholly when the segment between their centres stays clear of the blocked cells grown by half
a square; if any point of one sees any point of the other, that segment misses the blocked cells
shrunk by half a square. Chains of the first kind exist, chains of the second have to. A polygon is
cut by squares into pieces for the same search.
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

#: What rounding may do to a coordinate, in squares.
ROUNDING = 1e-9


class LinkBounds(NamedTuple):
    """The link diameter lies between these; inf where the squares are too coarse to tell."""

    lower: int
    upper: float


def link_diameter(space: GridSpace, parts: int = 2) -> LinkBounds:
    """
    Bound the number of segments that join any two connected points of a grid.

    Points on the lines between squares are limits of those within, and do not count.

    Parameters
    ----------
    space : GridSpace
        The grid.
    parts : int
        Squares along the side of a cell: more of them bring the bounds together.

    """
    parts = check_count('parts', parts, 1)
    row, column = np.nonzero(np.kron(~space.blocked, np.ones((parts, parts), dtype=bool)))
    centres = np.stack([column, row], axis=1) + 0.5
    if len(centres) == 0:
        raise RequestError('every cell of the grid is blocked')
    boxes = parts * np.concatenate([_runs(space.blocked), _runs(space.blocked.T)[:, [1, 0, 3, 2]]])
    boxes = boxes.astype(np.float64)
    part = space.data.labels[1:-1, 1:-1][row // parts, column // parts]
    together = part[:, None] == part
    wholly = _distances(_clear(centres, boxes, 0.5 - ROUNDING))
    barely = _distances(_clear(centres, boxes, -0.5 + ROUNDING))
    return LinkBounds(int(barely[together].max()), float(wholly[together].max()))


def polygon_link_diameter(space: PolygonSpace, n_squares: int = 16) -> LinkBounds:
    """
    Bound the number of segments that join any two connected points of a polygon.

    Two pieces see each other wholly when the polygon covers their hull. If a point of one sees a
    point of the other, the segment between their middles is no farther from the polygon than the
    middle of a piece from its farthest point.

    Parameters
    ----------
    space : PolygonSpace
        The polygon; segments along its rings count as free, as limits of those inside.
    n_squares : int
        Squares along the longer side of the bounds.

    """
    n_squares = check_count('n_squares', n_squares, 1)
    side = float(np.subtract(*space.bounds[::-1]).max()) / n_squares
    pieces = _pieces(space.polygon, side)
    middles = shapely.point_on_surface(pieces)
    reach = float(shapely.hausdorff_distance(middles, pieces).max())
    # A buffer's round corners are polygons within them, up to .5 % too small.
    around = shapely.buffer(space.polygon, reach * 1.01, quad_segs=16)
    within = shapely.buffer(space.polygon, ROUNDING * side)
    shapely.prepare([around, within])
    first, second = np.triu_indices(len(pieces))
    hulls = shapely.convex_hull(shapely.union(pieces[first], pieces[second]))
    between = shapely.linestrings(
        np.stack([shapely.get_coordinates(middles)[k] for k in (first, second)], axis=1)
    )
    sees = np.zeros((2, len(pieces), len(pieces)), dtype=np.bool_)
    sees[0, first, second] = shapely.covers(within, hulls)
    sees[1, first, second] = shapely.covers(around, between)
    wholly, barely = (_distances(seen | seen.T) for seen in sees)
    np.fill_diagonal(wholly, np.where(sees[0].diagonal(), 1.0, 2.0))
    polygons = shapely.get_parts(space.polygon)
    number = np.array([[polygon.intersects(middle) for polygon in polygons] for middle in middles])
    together = number.astype(int) @ number.T.astype(int) > 0
    return LinkBounds(int(barely[together].max()), float(wholly[together].max()))


def _pieces(polygon: Any, side: float) -> NDArray[Any]:
    """Cut a polygon by squares, and what is not convex then by the triangles of its corners."""
    left, bottom, right, top = polygon.bounds
    x, y = np.meshgrid(
        np.arange(left, right - ROUNDING * side, side),
        np.arange(bottom, top - ROUNDING * side, side),
    )
    squares = shapely.box(x, y, x + side, y + side).ravel()
    pieces = _with_area(shapely.intersection(squares, polygon), side)
    bent = shapely.area(pieces) < (1.0 - ROUNDING) * shapely.area(shapely.convex_hull(pieces))
    parts = [pieces[~bent]]
    for piece in pieces[bent]:
        triangles = shapely.get_parts(shapely.delaunay_triangles(piece))
        parts.append(_with_area(shapely.intersection(triangles, piece), side))
    return np.concatenate(parts)


def _with_area(geometries: NDArray[Any], side: float) -> NDArray[Any]:
    """Return the parts of geometries, without what is thinner than rounding."""
    parts = shapely.get_parts(geometries)
    return parts[shapely.area(parts) > ROUNDING * side**2]


def annulus_sector_links(inner: float, outer: float, angle: float) -> int:
    """
    Link diameter of a sector (angle [rad]) of an annulus between two radii, in closed form.

    A segment turns by 2 b at most, b = arccos(inner / outer), between points of the outer arc, and
    by b from the inner arc: k segments from arc to arc along the inner wall turn by 2 b (k - 1).
    """
    if not 0.0 < inner < outer:
        raise RequestError(f'radii must be 0 < inner < outer, got {inner:g}, {outer:g}')
    return 1 + math.ceil(angle / (2.0 * math.acos(inner / outer)))


def _runs(blocked: Bools) -> NDArray[np.int64]:
    """Boxes (k, 4) x, y, x, y of the longest runs of blocked cells within rows."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, first = np.nonzero(edges == 1)
    _, last = np.nonzero(edges == -1)
    return np.stack([first, row, last, row + 1], axis=1)


def _distances(sees: Bools) -> Floats:
    """Least number of links (k, k) between squares that see each other; 1 within a square."""
    links: Floats = dijkstra(csr_array(sees), unweighted=True)
    np.fill_diagonal(links, 1.0)
    return links


@kernel
def _clear(centres, boxes, grow):
    """Say for which pairs (k, k) of points the segment between them misses all open boxes."""
    clear = np.ones((len(centres), len(centres)), dtype=np.bool_)
    for i in range(len(centres)):
        for j in range(i):
            for box in boxes:
                if _crosses(centres[i], centres[j], box, grow):
                    clear[i, j] = clear[j, i] = False
                    break
    return clear


@kernel
def _crosses(a, b, box, grow):
    """Say whether a segment runs through the inside of a box that has grown on every side."""
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
