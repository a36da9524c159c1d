"""
Fields over the cells of a grid, by one pass of OpenCV each: inflation, distance, components.

OpenCV is imported in the functions: it takes a tenth of a second, which other spaces do not need.
"""

from hnr_planner.core.spaces.grid.cells import Bools
import numpy as np
from numpy.typing import NDArray

#: Largest distance, since distances are stored in one byte [cells].
FARTHEST = 255


def inflate(occupied: Bools, radius: float) -> Bools:
    """
    Return the cells whose centre is within ``radius`` [cells] of the centre of an occupied one.

    Squared distances between cells are integers, so the limit on the distance lies between the
    roots of two integers, where the rounding of the transform does not matter.
    """
    import cv2

    if radius == 0.0 or not occupied.any():
        return occupied
    limit = np.sqrt(np.floor(radius * radius + 1e-9) + 0.5)
    distance = cv2.distanceTransform(
        np.logical_not(occupied).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE
    )
    return distance < limit


def free_distance(blocked: Bools, *, closed_rim: bool = True) -> NDArray[np.uint8]:
    """
    Return the Chebyshev distance [cells] from each cell to the nearest blocked one, at most 255.

    Parameters
    ----------
    blocked : (rows, cols) bool
        The blocked cells.
    closed_rim : bool
        Whether the rim of one cell that is added on every side counts as blocked.

    Returns
    -------
    (rows + 2, cols + 2) uint8
        0 for blocked cells and, with ``closed_rim``, on the rim.

    """
    import cv2

    free = np.pad(~blocked, 1, constant_values=not closed_rim).astype(np.uint8)
    if free.all():
        return np.full(free.shape, FARTHEST, dtype=np.uint8)
    distance = cv2.distanceTransform(free, cv2.DIST_C, 3)
    # Rounds and saturates at FARTHEST, in one pass.
    return np.asarray(cv2.convertScaleAbs(distance), dtype=np.uint8)


def components(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the component (rows, cols) of each free cell, from 1; 0 for blocked cells."""
    import cv2

    _, labels = cv2.connectedComponents(free.view(np.uint8), connectivity=4, ltype=cv2.CV_32S)
    return np.asarray(labels, dtype=np.int32)
