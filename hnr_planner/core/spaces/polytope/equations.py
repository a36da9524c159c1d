"""
The plane of points that satisfy equations, with some of the coordinates as its own.

A QR decomposition with pivoting chooses *free* coordinates, from which the equations give the
others: ``x[bound] = matrix x[free] + offset``. A point of the plane is its free coordinates, the
same numbers as the caller's, so that going to the plane and back changes none of them.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.transformed import multiply
import numpy as np
from numpy.typing import NDArray

#: Size of a pivot, as a fraction of the largest, below which an equation follows from others.
RANK = 1e-10
#: Error with which equations that follow from others may contradict them, in scaled numbers.
CONTRADICTION = 1e-8
#: Coefficients below this, in scaled numbers, are rounding errors of zero.
ZERO = 1e-13
#: Error of an equation at a point that lies on the plane, as a fraction of the equation's terms.
ON_PLANE = 1e-9


class Plane(NamedTuple):
    """
    Points x whose coordinates ``bound`` follow from the others.

    Attributes
    ----------
    free : (k,)
        Indices of the coordinates of the plane.
    bound : (r,)
        Indices of the other coordinates.
    matrix : (r, k)
        Coefficients of the bound coordinates in the free ones.
    offset : (r,)
        The bound coordinates where all free ones are 0.

    """

    free: NDArray[np.intp]
    bound: NDArray[np.intp]
    matrix: Floats
    offset: Floats

    def lift(self, points: Floats) -> Floats:
        """Return the points (..., dim) of the plane that have these free coordinates (..., k)."""
        flat = np.ascontiguousarray(points.reshape(-1, points.shape[-1]))
        columns = np.ascontiguousarray(self.matrix.T)
        lifted = _lifted(self.free, self.bound, columns, self.offset, flat)
        return np.asarray(lifted.reshape(*points.shape[:-1], lifted.shape[1]))

    def holds(self, points: Floats) -> NDArray[np.bool_]:
        """Return which of the points (..., dim) satisfy the equations, up to ``ON_PLANE``."""
        free, bound = points[..., self.free], points[..., self.bound]
        with np.errstate(invalid='ignore', over='ignore'):
            error = np.abs(bound - (free @ self.matrix.T + self.offset))
        return np.asarray((error <= ON_PLANE * self.terms(points)).all(axis=-1))

    def terms(self, points: Floats) -> Floats:
        """Return the sums (..., r) of the sizes of the terms of each equation at points."""
        free, bound = np.abs(points[..., self.free]), np.abs(points[..., self.bound])
        return np.asarray(bound + free @ np.abs(self.matrix).T + np.abs(self.offset))

    def is_along(self, direction: Floats) -> bool:
        """Return whether a direction (dim,) lies in the plane, up to ``ON_PLANE``."""
        return bool(self._replace(offset=np.zeros(len(self.bound))).holds(direction))

    def reduced(self, normals: Any, offsets: Floats) -> tuple[Any, Floats, Floats]:
        """
        Return inequalities for the free coordinates, and the size of the largest term of each row.

        Bound coordinates are replaced by the sums that the equations give for them. ``normals``
        (m, dim) is sparse. Coefficients that are rounding errors of the terms they are computed
        from are zero in the result, which is sparse too.
        """
        from scipy import sparse

        columns = normals.tocsc()
        at_free, at_bound = columns[:, self.free], columns[:, self.bound]
        matrix = sparse.csr_array(self.matrix)
        rows = (at_free + at_bound @ matrix).tocsr()
        terms = (abs(at_free) + abs(at_bound) @ abs(matrix)).tocsr()
        is_error = (abs(rows) < ZERO * terms).tocsr()
        rows = rows - rows.multiply(is_error)
        rows.eliminate_zeros()
        return rows.tocsr(), offsets - at_bound @ self.offset, terms.max(axis=1).toarray().ravel()


def plane_of(equations: Any, targets: Floats, sizes: Floats) -> Plane:
    """
    Return the plane of the points that satisfy ``equations x = targets``.

    Parameters
    ----------
    equations : (r, dim) sparse
        Equations, of which some may follow from others.
    targets : (r,)
        Their right-hand sides.
    sizes : (dim,)
        Typical sizes of the coordinates, by which they are divided first.

    Raises
    ------
    SpaceError
        When the equations contradict each other, or leave a single point.

    """
    from scipy.linalg import qr, solve_triangular

    scaled = equations.toarray() * sizes
    lengths = np.linalg.norm(scaled, axis=1)
    scaled, right = scaled / lengths[:, np.newaxis], targets / lengths
    q, r, order = qr(scaled, mode='economic', pivoting=True)
    pivots = np.abs(np.diag(r))
    rank = int((pivots > RANK * pivots[0]).sum())
    q, r = q[:, :rank], r[:rank]
    along = q.T @ right
    error = np.abs(right - q @ along)
    if error.max() > CONTRADICTION * (1.0 + np.abs(right).max()):
        raise SpaceError(
            f'the polytope must have an inside, but no point holds all of its equations: one is '
            f'off by {error.max():.2g} where the others hold'
        )
    if rank == scaled.shape[1]:
        raise SpaceError('the polytope must have an inside, but its equations leave one point')
    bound, free = order[:rank], order[rank:]
    by_free = np.argsort(free)
    free, r = free[by_free], np.hstack([r[:, :rank], r[:, rank:][:, by_free]])
    matrix = -solve_triangular(r[:, :rank], r[:, rank:])
    offset = solve_triangular(r[:, :rank], along)
    matrix[np.abs(matrix) < ZERO * np.maximum(np.abs(matrix).max(initial=0.0), 1.0)] = 0.0
    offset *= sizes[bound]
    _keep_fixed(equations, targets, bound, offset)
    return Plane(free, bound, sizes[bound, np.newaxis] * matrix / sizes[free], offset)


def _keep_fixed(equations: Any, targets: Floats, bound: NDArray[np.intp], offset: Floats) -> None:
    """Write coordinates that an equation fixes to ``offset`` (r,) as exactly as it gives them."""
    place = np.full(equations.shape[1], -1)
    place[bound] = np.arange(len(bound))
    for row in np.flatnonzero(np.diff(equations.indptr) == 1):
        k = equations.indptr[row]
        if place[equations.indices[k]] >= 0:
            offset[place[equations.indices[k]]] = targets[row] / equations.data[k]


@kernel
def _lifted(free, bound, columns, offset, points):
    """
    Return the points (n, dim) of the plane that have these free coordinates (n, k).

    ``columns`` (k, r) are those of the plane's matrix.
    """
    lifted = np.empty((len(points), len(free) + len(bound)))
    values = np.empty(len(bound))
    for n in range(len(points)):
        multiply(columns, points[n], values)
        for j in range(len(free)):
            lifted[n, free[j]] = points[n, j]
        for i in range(len(bound)):
            lifted[n, bound[i]] = values[i] + offset[i]
    return lifted
