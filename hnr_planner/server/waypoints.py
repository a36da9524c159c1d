"""A path through several poses: one search for each leg, joined to one result."""

from collections.abc import Sequence
from dataclasses import replace
import itertools

from hnr_planner.core.planning.result import SearchResult
import numpy as np


def joined(results: Sequence[SearchResult]) -> SearchResult:
    """
    Return the results of solved legs as one; each begins where the one before it ended.

    Path and samples follow each other, with parents that refer to the rows as they are then, and
    what was counted is summed. The seed is that of the first leg, all had the same or none.
    """
    first, *others = results
    if not others:
        return first
    offsets = itertools.accumulate((len(result.samples) for result in results), initial=0)
    parents = [
        np.where(result.parents < 0, result.parents, result.parents + offset)
        for result, offset in zip(results, offsets, strict=False)
    ]
    path = np.vstack([first.path, *(result.path[1:] for result in others)])
    length = sum(result.length for result in results)
    return replace(
        first,
        message=f'path of {length:.6g} m through {len(others)} poses on the way',
        path=path,
        length=length,
        samples=np.vstack([result.samples for result in results]),
        parents=np.concatenate(parents),
        iterations=sum(result.iterations for result in results),
        elapsed=sum(result.elapsed for result in results),
        cut_by_time=any(result.cut_by_time for result in results),
        first_solution=None,
    )
