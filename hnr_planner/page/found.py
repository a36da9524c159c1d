"""The path as a search found it, before anything made it shorter: read off its samples."""

from hnr_planner.core import PlanResult
from hnr_planner.core.lengths import path_length
from hnr_planner.core.trees import branch
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: How far two lengths of one path may be apart, as a part of them: the same sum, rounded.
ROUNDING = 1e-9


def found_path(result: PlanResult, goal: ArrayLike, goal_radius: float) -> NDArray[np.float64]:
    """
    Return the path along the samples that a result shows.

    The branch of the last sample is a part of it. With a tree at each end, that sample sees one of
    the other tree, and the length of the first solution tells which. But after several searches
    the first solution may be that of another one; then the path is not known.

    Parameters
    ----------
    result : PlanResult
        The answer to a request without a system.
    goal : (dim,)
        The goal asked for.
    goal_radius : float
        Radius of the goal region; 0 when the path ends exactly at the goal.

    Returns
    -------
    (m, dim)
        From the start to the goal; (0, dim) when there is no such path, or it is not known.

    """
    samples, parents, first = result.samples, result.parents, result.first_solution
    if first is None:
        return samples[:0]
    newest = branch(samples, parents, len(samples) - 1)
    if np.count_nonzero(parents < 0) == 1:
        return newest if goal_radius > 0.0 else np.vstack([newest, goal])
    roots = _roots(parents)
    met = (branch(samples, parents, k) for k in np.flatnonzero(roots != roots[-1]))
    ways = [newest, *(np.vstack([newest, other[::-1]]) for other in met)]
    best = min(ways, key=lambda way: abs(path_length(way) - first.length))
    if abs(path_length(best) - first.length) > ROUNDING * first.length:
        return samples[:0]
    return best if np.array_equal(best[0], samples[0]) else best[::-1]


def _roots(parents: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the row (k,) of each sample's root; a parent comes before its children."""
    roots = np.arange(len(parents))
    for k in np.flatnonzero(parents >= 0):
        roots[k] = roots[parents[k]]
    return roots
