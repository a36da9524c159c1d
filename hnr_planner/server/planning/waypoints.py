"""
Paths through several poses, joined from the results of their legs.

A leg is the search from one pose to the next.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
import itertools

from hnr_planner.core import PlanResult
import numpy as np


def joined(results: Sequence[PlanResult]) -> PlanResult:
    """
    Return the results of solved legs as one result; a single one is returned as it is.

    Each leg has to begin where the leg before it ended: that point is in the path once. Paths,
    twists and samples are concatenated in the order of the legs, and parents are renumbered to the
    rows of the concatenated samples (-1 stays). Lengths, lower bounds, times, iterations and
    counts are summed; the planners of all legs are named, each once. ``cut_by_time`` is true when
    it is for any leg, the goal offset is that of the last leg, and there are no first solution and
    no alternatives. What is not named here, such as the seed, is that of the first leg.
    """
    first, *others = results
    if not others:
        return first
    offsets = itertools.accumulate((len(result.samples) for result in results), initial=0)
    parents = [
        np.where(result.parents < 0, result.parents, result.parents + offset)
        for result, offset in zip(results, offsets, strict=False)
    ]
    twists = [result.twists for result in results if result.twists is not None]
    counts: Counter[str] = Counter()
    for result in results:
        counts.update(result.counts)
    return replace(
        first,
        planner=', '.join(dict.fromkeys(result.planner for result in results)),
        message=f'path through {len(others)} poses on the way',
        others=(),
        path=np.vstack([first.path, *(result.path[1:] for result in others)]),
        twists=None if not twists else np.vstack(twists),
        length=sum(result.length for result in results),
        lower_bound=sum(result.lower_bound for result in results),
        clear_lower_bound=sum(result.clear_lower_bound for result in results),
        next_lower_bound=0.0,
        samples=np.vstack([result.samples for result in results]),
        parents=np.concatenate(parents),
        iterations=sum(result.iterations for result in results),
        counts=dict(counts),
        elapsed=sum(result.elapsed for result in results),
        cut_by_time=any(result.cut_by_time for result in results),
        first_solution=None,
        goal_offset=results[-1].goal_offset,
    )
