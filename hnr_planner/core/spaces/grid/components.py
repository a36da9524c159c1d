"""Components of the free and of the blocked cells of a grid."""

import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.cells import Bools
import numpy as np
from numpy.typing import NDArray


def island_points(blocked_with_rim: Bools) -> NDArray[np.float64]:
    """
    Return the centre (k, 2) of one cell of each island, kernel frame.

    ``blocked_with_rim`` (rows + 2, cols + 2) includes the rim of blocked cells. An island is a
    component of blocked cells that does not touch the rim. Cells that share an edge
    or only a corner are connected, since no path passes between them.
    """
    import cv2  # only here, as in fields.py

    _, labels = cv2.connectedComponents(
        blocked_with_rim.view(np.uint8), connectivity=8, ltype=cv2.CV_32S
    )
    cells = np.flatnonzero(labels)
    _, first = np.unique(labels.flat[cells], return_index=True)
    rows, columns = np.unravel_index(cells[first], labels.shape)
    inside = labels[rows, columns] != labels[0, 0]
    return np.stack([columns, rows], axis=1)[inside] + 0.5


def largest_component(labels: NDArray[np.int32]) -> Bools:
    """
    Return which cells (rows, cols) belong to the largest component of free space.

    ``labels`` has 0 for blocked cells. All values are false if no cell is free.
    """
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return (labels == sizes.argmax()) & (labels > 0)


@kernel
def nearest_in_component(labels, component, target, margin):
    """
    Return the point (2,) of a component nearest to ``target`` (2,), and the distance between them.

    Points and lengths are in the kernel frame [cells]. Free space is open, so each coordinate of
    the point is kept ``margin`` inside its cell. The distance is inf if no cell has the label
    ``component``.
    """
    rows, columns = labels.shape
    nearest, least = np.empty(2), math.inf
    for row in range(rows):
        y = min(max(target[1], row + margin), row + 1 - margin)
        if abs(y - target[1]) >= least:
            continue
        for column in range(columns):
            if labels[row, column] == component:
                x = min(max(target[0], column + margin), column + 1 - margin)
                distance = math.hypot(x - target[0], y - target[1])
                if distance < least:
                    nearest[0], nearest[1], least = x, y, distance
    return nearest, least
