"""
Measures of a polytope: its largest inner ball, its extent, and its bounds.

The largest ball and the bounds are linear programs. The extent of the polytope follows from its
*analytic centre*, the point with the largest product of distances to the planes: with H the
Hessian of the logarithmic barrier there and m planes, the ellipsoid ``(x - c) H (x - c) < 1`` lies
inside the polytope, and the ellipsoid m times as large holds all of its points (Boyd and
Vandenberghe, Convex Optimization, section 8.5.3). To find that centre takes some dozen linear
systems; the bounds take 2 dim linear programs. The centre exists exactly when the polytope is
bounded and has an inside.

If the coordinates of a polytope differ much in size, each is divided by its size first.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
import numpy as np
from numpy.typing import NDArray

#: Factor by which the sizes of coordinates may differ before they are scaled.
UNEVEN = 1e3
#: Rounds in which rows and columns are scaled alternately; the sizes need not be exact.
SCALINGS = 20
#: Radius, in scaled coordinates, up to which a ball is the error of a linear program.
FLAT = 1e-9
#: Largest number of rows that a message lists.
LISTED = 8
#: Largest number of Newton steps to the analytic centre.
NEWTON_STEPS = 100
#: Newton decrement below which the centre is found.
CONVERGED = 1e-3
#: Bisections for the length of a Newton step.
BISECTIONS = 40
#: Longest Newton step, as a fraction of that to the nearest plane.
STEP_MAX = 1.0 - 1e-6


class Ball(NamedTuple):
    """
    A largest ball inside a polytope, where each coordinate is divided by its size.

    Centre and radius are given in the coordinates of the polytope itself.

    Attributes
    ----------
    centre : (dim,)
        The centre of the ball: the Chebyshev centre of the polytope in the divided coordinates.
    radius : float
        Distance from the centre to the nearest plane of the polytope.
    sizes : (dim,)
        Sizes by which the coordinates are divided: ones, unless the sizes differ much.

    """

    centre: Floats
    radius: float
    sizes: Floats


class Reach(NamedTuple):
    """
    Two boxes around the analytic centre of a polytope, with sides along the axes.

    The inner box bounds the ellipsoid inside the polytope, the outer one holds all points.

    Attributes
    ----------
    centre : (dim,)
        The analytic centre of the polytope.
    inner, outer : (dim,)
        Halves of the sides of the inner and the outer box.

    """

    centre: Floats
    inner: Floats
    outer: Floats


def largest_ball(normals: Floats, offsets: Floats, rows: NDArray[np.intp]) -> Ball:
    """
    Return the largest ball inside the polytope ``normals x < offsets``.

    Raises
    ------
    SpaceError
        When there is no ball, or no largest one. The message names inequalities by their indices
        ``rows`` (m,) in the caller's matrix.

    """
    dim = normals.shape[1]
    cost = np.append(np.zeros(dim), -1.0)
    for sizes in _sizes_to_try(normals, offsets):
        scaled, limits = _scaled(normals, offsets, sizes)
        found = _minimum(cost, np.column_stack([scaled, np.ones(len(scaled))]), limits)
        if found.status == 0:
            y, radius = found.x[:dim], float(found.x[dim])
            if radius > FLAT and (limits - scaled @ y).min() > radius / 2.0:
                is_scaled = (sizes != 1.0).any()
                nearest = float((offsets - normals @ (y * sizes)).min())
                return Ball(y * sizes, nearest if is_scaled else radius, sizes)
    raise _why_no_ball(found, normals, rows)


def _why_no_ball(found: Any, normals: Floats, rows: NDArray[np.intp]) -> SpaceError:
    """
    Return the error that says why there is no largest ball.

    ``found`` is the result of scipy for the last linear program that was tried.
    """
    if found.status != 0 or found.x[-1] > FLAT:
        return why_no_reach(normals)
    binding = _listed(rows[np.flatnonzero(found.ineqlin.marginals)])
    if found.x[-1] < -FLAT:
        return SpaceError(
            f'the polytope must have an inside, but no point holds all of a x <= b: rows '
            f'{binding} of a exclude each other'
        )
    return SpaceError(
        f'the polytope must have an inside, but it is flat: rows {binding} of a leave no room '
        f'between them, as an equation does. Give the set in coordinates y of its own plane, '
        f'x = x0 + N y, where x0 holds the equations and the columns of N are a basis of the null '
        f'space of their matrix (scipy.linalg.null_space): (a N) y < b - a x0'
    )


def _listed(rows: NDArray[np.intp]) -> str:
    """Format row numbers for a message: at most ``LISTED`` of them."""
    more = '' if len(rows) <= LISTED else f' and {len(rows) - LISTED} more'
    return ', '.join(map(str, rows[:LISTED])) + more


def why_no_reach(normals: Floats) -> SpaceError:
    """Return the error for a polytope without analytic centre: it is unbounded or too thin."""
    dim = normals.shape[1]
    # A direction along which no slack decreases, and some increase.
    found = _minimum(normals.sum(axis=0), normals, np.zeros(len(normals)), sides=(-1.0, 1.0))
    is_recession = found.status == 0 and found.fun < -FLAT
    if is_recession or np.linalg.matrix_rank(normals) < dim:
        return SpaceError('the polytope must be bounded, but a x < b leaves a direction unlimited')
    return SpaceError(
        'the polytope is too thin for its width to be measured in these coordinates; turn and '
        'scale the coordinates so that its sides are of about the same length'
    )


def reach(normals: Floats, offsets: Floats, start: Floats) -> Reach:
    """
    Return the extent of a polytope, by Newton's method from a point ``start`` (dim,) inside.

    Raises
    ------
    SpaceError
        When the polytope is unbounded, or too thin to be measured.

    """
    x = start.copy()
    for _ in range(NEWTON_STEPS):
        distances = offsets - normals @ x
        slopes = normals / distances[:, np.newaxis]
        gradient, hessian = slopes.sum(axis=0), slopes.T @ slopes
        if not hessian.diagonal().all():
            break
        # With a diagonal of ones the matrix is regular whatever the sizes of the coordinates.
        sizes = 1.0 / np.sqrt(hessian.diagonal())
        try:
            inverse = np.linalg.inv(hessian * np.outer(sizes, sizes))
        except np.linalg.LinAlgError:
            break
        step = -sizes * (inverse @ (sizes * gradient))
        decrement = float(np.sqrt(max(-gradient @ step, 0.0)))
        if not np.isfinite(decrement):
            break
        if decrement < CONVERGED:
            inner = sizes * np.sqrt(np.maximum(inverse.diagonal(), 0.0))
            return Reach(x, inner, len(offsets) * inner)
        rates = slopes @ step
        if not (rates > 0.0).any():
            break
        x += _step_length(rates) * step
    raise why_no_reach(normals)


def _step_length(rates: Floats) -> float:
    """Return the s that minimizes ``-sum log(1 - s rates)``: some ``rates`` (m,) must be > 0."""
    before, after = 0.0, STEP_MAX / float(rates.max())
    for _ in range(BISECTIONS):
        s = (before + after) / 2.0
        before, after = (s, after) if (rates / (1.0 - s * rates)).sum() < 0.0 else (before, s)
    return before if before > 0.0 else after


def bounds(normals: Floats, offsets: Floats, sizes: Floats) -> tuple[Floats, Floats]:
    """
    Return the lower and upper corner (dim,) of the polytope ``normals x < offsets``.

    They are the extremes of every coordinate, from 2 dim linear programs in ``x / sizes``. Raise
    SpaceError when one of them fails.
    """
    axes = np.eye(normals.shape[1])
    scaled, limits = _scaled(normals, offsets, sizes)
    found = [_minimum(cost, scaled, limits) for cost in np.concatenate([axes, -axes])]
    for each in found:
        if each.status != 0:
            raise SpaceError(f'the bounds of the polytope could not be found: {each.message}')
    lower, upper = np.array([each.fun for each in found]).reshape(2, -1) * (sizes, -sizes)
    return lower, upper


def _sizes_to_try(normals: Floats, offsets: Floats) -> list[Floats]:
    """
    Return the sizes (dim,) of coordinates to try, in order.

    Ones come first, unless the numbers in the columns of ``normals`` differ by more than
    ``UNEVEN``.
    """
    scaled = _sizes(np.column_stack([normals, offsets]))
    scaled = scaled[:-1] / scaled[-1]
    even = _sizes(normals)
    if even.max() > UNEVEN * even.min():
        return [scaled]
    return [np.ones(normals.shape[1]), scaled]


def _sizes(matrix: Floats) -> Floats:
    """
    Return factors (columns,) that scale the nonzero numbers of ``matrix`` to about 1.

    They do so together with factors of rows, which are not returned.
    """
    is_nonzero = matrix != 0.0
    logs = np.log(np.abs(matrix), where=is_nonzero, out=np.zeros_like(matrix))
    n_in_rows = np.maximum(is_nonzero.sum(axis=1), 1)
    n_in_columns = np.maximum(is_nonzero.sum(axis=0), 1)
    columns = np.zeros(matrix.shape[1])
    for _ in range(SCALINGS):
        rows = -((logs + columns) * is_nonzero).sum(axis=1) / n_in_rows
        columns = -((logs + rows[:, np.newaxis]) * is_nonzero).sum(axis=0) / n_in_columns
    return np.exp(columns - columns.mean())


def _scaled(normals: Floats, offsets: Floats, sizes: Floats) -> tuple[Floats, Floats]:
    """
    Return the normals and offsets of a polytope in the coordinates ``x / sizes``.

    The rows are scaled to length 1 again.
    """
    if not (sizes != 1.0).any():
        return normals, offsets
    rows = normals * sizes
    lengths = np.linalg.norm(rows, axis=1)
    return rows / lengths[:, np.newaxis], offsets / lengths


def _minimum(
    cost: Floats,
    rows: Floats,
    limits: Floats,
    sides: tuple[float | None, float | None] = (None, None),
) -> Any:
    """
    Minimize ``cost x`` where ``rows x <= limits``, and return the result of scipy.

    Every coordinate of x is limited to the interval ``sides``; None is no limit.
    """
    from scipy.optimize import linprog  # a quarter of a second, which other spaces do without

    return linprog(cost, A_ub=rows, b_ub=limits, bounds=sides, method='highs')
