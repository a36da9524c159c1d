"""A part of a search tree that is small enough to be shown."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class TreeSubsample(NamedTuple):
    """Rows (n,) of the samples that are kept, ascending, and each one's parent among the kept."""

    rows: NDArray[np.intp]
    parents: NDArray[np.int32]


def subsample_tree(parents: NDArray[np.integer], limit: int) -> TreeSubsample:
    """
    Return at most ``limit`` samples, every one with all of its ancestors.

    The branch that ends in the last sample, where a search ends, is kept if it fits; the
    earliest samples fill what is left.

    Parameters
    ----------
    parents : (k,) int
        Row of each sample's parent, always an earlier row; -1 for a root.
    limit : int
        Most samples to keep, at least 0.

    """
    count = len(parents)
    if count <= limit:
        return TreeSubsample(np.arange(count), parents.astype(np.int32))
    branch = _branch(parents, count - 1, limit)
    kept = np.zeros(count, dtype=bool)
    kept[branch] = True
    # The first rows are closed under ancestors, and so is a branch, and so are both together.
    others = np.flatnonzero(~kept)[: limit - len(branch)]
    kept[others] = True
    rows = np.flatnonzero(kept)
    new_row = np.full(count + 1, -1, dtype=np.int32)  # the last entry stands for parent -1
    new_row[rows] = np.arange(len(rows), dtype=np.int32)
    return TreeSubsample(rows, new_row[parents[rows]])


def _branch(parents: NDArray[np.integer], leaf: int, limit: int) -> list[int]:
    """Return ``leaf`` and its ancestors, or nothing when they are more than ``limit``."""
    branch: list[int] = []
    row = leaf
    while row >= 0:
        branch.append(row)
        if len(branch) > limit:
            return []
        row = int(parents[row])
    return branch
