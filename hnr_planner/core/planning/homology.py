"""
Homology classes of paths: on which side a path passes every island, as a signature.

An island is an obstacle with free space all around it. A ray goes straight up from a point in each
island. The signature of a path is a sum: the island's number is added where the path crosses its
ray to the right and subtracted where the path crosses it to the left (Bhattacharya, Likhachev and
Kumar, "Topological constraints in search-based robot path planning", 2012). Two paths with the
same ends have the same signature when the loop that both make winds around no island, and
different signatures when it winds around one: then neither can be deformed into the other.

The numbers of islands are random integers of 64 bits, added modulo 2^64, so that one integer holds
the windings around all islands: two classes have the same signature with a probability of 2^-64.
Points are in the kernel frame, of two dimensions. Without islands every path has the signature 0,
and may pass any obstacle on any side.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
import numpy as np
from numpy.typing import NDArray


class Islands(NamedTuple):
    """
    One point in each island, ordered from left to right.

    Attributes
    ----------
    x, y : (k,)
        Coordinates of the points in the kernel frame of their space (``Space.to_kernel``).
    numbers : (k,) int64
        Number of each island. It is added to the signature of a path that crosses, to the right,
        the ray that goes up from the island's point, and subtracted for a crossing to the left.

    """

    x: Floats
    y: Floats
    numbers: NDArray[np.int64]


def islands_at(points: Floats) -> Islands:
    """Return the islands at ``points`` (k, 2), kernel frame, one point in each island."""
    x, y = points[np.argsort(points[:, 0], kind='stable')].T
    words = np.random.default_rng(0).integers(-(2**63), 2**63, len(points))
    return Islands(x.copy(), y.copy(), words)


#: No islands: paths may pass obstacles on any side.
NO_ISLANDS = islands_at(np.empty((0, 2)))


@kernel
def crossings(islands, a, b):
    """Return the signature (int64) of the segment from ``a`` to ``b`` (2,), kernel frame."""
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
