"""An open box as a space, with sides along the axes, in any dimension."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.bounds import check_corners, in_words, kernel_origin
from hnr_planner.core.spaces.convex import (
    convex,
    count_pieces,
    piece_contains,
    piece_entry,
    piece_span,
)
from hnr_planner.core.spaces.curves.curve import coordinate, first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    add_level_crossings,
    first_exit_between_surfaces,
    max_gap_of,
    own_max_gap,
)
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


@convex
class BoxData(NamedTuple):
    """
    Compiled boxes, as convex pieces.

    Attributes
    ----------
    lower, upper : (k, dim)
        Corners of the boxes.
    max_gap : float
        Longest gap between two boxes that counts as free: a ray passes over it.

    """

    lower: Floats
    upper: Floats
    max_gap: float

    @property
    def boxes(self) -> tuple[Floats, Floats]:
        """Lower and upper corners (k, dim) of the boxes."""
        return self.lower, self.upper

    @property
    def tree_from(self) -> int:
        """Number of boxes from which a tree over them makes chords faster (measured)."""
        return 24


class BoxSpace(Space):
    """
    The points above ``lower`` and below ``upper`` in every coordinate: an open box.

    Parameters
    ----------
    lower, upper : (dim,)
        Two corners, of any dimension.

    Raises
    ------
    SpaceError
        When the numbers describe no box.

    """

    def __init__(self, lower: ArrayLike, upper: ArrayLike) -> None:
        self.lower, self.upper = check_corners(lower, upper)
        self.dim = len(self.lower)
        self._kernel_origin = kernel_origin(self.lower, self.upper)
        self.data = self.compiled_at(self._kernel_origin)

    def __repr__(self) -> str:
        """Name the corners."""
        return f'BoxSpace(lower={in_words(self.lower)}, upper={in_words(self.upper)})'

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        return self.lower.copy(), self.upper.copy()

    def compiled_at(self, origin: Floats | None) -> BoxData:
        """
        Return the compiled box with coordinates counted from ``origin``, along the caller's axes.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        shift = np.zeros(self.dim) if origin is None else origin
        return BoxData((self.lower - shift)[np.newaxis], (self.upper - shift)[np.newaxis], 0.0)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the box between two corners (dim,) lies in this one, faces included."""
        return bool((self.lower <= lower).all() and (upper <= self.upper).all())

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        i = int(np.argmax(np.maximum(self.lower - x, x - self.upper)))
        return (
            f'outside the box: coordinate {i} is {x[i]:g}, not between {self.lower[i]:g} and '
            f'{self.upper[i]:g}'
        )


first_exit_on_curve.register(BoxData)(first_exit_between_surfaces)
max_gap_of.register(BoxData)(own_max_gap)


@count_pieces.register(BoxData)
@inlined
def _count_pieces(boxes):
    """Return the number of boxes."""
    return len(boxes.lower)


@piece_contains.register(BoxData)
@inlined
def _piece_contains(boxes, k, x, closed):
    """Return whether box ``k`` contains ``x`` (dim,), its faces included when ``closed``."""
    for i in range(len(x)):
        below, above = x[i] - boxes.lower[k, i], boxes.upper[k, i] - x[i]
        if not (min(below, above) > 0.0 or (closed and min(below, above) == 0.0)):
            return False
    return True


@piece_span.register(BoxData)
@inlined
def _piece_span(boxes, k, x, u, closed):
    """Return the interval of the line ``x + s u`` in box ``k``; (inf, -inf) for none."""
    first, last = _clipped(boxes, k, x, u, -math.inf, math.inf, closed)
    if first < last or (closed and first == last):
        return first, last
    return math.inf, -math.inf


@piece_entry.register(BoxData)
@inlined
def _piece_entry(boxes, k, x, u, t, end):
    """Return the first parameter from ``t`` to ``end`` where the line touches a box, or inf."""
    first, last = _clipped(boxes, k, x, u, t, end, True)
    return first if first <= last else math.inf


@inlined
def _clipped(boxes, k, x, u, first, last, closed):
    """
    Return the part of the interval (first, last) of the line ``x + s u`` in box ``k``.

    The faces of the box belong to it when ``closed``. The part is (inf, -inf) as soon as one
    coordinate leaves nothing.
    """
    for i in range(len(x)):
        below, above = boxes.lower[k, i] - x[i], boxes.upper[k, i] - x[i]
        if u[i] != 0.0:
            p, q = below / u[i], above / u[i]
            first, last = max(first, min(p, q)), min(last, max(p, q))
        elif not (below < 0.0 < above or (closed and below <= 0.0 <= above)):
            return math.inf, -math.inf
        if first > last:
            return math.inf, -math.inf
    return first, last


@add_crossings.register(BoxData)
@kernel
def _add_crossings(boxes, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, where a curve meets the planes of the faces.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    for k in range(len(boxes.lower)):
        for i in range(boxes.lower.shape[1]):
            f = coordinate(curve, i)
            n = add_level_crossings(f, boxes.lower[k, i], end, crossings, n)
            n = add_level_crossings(f, boxes.upper[k, i], end, crossings, n)
    return n
