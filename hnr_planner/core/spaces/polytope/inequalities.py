"""
Validation of the constraints of a polytope, and their scaling.

Inequalities ``a x < b``, bounds of single coordinates and equations become rows of length 1, in
sparse matrices. Rows that every point satisfies are dropped; two equal bounds are an equation.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import check_numbers, Floats
from hnr_planner.core.errors import SpaceError
import numpy as np
from numpy.typing import NDArray

#: Largest number of constraints that a message lists.
LISTED = 8


class Constraints(NamedTuple):
    """
    Constraints ``normals x < offsets`` and ``equations x = targets``, in rows of length 1.

    Attributes
    ----------
    normals : (m, dim) sparse
        One row for each inequality or finite bound.
    offsets : (m,)
        Right-hand sides of the inequalities.
    sources : (m,)
        Number of the caller's constraint that each row is: the rows of ``a``, then the upper
        bounds, then the lower bounds, counted through.
    equations : (r, dim) sparse
        One row for each equation.
    targets : (r,)
        Right-hand sides of the equations.
    n_rows : int
        Number of rows of ``a``.

    """

    normals: Any
    offsets: Floats
    sources: NDArray[np.intp]
    equations: Any
    targets: Floats
    n_rows: int

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return int(self.normals.shape[1])

    def name(self, source: int) -> str:
        """Return the name of the caller's constraint ``source``, such as ``row 3 of a``."""
        if source < self.n_rows:
            return f'row {source} of a'
        side, i = divmod(source - self.n_rows, self.dim)
        return f'{("upper", "lower")[side]}[{i}]'

    def names(self, sources: NDArray[np.intp]) -> str:
        """Return the names of several constraints, at most ``LISTED`` of them."""
        listed = [int(source) for source in sources[:LISTED]]
        rows = [str(source) for source in listed if source < self.n_rows]
        names = [f'{"row" if len(rows) == 1 else "rows"} {", ".join(rows)} of a'] if rows else []
        names += [self.name(source) for source in listed if source >= self.n_rows]
        more = '' if len(sources) <= LISTED else f' and {len(sources) - LISTED} more'
        return ', '.join(names) + more


def check_constraints(a: Any, b: Any, a_eq: Any, b_eq: Any, lower: Any, upper: Any) -> Constraints:
    """
    Return the constraints of a polytope in rows of length 1.

    Parameters
    ----------
    a : (m, dim) or None
        One row for each inequality ``a x < b``, dense or a sparse matrix of scipy's.
    b : (m,) or float
        Right-hand sides; a row with inf limits nothing.
    a_eq : (r, dim) or None
        One row for each equation ``a_eq x = b_eq``, dense or sparse.
    b_eq : (r,) or float
        Right-hand sides of the equations.
    lower, upper : (dim,), float or None
        Bounds of the coordinates; -inf and inf limit nothing.

    Raises
    ------
    SpaceError
        When the numbers describe no constraints, or one that no point satisfies.

    """
    from scipy import sparse  # a tenth of a second, which other spaces do without

    dim = _dimension(a, a_eq, lower, upper)
    rows, limits = _checked_rows('a', a, 'b', b, dim)
    equations, targets = _checked_rows('a_eq', a_eq, 'b_eq', b_eq, dim)
    below, above = _checked_bounds(lower, upper, dim)
    if not np.isfinite(targets).all():
        raise SpaceError(f'b_eq must be finite, got {targets[~np.isfinite(targets)][0]:g}')
    fixed = np.flatnonzero(below == above)
    above, below = above.copy(), below.copy()
    targets = np.append(targets, above[fixed])
    above[fixed], below[fixed] = np.inf, -np.inf
    units = sparse.eye_array(dim, format='csr')
    equations = sparse.vstack([equations, units[fixed]], format='csr')
    equations, targets = _checked_equations(equations, targets)
    normals = sparse.vstack([rows, units, -units], format='csr')
    offsets = np.concatenate([limits, above, -below])
    lengths = row_lengths(normals)
    no_point = (offsets == -np.inf) | ((lengths == 0.0) & (offsets <= 0.0))
    if no_point.any():
        k = int(no_point.argmax())
        left = '0' if lengths[k] == 0.0 else f'a[{k}] x'
        raise SpaceError(
            f'the polytope must have an inside, but row {k} says {left} < {offsets[k]:g}, which '
            f'no point holds'
        )
    kept = np.flatnonzero((lengths > 0.0) & (offsets < np.inf))
    return Constraints(
        scaled_rows(normals[kept], 1.0 / lengths[kept]),
        offsets[kept] / lengths[kept],
        kept,
        equations,
        targets,
        rows.shape[0],
    )


def from_scipy(constraints: tuple[Any, ...]) -> dict[str, Any]:
    """
    Return constraints of scipy's as arguments of ``PolytopeSpace``, by name.

    Each is a ``LinearConstraint``, with ``A``, ``lb`` and ``ub``, or ``Bounds``, without ``A``.
    Raise SpaceError for anything else.
    """
    from scipy import sparse

    rows: list[Any] = []
    limits: list[Floats] = []
    equations: list[Any] = []
    targets: list[Floats] = []
    sides: dict[str, Any] = {}
    for constraint in constraints:
        if not (hasattr(constraint, 'lb') and hasattr(constraint, 'ub')):
            raise SpaceError(f'a constraint must be a LinearConstraint or Bounds: {constraint!r}')
        below = check_numbers('lb', constraint.lb, SpaceError)
        above = check_numbers('ub', constraint.ub, SpaceError)
        if not hasattr(constraint, 'A'):
            lower, upper = sides.get('lower', -np.inf), sides.get('upper', np.inf)
            sides |= {'lower': np.maximum(lower, below), 'upper': np.minimum(upper, above)}
            continue
        matrix = sparse.csr_array(
            np.atleast_2d(constraint.A) if not sparse.issparse(constraint.A) else constraint.A
        )
        below, above = (np.broadcast_to(side, matrix.shape[0]) for side in (below, above))
        equal = below == above
        equations.append(matrix[equal])
        targets.append(above[equal])
        rows += [matrix[~equal], -matrix[~equal]]
        limits += [above[~equal], -below[~equal]]
    if rows:
        sides |= {'a': sparse.vstack(rows), 'b': np.concatenate(limits)}
        sides |= {'a_eq': sparse.vstack(equations), 'b_eq': np.concatenate(targets)}
    return sides


def row_lengths(matrix: Any) -> Floats:
    """Return the lengths (m,) of the rows of a sparse matrix, without overflow of squares."""
    largest = np.zeros(matrix.shape[0])
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    np.maximum.at(largest, row, np.abs(matrix.data))
    ratios = matrix.data / np.where(largest > 0.0, largest, 1.0)[row]
    return largest * np.sqrt(np.bincount(row, ratios**2, minlength=matrix.shape[0]))


def scaled_rows(matrix: Any, factors: Floats) -> Any:
    """Return a sparse matrix whose rows are multiplied by ``factors`` (m,)."""
    scaled = matrix.tocsr(copy=True)
    scaled.data *= np.repeat(factors, np.diff(scaled.indptr))
    return scaled


def _dimension(a: Any, a_eq: Any, lower: Any, upper: Any) -> int:
    """Return the number of coordinates, from the first argument that has it."""
    for name, matrix in (('a', a), ('a_eq', a_eq)):
        if matrix is not None and not _is_empty_list(matrix):
            shape = np.shape(matrix) if not hasattr(matrix, 'shape') else matrix.shape
            if len(shape) != 2 or shape[1] == 0:
                if len(shape) == 0:
                    check_numbers(name, matrix, SpaceError)
                raise SpaceError(f'{name} must have shape (m, dim), got {tuple(shape)}')
            return int(shape[1])
    for bound in (lower, upper):
        if np.ndim(bound) == 1 and np.size(bound):
            return int(np.size(bound))
    raise SpaceError('a polytope needs a matrix a or a_eq, or bounds (dim,)')


def _is_empty_list(matrix: Any) -> bool:
    """Return whether a matrix has neither rows nor a number of columns, like ``[]``."""
    return np.ndim(matrix) == 1 and np.size(matrix) == 0


def _checked_rows(
    name: str, matrix: Any, limits_name: str, limits: Any, dim: int
) -> tuple[Any, Floats]:
    """Return a matrix as sparse rows (m, dim) of finite numbers, and its limits (m,)."""
    from scipy import sparse

    if matrix is None or limits is None:
        if matrix is not None or limits is not None:
            raise SpaceError(f'{name} and {limits_name} must be given together')
        return sparse.csr_array((0, dim)), np.empty(0)
    right = check_numbers(limits_name, limits, SpaceError)
    matrix = np.empty((0, dim)) if _is_empty_list(matrix) else matrix
    if sparse.issparse(matrix):
        rows = sparse.csr_array(matrix, dtype=np.float64)
    else:
        rows = sparse.csr_array(np.atleast_2d(check_numbers(name, matrix, SpaceError)))
    if right.ndim == 0:
        right = np.full(rows.shape[0], float(right))
    if right.ndim != 1:
        raise SpaceError(f'{limits_name} must have shape (m,), got {right.shape}')
    if rows.shape != (len(right), dim):
        raise SpaceError(
            f'{name} must have shape ({len(right)}, dim) as {limits_name} has, '
            f'got {tuple(rows.shape)}'
        )
    if not np.isfinite(rows.data).all():
        raise SpaceError(f'{name} must be finite, and is not')
    if np.isnan(right).any():
        raise SpaceError(
            f'{limits_name} must be numbers, but {limits_name}[{int(np.isnan(right).argmax())}] '
            f'is nan'
        )
    rows.sum_duplicates()
    rows.eliminate_zeros()
    return rows, right


def _checked_bounds(lower: Any, upper: Any, dim: int) -> tuple[Floats, Floats]:
    """Return the bounds as two arrays (dim,), with -inf and inf for none."""
    bounds = []
    for name, given, none in (('lower', lower, -np.inf), ('upper', upper, np.inf)):
        bound = check_numbers(name, none if given is None else given, SpaceError)
        if bound.ndim > 1 or bound.size not in (1, dim):
            raise SpaceError(f'{name} must have shape ({dim},), got {bound.shape}')
        if np.isnan(bound).any():
            raise SpaceError(f'{name} must be numbers, and has a nan')
        bounds.append(np.broadcast_to(bound, dim))
    below, above = bounds
    crossed = (below > above) | (below == np.inf) | (above == -np.inf)
    if crossed.any():
        i = int(crossed.argmax())
        raise SpaceError(
            f'the polytope must have an inside, but lower[{i}] is {below[i]:g} and upper[{i}] is '
            f'{above[i]:g}'
        )
    return below, above


def _checked_equations(equations: Any, targets: Floats) -> tuple[Any, Floats]:
    """Return the equations in rows of length 1, without rows of zeros."""
    lengths = row_lengths(equations)
    wrong = (lengths == 0.0) & (targets != 0.0)
    if wrong.any():
        k = int(wrong.argmax())
        raise SpaceError(f'row {k} of a_eq says 0 = {targets[k]:g}, which no point holds')
    kept = np.flatnonzero(lengths)
    return scaled_rows(equations[kept], 1.0 / lengths[kept]), targets[kept] / lengths[kept]
