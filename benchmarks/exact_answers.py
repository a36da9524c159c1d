"""
Part of the section on shortest paths: what the answers of ``auto`` prove, and when.

Times are those of the processor, so that other processes count less.
"""

from __future__ import annotations

import time
from typing import Any, NamedTuple

from benchmarks.problems import Floats
from benchmarks.sections import milliseconds, table, Verdict
from hnr_planner.core import GridSpace, plan
import numpy as np

#: Seconds that a node optimizes for by default, and within which its answer is to be proved.
OPTIMIZE_FOR, PROVED_WITHIN = 0.02, 0.025
#: Fraction of answers to be proved within that time, on these maps.
FRACTION, MAPS = 0.99, ('office', 'depot', 'intel-lab')
#: Side of the noisy map [cells], its fraction of blocked cells, and requests on it.
SIDE, BLOCKED, NOISY_REQUESTS = 4000, 0.3, 10
#: Target for the first path on the noisy map [s], and the limit within which it is improved [s].
FIRST_WITHIN, NOISY_LIMIT = 0.02, 1.0
#: Length over lower bound up to which a path counts as proved to be the shortest.
PROVED = 1.0 + 1e-6


class Answers(NamedTuple):
    """
    Answers of ``auto`` on one map.

    ``seconds`` are times [s] of whole calls, ``first`` those until the first path, and ``ratios``
    the lengths over the lower bounds.
    """

    name: str
    seconds: Floats
    first: Floats
    ratios: Floats

    @property
    def in_time(self) -> float:
        """Fraction of the answers that are proved within ``PROVED_WITHIN``."""
        return float(np.mean((self.ratios <= PROVED) & (self.seconds <= PROVED_WITHIN)))


def default_answers(name: str, space: GridSpace, ends: Floats) -> Answers:
    """Measure the answers that a node gives by default, between ``ends`` (k, 2, 2) [m]."""
    return _answers(name, space, ends, optimize_for=OPTIMIZE_FOR)


def noisy_answers(random_ends: Any) -> Answers:
    """Measure answers on a map of noise; ``random_ends(space, n)`` gives ends (n, 2, 2) [m]."""
    blocked = np.random.default_rng(0).random((SIDE, SIDE)) < BLOCKED
    space = GridSpace.from_blocked(blocked)
    ends = random_ends(space, NOISY_REQUESTS)
    _ = space.slabs
    return _answers(f'noise {SIDE}', space, ends, optimize_for=NOISY_LIMIT, time_limit=NOISY_LIMIT)


def _answers(name: str, space: GridSpace, ends: Floats, **limits: float) -> Answers:
    seconds, first, ratios = [], [], []
    plan(space, *ends[0], seed=0, **limits)
    for k, (start, goal) in enumerate(ends):
        began = time.process_time()
        result = plan(space, start, goal, seed=k, **limits)
        seconds.append(time.process_time() - began)
        found = result.first_solution
        first.append(np.inf if found is None else found.elapsed)
        ratios.append(result.length / result.lower_bound)
    return Answers(name, np.array(seconds), np.array(first), np.array(ratios))


def answers_table(rows: list[Answers]) -> str:
    """Return the table of all answers."""
    head = (
        f'answers of `auto` | first path | whole call | p99 | within {PROVED_WITHIN:g} s | proved'
    )
    return table(
        f'{head} | worst length over bound',
        (
            [
                row.name,
                milliseconds(float(np.median(row.first))),
                milliseconds(float(np.median(row.seconds))),
                milliseconds(float(np.quantile(row.seconds, 0.99))),
                f'{100.0 * row.in_time:.3g} %',
                f'{np.count_nonzero(row.ratios <= PROVED)} of {len(row.ratios)}',
                f'{row.ratios.max():.4g}',
            ]
            for row in rows
        ),
    )


def answers_verdicts(rows: list[Answers]) -> list[Verdict]:
    """Return the verdicts on the answers."""
    verdicts = []
    for row in rows:
        if row.name in MAPS:
            what = f'default answers on {row.name} proved within {1e3 * PROVED_WITHIN:g} ms'
            measured, wanted = f'{100.0 * row.in_time:.3g} %', f'{100.0 * FRACTION:g} %'
            verdicts.append(Verdict(what, wanted, measured, row.in_time >= FRACTION))
        elif row.name.startswith('noise'):
            first = float(np.median(row.first))
            what = f'first path on {row.name} [ms], median; every answer has a bound'
            met = first <= FIRST_WITHIN and bool(np.isfinite(row.ratios).all())
            verdicts.append(Verdict(what, f'{1e3 * FIRST_WITHIN:g}', milliseconds(first), met))
    return verdicts
