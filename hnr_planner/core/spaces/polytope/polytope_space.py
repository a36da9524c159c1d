"""A polytope: the points that satisfy finitely many linear inequalities."""

from functools import cached_property
from typing import Any

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.bounds import COARSEST, FINEST
from hnr_planner.core.spaces.polytope.chain_cache import largest_error
from hnr_planner.core.spaces.polytope.inequalities import check_inequalities
from hnr_planner.core.spaces.polytope.measures import bounds, largest_ball, Reach, reach
from hnr_planner.core.spaces.polytope.planes import layout_of, PolytopeData
from hnr_planner.core.spaces.space import MARGIN, Space
import numpy as np
from numpy.typing import ArrayLike

#: Least distance from the analytic centre to a plane, as a fraction of the terms that it rounds.
THINNEST = 1e-10


class PolytopeSpace(Space):
    """
    The points x with ``a x < b`` in every row.

    ``bounds`` are computed when first used, by 2 dim linear programs. Walks do not use
    ``bounds``.

    Parameters
    ----------
    a : (m, dim)
        One row for each inequality, dense or a sparse matrix of scipy's. A row may be all zeros if
        its right-hand side is above 0.
    b : (m,)
        Right-hand sides; a row with inf limits nothing.

    Raises
    ------
    SpaceError
        When the polytope is empty, has no interior, is unbounded, or is too thin for rounding.

    Attributes
    ----------
    centre : (dim,)
        Centre of a largest ball inside, caller's frame. If the sizes of the coordinates differ by
        a factor of more than 1000, it is a largest ball in coordinates divided by their sizes.
    inner_radius : float
        Distance from the centre to the nearest plane.

    """

    data: PolytopeData

    def __init__(self, a: Any, b: ArrayLike) -> None:
        normals, offsets, self._rows = check_inequalities(a, b)
        self.dim = normals.shape[1]
        if len(normals) == 0:
            raise SpaceError('the polytope must be bounded, but no row of a bounds anything')
        ball = largest_ball(normals, offsets, self._rows)
        extent = reach(normals, offsets, ball.centre)
        self._kernel_origin = _origin(extent)
        if self._kernel_origin is not None:
            offsets = _moved(normals, offsets, self._kernel_origin)
            ball = largest_ball(normals, offsets, self._rows)
            extent = reach(normals, offsets, ball.centre)
        _check_resolved(normals, offsets, extent)
        lower, upper = extent.centre - extent.outer, extent.centre + extent.outer
        self.data = PolytopeData(
            normals, offsets, layout_of(normals), largest_error(normals, offsets, lower, upper)
        )
        self.centre, self.inner_radius = self.from_kernel(ball.centre), ball.radius
        self._sizes = ball.sizes

    def __repr__(self) -> str:
        """Name the dimension and count the inequalities."""
        return f'PolytopeSpace(dim={self.dim}, inequalities={len(self.data.offsets)})'

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), kernel frame."""
        return bounds(self.data.normals, self.data.offsets, self._sizes)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        lower, upper = self.kernel_bounds
        return self.from_kernel(lower), self.from_kernel(upper)

    @property
    def zero_length(self) -> float:
        """Length up to which a chord counts as zero: a fraction ``MARGIN`` of the inner radius."""
        return MARGIN * self.inner_radius

    @property
    def typical_clearance(self) -> float:
        """Mean distance from a point of the largest inner ball to the sphere around that ball."""
        return self.inner_radius / (self.dim + 1)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the closed polytope contains the box between two corners (dim,)."""
        normals, offsets = self.data.normals, self.data.offsets
        worst = np.where(normals > 0.0, self.to_kernel(upper), self.to_kernel(lower))
        return bool(((normals * worst).sum(axis=1) <= offsets).all())

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        x = self.to_kernel(check_point('point', point, self.dim))
        excess = self.data.normals @ x - self.data.offsets
        k = int(np.argmax(excess))
        row = self._rows[k]
        return f'outside the polytope: {excess[k]:g} beyond the plane of row {row} of a'


def _origin(extent: Reach) -> Floats | None:
    """
    Return the origin (dim,) of the kernel frame, in the caller's frame; None for 0.

    A coordinate is counted from the analytic centre if rounding there is more than ``FINEST`` of
    the width of the inner box, and else from 0. Raise SpaceError if it is more than ``COARSEST``.
    """
    rounding = np.spacing(np.abs(extent.centre) + extent.outer)
    if not (rounding <= 2.0 * COARSEST * extent.inner).all():
        raise SpaceError(
            f'the polytope is too thin for where it lies: coordinates must resolve {COARSEST:g} '
            f'of its width, but around {extent.centre.tolist()} they are rounded to '
            f'{rounding.max():g}; move it nearer to the origin'
        )
    is_far = rounding > 2.0 * FINEST * extent.inner
    return np.where(is_far, extent.centre, 0.0) if is_far.any() else None


def _moved(normals: Floats, offsets: Floats, origin: Floats) -> Floats:
    """
    Return the right-hand sides (m,) for points counted from ``origin`` (dim,).

    They are computed in extended precision and rounded once.
    """
    exact = np.longdouble
    return np.asarray(
        offsets.astype(exact) - (normals.astype(exact) * origin.astype(exact)).sum(axis=1),
        dtype=np.float64,
    )


def _check_resolved(normals: Floats, offsets: Floats, extent: Reach) -> None:
    """
    Raise SpaceError if a distance from the centre to a plane is too small to be resolved.

    Each has to be above ``THINNEST`` times the sum of the sizes of its terms.
    """
    distances = offsets - normals @ extent.centre
    terms = np.abs(normals) @ (np.abs(extent.centre) + extent.inner) + np.abs(offsets)
    if not (distances > THINNEST * terms).all():
        k = int(np.argmin(distances / terms))
        raise SpaceError(
            f'the polytope is too thin: {distances[k]:g} from its middle to a plane, which is '
            f'less than {THINNEST:g} of coordinates of {terms[k]:g}; turn and scale the '
            f'coordinates so that its sides are of about the same length'
        )
