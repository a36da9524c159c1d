"""Parts of search trees, with a bounded number of samples, small enough to be shown."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class TreeSubsample(NamedTuple):
    """
    A part of a search tree that contains the parent of each of its samples.

    Parameters
    ----------
    rows : (n,) int
        Rows of the kept samples among all samples of the search, ascending.
    parents : (n,) int
        Index in ``rows`` of the parent of each kept sample; -1 for a root.

    """

    rows: NDArray[np.intp]
    parents: NDArray[np.int32]


def subsample_tree(parents: NDArray[np.integer], limit: int) -> TreeSubsample:
    """
    Return a part of a tree with at most ``limit`` samples, and the ancestors of each of them.

    All samples are kept if they are no more than ``limit``. Else the last sample, where a search
    ends, is kept with its ancestors unless they are more than ``limit``; then the earliest other
    samples are kept, up to ``limit`` in all.

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
    # The first rows contain all their ancestors, and so does a branch: so do both together.
    others = np.flatnonzero(~kept)[: limit - len(branch)]
    kept[others] = True
    rows = np.flatnonzero(kept)
    new_row = np.full(count + 1, -1, dtype=np.int32)  # the last entry stands for parent -1
    new_row[rows] = np.arange(len(rows), dtype=np.int32)
    return TreeSubsample(rows, new_row[parents[rows]])


def _branch(parents: NDArray[np.integer], leaf: int, limit: int) -> list[int]:
    """Return the rows from ``leaf`` up to its root; an empty list if more than ``limit``."""
    branch: list[int] = []
    row = leaf
    while row >= 0:
        branch.append(row)
        if len(branch) > limit:
            return []
        row = int(parents[row])
    return branch
