"""
Total variation distance of many chains from the uniform distribution, as their steps grow.

Two estimates bracket the distance. The estimate from above is the distance of the observed
fractions of chains in the cells from the cells' fractions of the volume. It is biased upwards, by
about a known floor. The cross-fitted estimate, in which one half of the chains selects
the overfull cells and the other half measures their excess, is biased downwards.
"""

from collections.abc import Sequence
from itertools import accumulate
import math
from typing import NamedTuple

from hnr_planner.core import begin_chains, Chains, total_variation, TotalVariation, walk_on
from hnr_planner.core.sampling.walks import Walk
from hnr_planner.experiments.mixing.sets import MixingSet
from hnr_planner.experiments.results import Mean, Results
import numpy as np

#: Total variation below which chains count as mixed.
MIXED = 0.1
#: Numbers of checkpoints, and steps between them: after each of eight steps, then four checkpoints
#: for every doubling of the steps.
STRIDES = ((8, 1), *((4, 2**k) for k in range(1, 14)))
#: Numbers of steps after which the distance is measured.
CHECKPOINTS = tuple(accumulate(stride for n_checks, stride in STRIDES for _ in range(n_checks)))


class MixingRun(NamedTuple):
    """Distances at the ``CHECKPOINTS`` that were reached, and the chains after the last one."""

    distances: Sequence[TotalVariation]
    chains: Chains


def run_until_mixed(mixing_set: MixingSet, walk: Walk, seed: int) -> MixingRun:
    """
    Run chains of a walk from their starts until they are mixed, or until the last checkpoint.

    They count as mixed once the estimate from above is below ``MIXED`` at the end of one of the
    ``STRIDES``.
    """
    space, shares, n_chains = mixing_set.space, mixing_set.shares, mixing_set.n_chains
    starts = mixing_set.starts(n_chains, np.random.default_rng(seed))
    chains = begin_chains(space, starts, n_chains=n_chains, seed=seed)
    distances: list[TotalVariation] = []
    for n_checks, stride in STRIDES:
        draws, chains = walk_on(space, chains, n_checks, walk=walk, thin=stride)
        for k in range(n_checks):
            distances.append(total_variation(mixing_set.cells(draws[:, k]), shares))
        if distances[-1].plug_in < MIXED:
            break
    return MixingRun(distances, chains)


def columns(distances: Sequence[TotalVariation]) -> dict[str, float]:
    """
    Return the distances as columns of the results: nan at checkpoints that were not reached.

    ``first`` and ``last`` are the steps until the estimates from below and from above are below
    ``MIXED``.
    """
    below = [distance.lower_bound for distance in distances]
    above = [distance.plug_in for distance in distances]
    missing = [math.nan] * (len(CHECKPOINTS) - len(distances))
    return {
        'floor': distances[0].floor,
        'first': steps_to_mix(below),
        'last': steps_to_mix(above),
        **{f'below_{steps}': d for steps, d in zip(CHECKPOINTS, below + missing, strict=True)},
        **{f'above_{steps}': d for steps, d in zip(CHECKPOINTS, above + missing, strict=True)},
    }


def steps_to_mix(distances: Sequence[float]) -> float:
    """
    Return the steps at which distances at the ``CHECKPOINTS`` first fall below ``MIXED``.

    Steps between two checkpoints are interpolated linearly; nan if no distance is below.
    """
    mixed = np.flatnonzero(np.array(distances) < MIXED)
    if len(mixed) == 0:
        return math.nan
    k = int(mixed[0])
    if k == 0:
        return float(CHECKPOINTS[0])
    fraction = (distances[k - 1] - MIXED) / (distances[k - 1] - distances[k])
    return CHECKPOINTS[k - 1] + fraction * (CHECKPOINTS[k] - CHECKPOINTS[k - 1])


def between(first: Mean, last: Mean) -> Mean:
    """Return the middle and half the width of the range of two estimates with their intervals."""
    low = first.value - np.nan_to_num(first.half)
    high = last.value + np.nan_to_num(last.half)
    return Mean((low + high) / 2.0, (high - low) / 2.0)


def steps(results: Results) -> tuple[Mean, Mean]:
    """Return the mean mixing steps by both estimates; both nan if any run did not mix."""
    if np.isnan(results['last']).any():
        return Mean(math.nan, math.nan), Mean(math.nan, math.nan)
    return results.mean('first'), results.mean('last')


def format_steps(results: Results) -> str:
    """Return the mean mixing steps by both estimates, as text for a table."""
    return ' to '.join(map(str, steps(results)))
