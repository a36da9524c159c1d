"""
How the law of many chains comes near the uniform one.

The distance between the two lies between two estimates. Counting the chains in the cells is
biased upwards, by a known floor at most, or little more; letting one half of the chains choose
the cells that are too full, and the other half say how full they are, is biased downwards.
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

#: A set counts as mixed where the total variation is below this.
MIXED = 0.1
#: Looks, and steps between them: at first after every step, then four while the steps double.
STRIDES = ((8, 1), *((4, 2**k) for k in range(1, 14)))
#: Steps after which the chains are looked at.
SEEN_AT = tuple(accumulate(apart for n_looks, apart in STRIDES for _ in range(n_looks)))


class Approach(NamedTuple):
    """What was seen at each of ``SEEN_AT`` until a set was mixed, and the chains after that."""

    seen: Sequence[TotalVariation]
    chains: Chains


def approach(mixing_set: MixingSet, walk: Walk, seed: int) -> Approach:
    """Let chains walk from their start until they are mixed, or until the last look."""
    space, shares, n_chains = mixing_set.space, mixing_set.shares, mixing_set.n_chains
    starts = mixing_set.starts(n_chains, np.random.default_rng(seed))
    chains = begin_chains(space, starts, n_chains=n_chains, seed=seed)
    seen: list[TotalVariation] = []
    for n_looks, apart in STRIDES:
        draws, chains = walk_on(space, chains, n_looks, walk=walk, thin=apart)
        seen += [total_variation(mixing_set.cells(draws[:, k]), shares) for k in range(n_looks)]
        if seen[-1].plug_in < MIXED:
            break
    return Approach(seen, chains)


def columns(seen: Sequence[TotalVariation]) -> dict[str, float]:
    """
    Return what was seen as columns: nan after the last look.

    ``first`` and ``last`` are the steps until the estimates from below and from above fall below
    ``MIXED``.
    """
    below = [distance.lower_bound for distance in seen]
    above = [distance.plug_in for distance in seen]
    missing = [math.nan] * (len(SEEN_AT) - len(seen))
    return {
        'floor': seen[0].floor,
        'first': steps_to_mix(below),
        'last': steps_to_mix(above),
        **{f'below_{steps}': at for steps, at in zip(SEEN_AT, below + missing, strict=True)},
        **{f'above_{steps}': at for steps, at in zip(SEEN_AT, above + missing, strict=True)},
    }


def steps_to_mix(distances: Sequence[float]) -> float:
    """Return where distances at the looks fall below ``MIXED``, straight between looks, or nan."""
    mixed = np.flatnonzero(np.array(distances) < MIXED)
    if len(mixed) == 0:
        return math.nan
    k = int(mixed[0])
    if k == 0:
        return float(SEEN_AT[0])
    part = (distances[k - 1] - MIXED) / (distances[k - 1] - distances[k])
    return SEEN_AT[k - 1] + part * (SEEN_AT[k] - SEEN_AT[k - 1])


def between(first: Mean, last: Mean) -> Mean:
    """Return what lies between two estimates, with their intervals where there are some."""
    low = first.value - np.nan_to_num(first.half)
    high = last.value + np.nan_to_num(last.half)
    return Mean((low + high) / 2.0, (high - low) / 2.0)


def steps(results: Results) -> tuple[Mean, Mean]:
    """Return the steps until a set is mixed by both estimates; nan where a run did not mix."""
    if np.isnan(results['last']).any():
        return Mean(math.nan, math.nan), Mean(math.nan, math.nan)
    return results.mean('first'), results.mean('last')


def in_words(results: Results) -> str:
    """Return the steps until a set is mixed for a table."""
    return ' to '.join(map(str, steps(results)))
