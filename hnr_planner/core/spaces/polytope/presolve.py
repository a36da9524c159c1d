"""
What the constraints of a polytope leave: the plane that holds it, and its inequalities there.

Inequalities that every point holds with equality are found and used as equations: where no ball
fits, the linear program for the largest ball names some of them (module ``measures``). They lead
to a plane of fewer dimensions, until a ball fits.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.polytope.equations import Plane, plane_of
from hnr_planner.core.spaces.polytope.inequalities import (
    Constraints,
    row_lengths,
    scaled_rows,
)
from hnr_planner.core.spaces.polytope.measures import Ball, Flat, largest_ball, Lifted
from hnr_planner.core.spaces.polytope.scaling import sizes_of
import numpy as np
from numpy.typing import NDArray

#: Length of a row in the plane, as a fraction of the terms it is computed from, that counts as 0.
PARALLEL = 1e-11
#: Distance by which a point may violate a row that is parallel to the plane, in the row's terms.
VIOLATION = 1e-9
#: Bound on the rounding of a row's value, as a fraction of the sum of the sizes of its terms.
ROUNDING = 64 * 2.0**-53


class Inside(NamedTuple):
    """
    The inequalities of a polytope with an inside, in the plane of its equations.

    Attributes
    ----------
    plane : Plane or None
        The plane; None where there are no equations, so that points keep all coordinates.
    normals, offsets : (m, k) sparse, (m,)
        Rows of length 1 for the coordinates of the plane, and right-hand sides.
    sources : (m,)
        Number of the caller's constraint that each row is.
    given, limits : (m, dim) sparse, (m,)
        The same rows for all coordinates, and right-hand sides, divided by the same lengths.
    ball : Ball
        A largest ball inside, in the coordinates of the plane.

    """

    plane: Plane | None
    normals: Any
    offsets: Floats
    sources: NDArray[np.intp]
    given: Any
    limits: Floats
    ball: Ball

    def rounding(self, largest: Floats) -> Floats:
        """
        Return bounds (m,) on the rounding of the rows at points that were lifted from the plane.

        ``largest`` (k,) are the largest sizes of the coordinates of the plane.
        """
        if self.plane is None:
            return np.zeros(len(self.offsets))
        sizes = np.empty(self.given.shape[1])
        sizes[self.plane.free] = largest
        sizes[self.plane.bound] = np.abs(self.plane.offset) + np.abs(self.plane.matrix) @ largest
        return np.asarray(ROUNDING * (abs(self.given) @ sizes + np.abs(self.limits)))


def presolved(constraints: Constraints) -> Inside:
    """
    Return the inequalities of a polytope in the plane of all its equations, the implied ones too.

    Raises
    ------
    SpaceError
        When no point satisfies the constraints, only one does, or they leave it unbounded.

    """
    from scipy import sparse

    equations, targets = constraints.equations, constraints.targets
    while True:
        inside = _in_plane(constraints, equations, targets)
        if inside.normals.shape[0] == 0:
            raise SpaceError('the polytope must be bounded, but no row of a bounds anything')
        lifted = None
        if inside.plane is not None:
            lifted = Lifted(inside.plane.free, inside.given, inside.limits, equations, targets)
        ball = largest_ball(inside.normals, inside.offsets, lifted)
        if isinstance(ball, Ball):
            return inside._replace(ball=ball)
        if ball.is_empty or len(ball.rows) == 0:
            raise _why_empty(constraints, inside.sources, ball)
        equations = sparse.vstack([equations, inside.given[ball.rows]], format='csr')
        targets = np.append(targets, inside.limits[ball.rows])


def _in_plane(constraints: Constraints, equations: Any, targets: Floats) -> Inside:
    """
    Return the rows of a polytope in the plane of equations, without a ball.

    Rows that are parallel to the plane are left out.
    """
    from scipy import sparse

    normals, offsets, sources = constraints.normals, constraints.offsets, constraints.sources
    if equations.shape[0] == 0:
        return Inside(None, normals, offsets, sources, normals, offsets, _NO_BALL)
    every = sparse.vstack([normals, equations], format='csr')
    plane = plane_of(equations, targets, sizes_of(every, np.append(offsets, targets)))
    rows, limits, terms = plane.reduced(normals, offsets)
    lengths = row_lengths(rows)
    is_parallel = lengths <= PARALLEL * terms
    size = np.abs(offsets) + abs(normals[:, plane.bound]) @ np.abs(plane.offset)
    wrong = is_parallel & (limits < -VIOLATION * size)
    if wrong.any():
        k = int(sources[int(wrong.argmax())])
        raise SpaceError(
            f'the polytope must have an inside, but its equations exclude {constraints.name(k)}'
        )
    kept = np.flatnonzero(~is_parallel)
    factors = 1.0 / lengths[kept]
    return Inside(
        plane,
        scaled_rows(rows[kept], factors),
        limits[kept] * factors,
        sources[kept],
        scaled_rows(normals[kept], factors),
        offsets[kept] * factors,
        _NO_BALL,
    )


_NO_BALL = Ball(np.empty(0), 0.0, np.empty(0))


def _why_empty(constraints: Constraints, sources: NDArray[np.intp], flat: Flat) -> SpaceError:
    """Return the error for a polytope without points."""
    names = constraints.names(np.unique(sources[flat.rows]))
    where = ' where its equations hold' if constraints.equations.shape[0] else ''
    return SpaceError(
        f'the polytope must have an inside, but no point holds all of a x <= b{where}: {names} '
        f'exclude each other'
    )
