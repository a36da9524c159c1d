"""A polytope: the points that hold finitely many linear inequalities."""

import math

from hnr_planner.core.checks import check_numbers, check_point, check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.bounds import check_bounds
from hnr_planner.core.spaces.polytope.planes import doubt, layout_of, PolytopeData
from hnr_planner.core.spaces.primitives import contains, first_entry, first_exit, touches
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: A polytope thinner than this part of its bounds' diagonal has no inside that numbers resolve.
THINNEST = 1e-10


class PolytopeSpace(Space):
    """
    The points x with ``a x < b`` in every row.

    Parameters
    ----------
    a : (m, dim)
        One row for each inequality.
    b : (m,)
        Right-hand sides.

    Raises
    ------
    SpaceError
        When the inequalities leave no point, none with room around it, or an unbounded set.

    """

    def __init__(self, a: ArrayLike, b: ArrayLike) -> None:
        normals, offsets = _check_inequalities(a, b)
        self.dim = normals.shape[1]
        lower, upper = self._lower, self._upper = _bounds(normals, offsets)
        check_bounds('the polytope', lower, upper)
        self.data = PolytopeData(
            normals, offsets, layout_of(normals), doubt(normals, offsets, lower, upper)
        )
        #: Centre (dim,) of the largest ball inside, and its radius.
        self.centre, self.inner_radius = _largest_ball(normals, offsets)
        if self.inner_radius <= THINNEST * np.linalg.norm(self._upper - self._lower):
            raise SpaceError(
                f'the polytope must have an inside, but the largest ball in it has radius '
                f'{max(self.inner_radius, 0.0):g}'
            )

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        return self._lower.copy(), self._upper.copy()

    @property
    def typical_clearance(self) -> float:
        """Mean distance to the boundary in a ball as large as the largest inside."""
        return self.inner_radius / (self.dim + 1)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether every inequality holds at the corner where it is nearest to failing."""
        normals, offsets = self.data.normals, self.data.offsets
        worst = np.where(normals > 0.0, upper, lower)
        return bool(((normals * worst).sum(axis=1) <= offsets).all())

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        normals, offsets = self.data.normals, self.data.offsets
        excess = normals @ check_point('point', point, self.dim) - offsets
        k = int(np.argmax(excess))
        return f'outside the polytope: {excess[k]:g} beyond the plane of row {k} of a'


def _check_inequalities(a: ArrayLike, b: ArrayLike) -> tuple[Floats, Floats]:
    """Return rows of unit length and their right-hand sides, or raise SpaceError."""
    offsets = check_vector('b', b, SpaceError)
    rows = check_numbers('a', a, SpaceError)
    if rows.ndim != 2 or len(rows) != len(offsets) or rows.shape[1] == 0:
        raise SpaceError(f'a must have shape ({len(offsets)}, dim) as b has, got {rows.shape}')
    if not np.isfinite(rows).all():
        raise SpaceError('a must be finite, and is not')
    lengths = np.linalg.norm(rows, axis=1)
    if not lengths.all():
        raise SpaceError(f'row {int(np.argmin(lengths))} of a must not be zero')
    return rows / lengths[:, np.newaxis], offsets / lengths


def _bounds(normals: Floats, offsets: Floats) -> tuple[Floats, Floats]:
    """Lower and upper corner (dim,): the extremes of every coordinate."""
    axes = np.eye(normals.shape[1])
    lower = [_least(axis, normals, offsets)[0] for axis in axes]
    upper = [-_least(-axis, normals, offsets)[0] for axis in axes]
    return np.array(lower), np.array(upper)


def _largest_ball(normals: Floats, offsets: Floats) -> tuple[Floats, float]:
    """Return the Chebyshev centre (dim,) and its distance to the nearest plane."""
    dim = normals.shape[1]
    cost = np.append(np.zeros(dim), -1.0)
    _, solution = _least(cost, np.column_stack([normals, np.ones(len(normals))]), offsets)
    return solution[:dim], float(solution[dim])


def _least(cost: Floats, normals: Floats, offsets: Floats) -> tuple[float, Floats]:
    """Minimize ``cost x`` over the polytope, or raise SpaceError."""
    from scipy.optimize import linprog  # a quarter of a second, which other spaces do without

    found = linprog(cost, A_ub=normals, b_ub=offsets, bounds=(None, None), method='highs')
    if found.status == 2:
        raise SpaceError('the polytope must have an inside, but no point holds all of a x <= b')
    if found.status == 3:
        raise SpaceError('the polytope must be bounded, but a x < b goes on for ever')
    if found.status != 0:
        raise SpaceError(f'the polytope could not be measured: {found.message}')
    return float(found.fun), found.x


@contains.register(PolytopeData)
@kernel
def _contains(polytope, x):
    return _holds(polytope, x, False)


@touches.register(PolytopeData)
@kernel
def _touches(polytope, x):
    return _holds(polytope, x, True)


@first_exit.register(PolytopeData)
@kernel
def _first_exit(polytope, x, u, t, enough):
    lower, upper = _span(polytope, x, u, False)
    return upper if lower < t < upper else t


@first_entry.register(PolytopeData)
@kernel
def _first_entry(polytope, x, u, t):
    lower, upper = _span(polytope, x, u, True)
    return max(t, lower) if t <= upper else math.inf


@kernel
def _holds(polytope, x, closed):
    for k in range(len(polytope.offsets)):
        slack = _slack(polytope, k, x)
        if not (slack > 0.0 or (closed and slack == 0.0)):
            return False
    return True


@kernel
def _span(polytope, x, u, closed):
    """Cut the line with every plane."""
    first, last = -math.inf, math.inf
    for k in range(len(polytope.offsets)):
        slack, rate = _slack(polytope, k, x), _rate(polytope, k, u)
        if rate > 0.0:
            last = min(last, slack / rate)
        elif rate < 0.0:
            first = max(first, slack / rate)
        elif not (slack > 0.0 or (closed and slack == 0.0)):
            return math.inf, -math.inf
    if first < last or (closed and first == last):
        return first, last
    return math.inf, -math.inf


@kernel
def _slack(polytope, k, x):
    """Distance from ``x`` to plane ``k``; below 0 beyond it."""
    return polytope.offsets[k] - _rate(polytope, k, x)


@kernel
def _rate(polytope, k, u):
    """How fast a line along ``u`` approaches plane ``k``."""
    rate = 0.0
    for i in range(len(u)):
        rate += polytope.normals[k, i] * u[i]
    return rate
