"""String pulling: remove vertices of a path that straight segments can skip."""

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import segment_is_free
import numpy as np


@kernel
def pull_string(grid, path):
    """
    Return a path (m, 2) without the vertices that free straight segments can skip.

    In order, a vertex is kept only if the segment from the last one kept to the next one is not
    free. Both ends are kept. Points are in the kernel frame of ``grid``.
    """
    kept = np.empty_like(path)
    kept[0] = path[0]
    n_kept = 1
    for k in range(2, len(path)):
        if not segment_is_free(grid, kept[n_kept - 1], path[k]):
            kept[n_kept] = path[k - 1]
            n_kept += 1
    kept[n_kept] = path[-1]
    return kept[: n_kept + 1]
