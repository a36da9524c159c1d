"""The footprint of a robot: a simple polygon, its edges and its convex pieces."""

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

from hnr_planner.core.checks import check_numbers, Floats
from hnr_planner.core.errors import SpaceError
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Least angle [rad] by which the outline turns at a vertex; a vertex of less is left out.
STRAIGHT = 1e-9
#: Least ratio of a footprint's area to the square of its diameter.
THINNEST = 1e-6


class Footprint(NamedTuple):
    """
    A footprint, prepared for kernels; all lengths are in one unit.

    Attributes
    ----------
    vertices : (n, 2)
        Corners, counter-clockwise, none of them on a straight side.
    edges : (n, 6)
        Each side: its first vertex (x, y), its unit direction (x, y), its length, and 1 if the
        footprint is convex at the first vertex, else 0.
    pieces : (m, 2)
        Vertices of the convex pieces that the footprint consists of, piece by piece, each
        counter-clockwise.
    piece_ends : (p,) int64
        Number of rows of ``pieces`` up to the end of each piece.
    circle : (3,)
        Centre (x, y) and radius of a circle around the footprint.

    """

    vertices: Floats
    edges: Floats
    pieces: Floats
    piece_ends: NDArray[np.int64]
    circle: Floats

    @property
    def reach(self) -> float:
        """Distance from the origin of the robot's frame to the farthest vertex."""
        return float(np.hypot(*self.vertices.T).max())


def check_footprint(footprint: ArrayLike) -> Floats:
    """
    Return the vertices (n, 2) of a footprint in counter-clockwise order, or raise SpaceError.

    The outline has to be a simple polygon: at least three vertices, not all on one line, and no
    side that meets another one but its neighbours at the common vertex. A first vertex repeated at
    the end, and vertices on a straight side, are left out.
    """
    from shapely import Polygon
    from shapely.validation import explain_validity

    vertices = check_numbers('footprint', footprint, SpaceError)
    if vertices.ndim != 2 or vertices.shape[1] != 2 or len(vertices) < 3:
        raise SpaceError(f'footprint must have shape (k, 2) with k >= 3, got {vertices.shape}')
    if not np.isfinite(vertices).all():
        raise SpaceError(f'footprint must be finite, got {vertices.tolist()}')
    if (vertices[0] == vertices[-1]).all():
        vertices = vertices[:-1]
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    if len(vertices) < 3 or lengths.min() == 0.0:
        raise SpaceError(f'footprint must have no repeated vertex, got {vertices.tolist()}')
    outline = Polygon(vertices)
    if not outline.is_valid:
        raise SpaceError(
            f'footprint must not cross or touch itself: {explain_validity(outline)}, '
            f'got {vertices.tolist()}'
        )
    diameter = float(np.hypot(*np.ptp(vertices, axis=0)))
    if not outline.area > THINNEST * diameter**2:
        raise SpaceError(
            f'footprint must have an area of more than {THINNEST:g} of its squared diameter, got '
            f'{outline.area:g} for a diameter of {diameter:g}'
        )
    if not outline.exterior.is_ccw:
        vertices = vertices[::-1]
    return _without_straight(vertices)


def prepare_footprint(vertices: Floats) -> Footprint:
    """Return a footprint for kernels from checked ``vertices`` (n, 2), counter-clockwise."""
    from shapely import minimum_bounding_circle, Polygon

    after = np.roll(vertices, -1, axis=0)
    lengths = np.hypot(*(after - vertices).T)
    directions = (after - vertices) / lengths[:, None]
    is_convex = _turns(vertices) > 0.0
    edges = np.column_stack([vertices, directions, lengths, is_convex])
    pieces = [vertices[list(piece)] for piece in convex_pieces(vertices)]
    centre = np.array(minimum_bounding_circle(Polygon(vertices)).centroid.coords[0])
    radius = np.hypot(*(vertices - centre).T).max()
    return Footprint(
        np.ascontiguousarray(vertices),
        np.ascontiguousarray(edges, dtype=np.float64),
        np.ascontiguousarray(np.concatenate(pieces)),
        np.cumsum([len(piece) for piece in pieces]).astype(np.int64),
        np.array([*centre, radius]),
    )


def convex_pieces(vertices: Floats) -> list[list[int]]:
    """
    Divide a simple polygon (n, 2), counter-clockwise, into convex pieces of its vertices.

    The polygon is cut into triangles by ears (Meisters, "Polygons have ears", 1975), and triangles
    are joined across a common side as long as the result is convex (Hertel and Mehlhorn, "Fast
    triangulation of simple polygons", 1983). Each piece is a list of vertex numbers,
    counter-clockwise.
    """
    pieces, joined = _triangles(vertices), True
    while joined:
        joined = False
        for first, second in combinations(pieces, 2):
            both = _join(vertices, first, second)
            if both is not None:
                pieces = [piece for piece in pieces if piece not in (first, second)] + [both]
                joined = True
                break
    return pieces


def _without_straight(vertices: Floats) -> Floats:
    """Return the vertices (k, 2) at which the outline turns."""
    while len(vertices) > 3:
        straight = np.abs(_turns(vertices)) <= STRAIGHT
        if not straight.any():
            break
        vertices = np.delete(vertices, int(straight.argmax()), axis=0)
    return np.ascontiguousarray(vertices)


def _turns(vertices: Floats) -> Floats:
    """Return the sine (n,) of the angle by which the outline turns left at each vertex."""
    before = vertices - np.roll(vertices, 1, axis=0)
    after = np.roll(vertices, -1, axis=0) - vertices
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns: Floats = cross / (np.hypot(*before.T) * np.hypot(*after.T))
    return turns


def _triangles(vertices: Floats) -> list[list[int]]:
    """Cut ears off a simple polygon (n, 2), counter-clockwise, until a triangle is left."""
    left, triangles = list(range(len(vertices))), []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(vertices, left, k)), None)
        if ear is None:  # rounding hides the ear of a thin polygon: take the sharpest corner
            ear = int(np.argmax(_turns(vertices[left])))
        triangles.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    return [*triangles, left]


def _is_ear(vertices: Floats, left: Sequence[int], k: int) -> bool:
    """Return whether the triangle at vertex ``left[k]`` is convex and holds no other vertex."""
    corners = [left[k - 1], left[k], left[(k + 1) % len(left)]]
    a, b, c = vertices[corners]
    if _cross(a, b, c) <= 0.0:
        return False
    others = vertices[[i for i in left if i not in corners]]
    inside = (
        (_cross(a, b, others.T) >= 0.0)
        & (_cross(b, c, others.T) >= 0.0)
        & (_cross(c, a, others.T) >= 0.0)
    )
    return not inside.any()


def _cross(a: Floats, b: Floats, c: Floats) -> NDArray[np.float64]:
    """Return twice the signed area of the triangles a, b, c; ``c`` is (2,) or (2, k)."""
    return np.asarray((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _join(vertices: Floats, first: list[int], second: list[int]) -> list[int] | None:
    """Return two pieces joined across a common side, if there is one and that is convex."""
    for i in range(len(first)):
        a, b = first[i], first[(i + 1) % len(first)]
        if a in second and second[(second.index(a) - 1) % len(second)] == b:
            # From b along the first piece to a, then along the second back to b.
            after, here = i + 1, second.index(a) + 1
            both = first[after:] + first[:after] + (second[here:] + second[:here])[:-2]
            return both if (_turns(vertices[both]) >= 0.0).all() else None
    return None
