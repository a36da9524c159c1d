"""
Resolution of a polytope's coordinates: the origin of its kernel frame, and what is too thin.

Far from 0 floating-point numbers are coarse. The kernel frame counts such coordinates from the
analytic centre of the polytope.
"""

from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.bounds import COARSEST, FINEST
from hnr_planner.core.spaces.polytope.extent import Reach
import numpy as np

#: Least distance from the analytic centre to a plane, as a fraction of the terms that it rounds.
THINNEST = 1e-10


def origin_of(extent: Reach) -> Floats | None:
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


def moved_to(normals: Any, offsets: Floats, origin: Floats) -> Floats:
    """
    Return the right-hand sides (m,) for points counted from ``origin`` (dim,).

    They are computed in extended precision and rounded once.
    """
    exact = np.longdouble
    products = normals.data.astype(exact) * origin.astype(exact)[normals.indices]
    row = np.repeat(np.arange(len(offsets)), np.diff(normals.indptr))
    moved = offsets.astype(exact)
    np.subtract.at(moved, row, products)
    return np.asarray(moved, dtype=np.float64)


def check_resolved(normals: Any, offsets: Floats, extent: Reach) -> None:
    """
    Raise SpaceError if a distance from the centre to a plane is too small to be resolved.

    Each has to be above ``THINNEST`` times the sum of the sizes of its terms.
    """
    distances = offsets - normals @ extent.centre
    terms = abs(normals) @ (np.abs(extent.centre) + extent.inner) + np.abs(offsets)
    if not (distances > THINNEST * terms).all():
        k = int(np.argmin(distances / terms))
        raise SpaceError(
            f'the polytope is too thin: {distances[k]:g} from its middle to a plane, which is '
            f'less than {THINNEST:g} of coordinates of {terms[k]:g}; turn and scale the '
            f'coordinates so that its sides are of about the same length'
        )
