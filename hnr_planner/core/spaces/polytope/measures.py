"""
Measures of a polytope by linear programs: its largest inner ball, and its bounds.

If the coordinates of a polytope differ much in size, each is divided by its size first. A largest
ball of radius 0 names inequalities that hold with equality at every point (``Flat``): those whose
dual variables are positive, since the sum of their distances, weighted by these, is 0.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.polytope.inequalities import row_lengths, scaled_rows
from hnr_planner.core.spaces.polytope.scaling import sizes_to_try
import numpy as np
from numpy.typing import NDArray

#: Radius, in scaled coordinates, up to which a ball is the error of a linear program.
FLAT = 1e-9


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


class Flat(NamedTuple):
    """Rows (k,) that a polytope without inside holds with equality, or that exclude each other."""

    rows: NDArray[np.intp]
    is_empty: bool


class Lifted(NamedTuple):
    """
    The inequalities of a polytope in a plane, in all coordinates, with the plane's equations.

    Linear programs are solved in this form, where it is given: its rows are sparse.

    Attributes
    ----------
    free : (k,)
        Indices of the coordinates of the plane.
    rows, limits : (m, dim) sparse, (m,)
        The inequalities; their lengths in the coordinates of the plane are 1.
    equations, targets : (r, dim) sparse, (r,)
        The equations.

    """

    free: NDArray[np.intp]
    rows: Any
    limits: Floats
    equations: Any
    targets: Floats


def largest_ball(normals: Any, offsets: Floats, lifted: Lifted | None = None) -> Ball | Flat:
    """
    Return the largest ball inside the polytope ``normals x < offsets``, or why there is none.

    ``normals`` (m, dim) is sparse, with rows of length 1. ``lifted`` is the same polytope in more
    coordinates.

    Raises
    ------
    SpaceError
        When the polytope is unbounded, or too thin to be measured.

    """
    from scipy import sparse

    if lifted is None:
        every = np.arange(normals.shape[1])
        lifted = Lifted(every, normals, offsets, normals[:0], offsets[:0])
    rows, right = lifted.rows, lifted.limits
    if len(lifted.targets):
        rows = sparse.vstack([rows, lifted.equations], format='csr')
        right = np.append(right, lifted.targets)
    for sizes in sizes_to_try(rows, right):
        scaled, limits = _scaled(normals, offsets, sizes[lifted.free])
        found = _ball_program(normals, lifted, sizes)
        if found.status == 0:
            y, radius = found.x[lifted.free], float(found.x[-1])
            if radius > FLAT and (limits - scaled @ y).min() > radius / 2.0:
                centre = y * sizes[lifted.free]
                is_scaled = (sizes != 1.0).any()
                nearest = float((offsets - normals @ centre).min())
                return Ball(centre, nearest if is_scaled else radius, sizes[lifted.free])
    if found.status != 0 or found.x[-1] > FLAT:
        raise why_no_reach(normals)
    return Flat(np.flatnonzero(found.ineqlin.marginals), bool(found.x[-1] < -FLAT))


def _ball_program(normals: Any, lifted: Lifted, sizes: Floats) -> Any:
    """Return the result of scipy for the largest ball in coordinates divided by their sizes."""
    from scipy import sparse

    lengths = row_lengths(normals.multiply(sizes[lifted.free]).tocsr())
    rows = scaled_rows(lifted.rows.multiply(sizes).tocsr(), 1.0 / lengths)
    equations, targets = _scaled(lifted.equations, lifted.targets, sizes)
    return _minimum(
        np.append(np.zeros(len(sizes)), -1.0),
        sparse.hstack([rows, np.ones((len(lengths), 1))], format='csr'),
        lifted.limits / lengths,
        equations=sparse.hstack([equations, np.zeros((len(targets), 1))], format='csr'),
        targets=targets,
    )


def why_no_reach(normals: Any) -> SpaceError:
    """Return the error for a polytope without analytic centre: it is unbounded or too thin."""
    dim = normals.shape[1]
    # A direction along which no slack decreases, and some increase.
    total = np.asarray(normals.sum(axis=0)).ravel()
    found = _minimum(total, normals, np.zeros(normals.shape[0]), sides=(-1.0, 1.0))
    is_recession = found.status == 0 and found.fun < -FLAT
    if is_recession or np.linalg.matrix_rank(normals.toarray()) < dim:
        return SpaceError('the polytope must be bounded, but a x < b leaves a direction unlimited')
    return SpaceError(
        'the polytope is too thin for its width to be measured in these coordinates; turn and '
        'scale the coordinates so that its sides are of about the same length'
    )


def extremes(
    normals: Any, offsets: Floats, sizes: Floats, functionals: Floats
) -> tuple[Floats, Floats]:
    """
    Return the least and the largest value (k,) of linear functions in a polytope.

    They come from 2 k linear programs, in the coordinates ``x / sizes``.

    Parameters
    ----------
    normals, offsets : (m, dim) sparse, (m,)
        The inequalities.
    sizes : (dim,)
        Sizes of the coordinates.
    functionals : (k, dim)
        Coefficients of the functions.

    Raises
    ------
    SpaceError
        When a linear program fails.

    """
    scaled, limits = _scaled(normals, offsets, sizes)
    ends = []
    for function in functionals * sizes:
        size = float(np.abs(function).max()) or 1.0
        for sign in (1.0, -1.0):
            found = _minimum(sign / size * function, scaled, limits)
            if found.status != 0:
                raise SpaceError(f'a bound of the polytope could not be found: {found.message}')
            ends.append(sign * size * found.fun)
    lower, upper = np.reshape(ends, (-1, 2)).T
    return lower, upper


def _scaled(normals: Any, offsets: Floats, sizes: Floats) -> tuple[Any, Floats]:
    """
    Return the normals and offsets of a polytope in the coordinates ``x / sizes``.

    The rows are scaled to length 1 again.
    """
    if not (sizes != 1.0).any():
        return normals, offsets
    rows = normals.multiply(sizes).tocsr()
    lengths = row_lengths(rows)
    return scaled_rows(rows, 1.0 / lengths), offsets / lengths


def _minimum(
    cost: Floats,
    rows: Any,
    limits: Floats,
    *,
    sides: tuple[float | None, float | None] = (None, None),
    equations: Any = None,
    targets: Floats | None = None,
) -> Any:
    """
    Minimize ``cost x`` where ``rows x <= limits``, and return the result of scipy.

    Every coordinate of x is limited to the interval ``sides``; None is no limit. The points have
    to satisfy ``equations x = targets``, if these are given.
    """
    from scipy.optimize import linprog  # a quarter of a second, which other spaces do without

    if targets is not None and len(targets) == 0:
        equations = targets = None
    return linprog(
        cost,
        A_ub=rows,
        b_ub=limits,
        A_eq=equations,
        b_eq=targets,
        bounds=sides,
        method='highs',
    )
