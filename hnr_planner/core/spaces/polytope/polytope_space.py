"""
A polytope: the points that satisfy finitely many linear inequalities and equations.

One class serves polytopes with and without equations, and is as long as two: whether equations
hold turns out only when the inequalities have been solved.
"""

from functools import cached_property
from typing import Any

from hnr_planner.core.checks import check_point, check_points, Floats
from hnr_planner.core.errors import RequestError, SpaceError
from hnr_planner.core.spaces.polytope.chain_cache import largest_error
from hnr_planner.core.spaces.polytope.extent import reach
from hnr_planner.core.spaces.polytope.facets import facet_axes
from hnr_planner.core.spaces.polytope.inequalities import check_constraints, from_scipy
from hnr_planner.core.spaces.polytope.measures import Ball, extremes, largest_ball
from hnr_planner.core.spaces.polytope.planes import compiled_polytope, PolytopeData, SPURIOUS
from hnr_planner.core.spaces.polytope.presolve import presolved
from hnr_planner.core.spaces.polytope.resolution import check_resolved, moved_to, origin_of
from hnr_planner.core.spaces.space import Chord, MARGIN, Space
import numpy as np
from numpy.typing import ArrayLike

#: Bound on the rounding of a row's value at a mapped point, as a fraction of the row's terms.
MAP_ROUNDING = 64 * 2.0**-53


class PolytopeSpace(Space):
    """
    The points x with ``a x < b``, ``a_eq x = b_eq`` and ``lower < x < upper``.

    Inequalities that all points hold with equality are found, and used as equations. With
    equations, walks run in the plane that they leave, in the coordinates of some axes, and draws
    are points of the caller's frame, uniform on the plane. Planners need a polytope without
    equations, and so do unions, differences and products.

    ``bounds`` are computed when first used, by 2 dim linear programs. Walks do not use
    ``bounds``.

    Parameters
    ----------
    a : (m, dim), optional
        One row for each inequality, dense or a sparse matrix of scipy's. A row may be all zeros if
        its right-hand side is above 0.
    b : (m,) or float, optional
        Right-hand sides; a row with inf limits nothing.
    a_eq : (r, dim), optional
        One row for each equation, dense or sparse. Equations may follow from others.
    b_eq : (r,) or float, optional
        Right-hand sides of the equations.
    lower, upper : (dim,) or float, optional
        Bounds of the coordinates, -inf and inf for none. Two equal bounds are an equation.

    Raises
    ------
    SpaceError
        When the polytope is empty, is a single point, is unbounded, or is too thin for rounding.

    Attributes
    ----------
    centre : (dim,)
        Centre of a largest ball inside, caller's frame. If the sizes of the coordinates differ by
        a factor of more than 1000, it is a largest ball in coordinates divided by their sizes. In
        a polytope with equations it is a ball in the coordinates of the plane.
    inner_radius : float
        Distance from the centre to the nearest plane, in the frame of the ball.
    analytic_centre : (kernel_dim,)
        The point with the largest product of distances to the planes, kernel frame.

    """

    data: PolytopeData

    def __init__(
        self,
        a: Any = None,
        b: ArrayLike | None = None,
        *,
        a_eq: Any = None,
        b_eq: ArrayLike | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
    ) -> None:
        constraints = check_constraints(a, b, a_eq, b_eq, lower, upper)
        self.dim = constraints.dim
        inside = presolved(constraints)
        normals, offsets, ball = inside.normals, inside.offsets, inside.ball
        self._plane = inside.plane
        self._names = [constraints.name(int(source)) for source in inside.sources]
        extent = reach(normals, offsets, ball.centre)
        self._kernel_origin = origin_of(extent)
        if self._kernel_origin is not None:
            offsets = moved_to(normals, offsets, self._kernel_origin)
            ball = _ball_again(normals, offsets)
            extent = reach(normals, offsets, ball.centre)
        check_resolved(normals, offsets, extent)
        begin, end = extent.centre - extent.outer, extent.centre + extent.outer
        if inside.plane is not None:
            offsets = offsets - inside.rounding(np.maximum(*np.abs(self._from_origin(begin, end))))
        dense = normals.toarray()
        doubt = largest_error(dense, offsets, begin, end)
        self.data = compiled_polytope(dense, offsets, doubt)
        self.centre, self.inner_radius = self.from_kernel(ball.centre), ball.radius
        self._sizes, self.analytic_centre = ball.sizes, extent.centre

    @classmethod
    def from_constraints(cls, *constraints: Any) -> 'PolytopeSpace':
        """
        Build a polytope from constraints of scipy's: ``LinearConstraint`` and ``Bounds``.

        Each has limits ``lb`` and ``ub``, and a ``LinearConstraint`` a matrix ``A``. Equal limits
        are an equation.

        Raises
        ------
        SpaceError
            When a constraint is neither of these, or as for ``PolytopeSpace``.

        """
        return cls(**from_scipy(constraints))

    def __repr__(self) -> str:
        """Name the dimension, count the inequalities and, if there are any, the equations."""
        equations = '' if self._plane is None else f', equations={len(self._plane.bound)}'
        return f'PolytopeSpace(dim={self.dim}, inequalities={len(self.data.offsets)}{equations})'

    @property
    def kernel_dim(self) -> int:
        """Dimension of the kernel frame: that of the plane which the equations leave."""
        return self.dim if self._plane is None else len(self._plane.free)

    @property
    def is_rigid(self) -> bool:
        """Whether the kernel frame keeps lengths: without equations."""
        return self._plane is None

    @property
    def normals(self) -> Any:
        """Sparse matrix of the normals of the planes, one in a row, kernel frame."""
        from scipy import sparse

        return sparse.csr_array(self.data.normals)

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (kernel_dim,), kernel frame."""
        return self._extremes(np.eye(self.kernel_dim))

    @cached_property
    def _bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        corners = self._from_origin(*self.kernel_bounds)
        if self._plane is None:
            return corners[0], corners[1]
        coefficients = self._plane.matrix
        begin, end = self._extremes(coefficients)
        shift = self._plane.offset
        if self._kernel_origin is not None:
            shift = shift + coefficients @ self._kernel_origin
        lower, upper = np.empty((2, self.dim))
        for corner, free, bound in ((lower, corners[0], begin), (upper, corners[1], end)):
            corner[self._plane.free], corner[self._plane.bound] = free, bound + shift
        return lower, upper

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        lower, upper = self._bounds
        return lower.copy(), upper.copy()

    def _extremes(self, functionals: Floats) -> tuple[Floats, Floats]:
        """Return the least and largest value (k,) of linear functions (k, kernel_dim)."""
        return extremes(self.normals, self.data.offsets, self._sizes, functionals)

    @property
    def zero_length(self) -> float:
        """Length up to which a chord counts as zero: a fraction ``MARGIN`` of the inner radius."""
        return MARGIN * self.inner_radius

    @cached_property
    def typical_clearance(self) -> float:
        """Mean distance from a point of the largest inner ball to the sphere around that ball."""
        return self.inner_radius / (self.kernel_dim + 1)

    def compiled_at(self, origin: Floats | None) -> Any:
        """
        Return the compiled space, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.

        Raises
        ------
        SpaceError
            When the polytope has equations, so that it has no inside in the caller's frame.

        """
        if self._plane is not None:
            raise SpaceError(
                f'{self!r} has no inside in {self.dim} dimensions: it can be sampled, but not be '
                f'a member of another space'
            )
        return super().compiled_at(origin)

    def transformed(self, matrix: Floats, origin: Floats) -> PolytopeData:
        """
        Return the compiled polytope in coordinates y with ``x = origin + matrix y``.

        Its coordinate walks move along the normals of facets (``facet_axes``). The right-hand
        sides are reduced by the rounding of the map, so that a point inside is mapped to a free
        point.

        Parameters
        ----------
        matrix : (kernel_dim, kernel_dim)
            Invertible matrix.
        origin : (kernel_dim,)
            A free point, kernel frame.

        Raises
        ------
        SpaceError
            When the polytope is too thin for the map.

        """
        from scipy import sparse

        normals, offsets = self.data.normals, self.data.offsets
        rows, limits = normals @ matrix, moved_to(self.normals, offsets, origin)
        lengths = np.linalg.norm(rows, axis=1)
        rows, limits = rows / lengths[:, np.newaxis], limits / lengths
        rows[np.abs(rows) < SPURIOUS] = 0.0
        extent = reach(sparse.csr_array(rows), limits, np.zeros(len(origin)))
        begin, end = extent.centre - extent.outer, extent.centre + extent.outer
        sizes = np.abs(origin) + np.abs(matrix) @ np.maximum(np.abs(begin), np.abs(end))
        limits -= MAP_ROUNDING * (np.abs(normals) @ sizes + np.abs(offsets)) / lengths
        if not (limits > 0.0).all():
            raise SpaceError('the polytope is too thin for the map into other coordinates')
        doubt = largest_error(rows, limits, begin, end)
        return compiled_polytope(rows, limits, doubt, facet_axes(rows, limits))

    def _from_origin(self, *points: Floats) -> Floats:
        """Return points (k, kernel_dim) of the kernel frame in coordinates of the caller's."""
        return super().from_kernel(np.array(points))

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., dim) of the caller's frame to the kernel frame, in a new array."""
        return super().to_kernel(points if self._plane is None else points[..., self._plane.free])

    def from_kernel(self, points: Floats) -> Floats:
        """Convert points (..., kernel_dim) to the caller's frame, in a new array."""
        moved = super().from_kernel(points)
        return moved if self._plane is None else self._plane.lift(moved)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """
        Convert a direction (dim,) to the kernel frame, in a new array.

        Raises
        ------
        RequestError
            When the direction does not lie in the plane of the equations.

        """
        if self._plane is None:
            return super().turn_to_kernel(directions)
        if not self._plane.is_along(directions):
            raise RequestError(
                f'direction must lie in the plane of the equations, got {directions.tolist()}'
            )
        return np.ascontiguousarray(directions[self._plane.free])

    def contains(self, points: ArrayLike) -> Any:
        """
        Return which points are free.

        In a polytope with equations, a point has to satisfy each of them up to 1e-9 of the sizes
        of its terms.

        Parameters
        ----------
        points : (k, dim) or (dim,)
            Points in the caller's frame.

        Returns
        -------
        (k,) bool or bool

        """
        free = super().contains(points)
        if self._plane is None:
            return free
        on_plane = self._plane.holds(check_points('points', points, self.dim))
        return bool(free and on_plane) if np.ndim(free) == 0 else free & on_plane

    def chord(self, point: ArrayLike, direction: ArrayLike) -> Chord:
        """
        Return the chord through a point.

        Parameters
        ----------
        point, direction : (dim,)
            Caller's frame. The ends are parameters in units of ``|direction|``.

        Raises
        ------
        RequestError
            When the point is not finite, the direction is zero or not finite, or it does not lie
            in the plane of the equations.

        """
        chord = super().chord(point, direction)
        return chord if self._is_on_plane('point', point) else Chord(0.0, 0.0)

    def is_motion_valid(self, start: ArrayLike, end: ArrayLike) -> bool:
        """Return whether every point of the closed segment from ``start`` to ``end`` is free."""
        on_plane = self._is_on_plane('start', start) and self._is_on_plane('end', end)
        return on_plane and super().is_motion_valid(start, end)

    def first_blocked_segment(self, path: ArrayLike) -> int | None:
        """
        Return the index of the first segment of a path (m, dim) that is not free, or None.

        Segment k leads from point k to point k + 1. The path is in the caller's frame.
        """
        blocked = super().first_blocked_segment(path)
        if self._plane is None:
            return blocked
        off = np.flatnonzero(~self._plane.holds(check_points('path', path, self.dim)))
        first = [max(int(off[0]) - 1, 0)] if len(off) else []
        return min([*first, *([] if blocked is None else [blocked])], default=None)

    def _is_on_plane(self, name: str, point: ArrayLike) -> bool:
        """Return whether a point (dim,) satisfies the equations, if there are any."""
        x = check_point(name, point, self.dim)
        return self._plane is None or bool(self._plane.holds(x))

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the closed polytope contains the box between two corners (dim,)."""
        if self._plane is not None:
            return False
        normals, offsets = self.data.normals, self.data.offsets
        worst = np.where(normals > 0.0, self.to_kernel(upper), self.to_kernel(lower))
        return bool(((normals * worst).sum(axis=1) <= offsets).all())

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        if not self._is_on_plane('point', x):
            return 'outside the polytope: it does not satisfy the equations'
        excess = self.data.normals @ self.to_kernel(x) - self.data.offsets
        k = int(np.argmax(excess))
        return f'outside the polytope: {excess[k]:g} beyond the plane of {self._names[k]}'


def _ball_again(normals: Any, offsets: Floats) -> Ball:
    """Return a largest ball inside a polytope that is known to have an inside."""
    ball = largest_ball(normals, offsets)
    if not isinstance(ball, Ball):
        raise SpaceError('the polytope is too thin to be measured where it lies')
    return ball
