"""
Homology classes of paths: on which side a path passes every island, as a signature.

An island is an obstacle with free space all around it. A ray goes straight up from a point in
each; the signature of a path adds the island's number where the path crosses its ray to the right
and takes it away where it crosses to the left (Bhattacharya, Likhachev and Kumar, "Topological
constraints in search-based robot path planning", 2012). Two paths with the same ends have the same
signature when the loop that both make winds around no island, and another one when it does: then
neither can be deformed into the other.

Numbers are random words, added modulo 2^64, so that one word holds the windings around all
islands: two classes have the same one with a chance of 2^-64. In the kernel frame, two dimensions.
Without islands every path has the signature 0, and may pass everything on any side.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
import numpy as np
from numpy.typing import NDArray


class Islands(NamedTuple):
    """
    A point in each island, from left to right.

    Attributes
    ----------
    x, y : (k,)
        The points.
    numbers : (k,) int64
        Number that is added when the ray of each is crossed.

    """

    x: Floats
    y: Floats
    numbers: NDArray[np.int64]


def islands_at(points: Floats) -> Islands:
    """Return the islands that hold ``points`` (k, 2), one each."""
    x, y = points[np.argsort(points[:, 0], kind='stable')].T
    words = np.random.default_rng(0).integers(-(2**63), 2**63, len(points))
    return Islands(x.copy(), y.copy(), words)


#: No islands: paths may pass obstacles on any side.
NO_ISLANDS = islands_at(np.empty((0, 2)))


@kernel
def crossings(islands, a, b):
    """Return the signature (int64) of the segment a-b, points (2,)."""
    signature = np.int64(0)
    if len(islands.x) == 0 or a[0] == b[0]:
        return signature
    # A ray belongs to what is right of it, so a vertex on a ray is on one side of it only.
    first = np.searchsorted(islands.x, min(a[0], b[0]), side='right')
    last = np.searchsorted(islands.x, max(a[0], b[0]), side='right')
    slope = (b[1] - a[1]) / (b[0] - a[0])
    for k in range(first, last):
        if a[1] + slope * (islands.x[k] - a[0]) > islands.y[k]:
            signature += islands.numbers[k] if a[0] < b[0] else -islands.numbers[k]
    return signature


@kernel
def signature(islands, path):
    """Return the sum (int64) of the signatures of the segments of a path (m, 2)."""
    total = np.int64(0)
    if len(islands.x) == 0:
        return total
    for k in range(1, len(path)):
        total += crossings(islands, path[k - 1], path[k])
    return total


@kernel
def loop_signature(islands, a, x, b):
    """Return the signature of the loop a-x-b-a: 0 when the triangle holds no island's point."""
    return crossings(islands, a, x) + crossings(islands, x, b) + crossings(islands, b, a)
