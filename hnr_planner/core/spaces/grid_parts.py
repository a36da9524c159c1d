"""Connected parts of a grid's free space: the point of a part that is nearest to another point."""

import math

from hnr_planner.core.kernels import kernel
import numpy as np


@kernel
def nearest_in_part(labels, part, target, margin):
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
            if labels[row, column] == part:
                x = min(max(target[0], column + margin), column + 1 - margin)
                distance = math.hypot(x - target[0], y - target[1])
                if distance < least:
                    nearest[0], nearest[1], least = x, y, distance
    return nearest, least
