"""
The extent of a polytope, from its *analytic centre*.

That is the point with the largest product of distances to the planes. With H the Hessian of the
logarithmic barrier there and m planes, the ellipsoid ``(x - c) H (x - c) < 1`` lies inside the
polytope, and the ellipsoid m times as large holds all of its points (Boyd and Vandenberghe, Convex
Optimization, section 8.5.3). To find the centre takes some dozen linear systems. It exists exactly
when the polytope is bounded and has an inside.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.polytope.inequalities import scaled_rows
from hnr_planner.core.spaces.polytope.measures import why_no_reach
import numpy as np

#: Largest number of Newton steps to the analytic centre.
NEWTON_STEPS = 100
#: Newton decrement below which the centre is found.
CONVERGED = 1e-3
#: Bisections for the length of a Newton step.
BISECTIONS = 40
#: Longest Newton step, as a fraction of that to the nearest plane.
STEP_MAX = 1.0 - 1e-6
#: A Hessian is factorized as a sparse matrix if fewer than one in this many numbers is not zero.
SPARSE = 20
#: Entries of a triangular factor of unit columns below this are rounding errors of 0.
ZERO = 1e-14


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


def reach(normals: Any, offsets: Floats, start: Floats) -> Reach:
    """
    Return the extent of a polytope, by Newton's method from a point ``start`` (dim,) inside.

    ``normals`` (m, dim) is sparse.

    Raises
    ------
    SpaceError
        When the polytope is unbounded, or too thin to be measured.

    """
    x = start.copy()
    for _ in range(NEWTON_STEPS):
        slopes = scaled_rows(normals, 1.0 / (offsets - normals @ x))
        gradient, hessian = np.asarray(slopes.sum(axis=0)).ravel(), _square(slopes)
        diagonal = hessian.diagonal()
        if not (diagonal > 0.0).all():
            break
        # With a diagonal of ones the matrix is regular whatever the sizes of the coordinates.
        sizes = 1.0 / np.sqrt(diagonal)
        solve = _solver(hessian, sizes)
        if solve is None:
            break
        step = -sizes * solve(sizes * gradient)
        decrement = float(np.sqrt(max(-gradient @ step, 0.0)))
        if not np.isfinite(decrement):
            break
        if decrement < CONVERGED:
            inverse = solve(np.eye(len(x)))
            inner = sizes * np.sqrt(np.maximum(inverse.diagonal(), 0.0))
            return Reach(x, inner, len(offsets) * inner)
        rates = slopes @ step
        if not (rates > 0.0).any():
            break
        x += _step_length(rates) * step
    raise why_no_reach(normals)


def inner_ellipsoid(normals: Floats, offsets: Floats, centre: Floats) -> Floats:
    """
    Return a matrix M (dim, dim) so that the ellipsoid ``centre + M z``, |z| < 1, lies inside.

    It is that of the logarithmic barrier's Hessian at ``centre``, in the polytope ``normals x <
    offsets``, from a QR decomposition of a factor of the Hessian: so M is as exact as the
    distances to the planes. M is diagonal for a box along the axes.
    """
    from scipy.linalg import solve_triangular

    slopes = normals / (offsets - normals @ centre)[:, np.newaxis]
    sizes = 1.0 / np.linalg.norm(slopes, axis=0)
    r = np.asarray(np.linalg.qr(slopes * sizes, mode='r'))
    r[np.abs(r) < ZERO] = 0.0
    return np.asarray(sizes[:, np.newaxis] * solve_triangular(r, np.eye(len(r))))


def _square(matrix: Any) -> Any:
    """
    Return the product of a sparse matrix's transpose and itself.

    It is an array if some rows are full; their part is computed by dense products.
    """
    is_full = np.diff(matrix.indptr) * SPARSE >= matrix.shape[1]
    if not is_full.any():
        return (matrix.T @ matrix).tocsc()
    full, others = matrix[is_full].toarray(), matrix[~is_full]
    return full.T @ full + (others.T @ others).toarray()


def _solver(matrix: Any, sizes: Floats) -> Callable[[Floats], Floats] | None:
    """
    Return what solves linear systems with the matrix ``sizes matrix sizes``; None if singular.

    The sizes (dim,) multiply its rows and its columns.
    """
    from scipy import linalg, sparse
    from scipy.sparse.linalg import splu

    try:
        if sparse.issparse(matrix) and matrix.nnz * SPARSE < matrix.shape[0] ** 2:
            scaled = matrix.multiply(sizes).multiply(sizes[:, np.newaxis])
            return splu(scaled.tocsc()).solve
        dense = matrix.toarray() if sparse.issparse(matrix) else matrix
        factor = linalg.cho_factor(dense * np.outer(sizes, sizes))
    except (RuntimeError, linalg.LinAlgError):
        return None
    return lambda right: linalg.cho_solve(factor, right)


def _step_length(rates: Floats) -> float:
    """Return the s that minimizes ``-sum log(1 - s rates)``: some ``rates`` (m,) must be > 0."""
    before, after = 0.0, STEP_MAX / float(rates.max())
    for _ in range(BISECTIONS):
        s = (before + after) / 2.0
        before, after = (s, after) if (rates / (1.0 - s * rates)).sum() < 0.0 else (before, s)
    return before if before > 0.0 else after
