"""Connected parts of a grid: the nearest point of a free one, and a point in each blocked one."""

import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.cells import Bools
import numpy as np
from numpy.typing import NDArray


def island_points(blocked_with_rim: Bools) -> NDArray[np.float64]:
    """
    Return the centre (k, 2) of a cell of each island, kernel frame.

    An island is a group of blocked cells connected over edges or corners, between which nothing
    gets through, that is not connected with the rim.
    """
    import cv2  # as in grid_fields

    _, labels = cv2.connectedComponents(
        blocked_with_rim.view(np.uint8), connectivity=8, ltype=cv2.CV_32S
    )
    cells = np.flatnonzero(labels)
    _, first = np.unique(labels.flat[cells], return_index=True)
    rows, columns = np.unravel_index(cells[first], labels.shape)
    inside = labels[rows, columns] != labels[0, 0]
    return np.stack([columns, rows], axis=1)[inside] + 0.5


@kernel
def nearest_in_component(labels, component, target, margin):
    """
    Find the point of a part nearest to ``target`` (2,): (point (2,), distance), kernel frame.

    Free space is open: a nearest point on the rim of a cell is taken ``margin`` inside.
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
