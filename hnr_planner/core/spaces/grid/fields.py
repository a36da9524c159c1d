"""
Fields over the cells of a grid, by one pass of OpenCV each: inflation, distance, components.

OpenCV is imported in the functions: the import takes a tenth of a second, and other spaces do not
need it.
"""

from hnr_planner.core.spaces.grid.cells import Bools
import numpy as np
from numpy.typing import NDArray

#: Largest distance, since distances are stored in one byte [cells].
FARTHEST = 255


def inflate(occupied: Bools, radius: float) -> Bools:
    """
    Return which cells have their centre within ``radius`` [cells] of that of an occupied cell.

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
    Return the Chebyshev distance [cells] from each cell to the nearest blocked cell, at most 255.

    Parameters
    ----------
    blocked : (rows, cols) bool
        The blocked cells.
    closed_rim : bool
        Whether the rim of one cell that is added on every side counts as blocked.

    Returns
    -------
    (rows + 2, cols + 2) uint8
        The distances, with the rim; 0 for blocked cells and, with ``closed_rim``, on the rim.

    """
    import cv2

    free = np.pad(~blocked, 1, constant_values=not closed_rim).astype(np.uint8)
    if free.all():
        return np.full(free.shape, FARTHEST, dtype=np.uint8)
    distance = cv2.distanceTransform(free, cv2.DIST_C, 3)
    # Rounds and saturates at FARTHEST, in one pass.
    return np.asarray(cv2.convertScaleAbs(distance), dtype=np.uint8)


def components(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """
    Return the number (rows, cols) of the component of each free cell, from 1; 0 where blocked.

    Free cells that share an edge belong to one component, those that share only a corner do not.
    """
    import cv2

    _, labels = cv2.connectedComponents(free.view(np.uint8), connectivity=4, ltype=cv2.CV_32S)
    return np.asarray(labels, dtype=np.int32)
