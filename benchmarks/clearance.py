"""Measure what clearance costs: length against least and mean clearance."""

from __future__ import annotations

from collections.abc import Iterator
import time
from typing import NamedTuple

from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from benchmarks.sections import Bench, Section, table
from hnr_planner.core import GridSpace, plan
import numpy as np

#: Clearances [m], and seeds that each request is answered with.
CLEARANCES, SEEDS = (0.0, 0.1, 0.25, 0.5, 1.0), 5
EXPLAINED = """\
Each row is a mean over the same requests and seeds, with `plan(..., clearance=...)`: length over
that of the path without clearance, the least and the mean distance to the occupied cells along the
path [m], the mean of what the path has of the distance asked for, and the median time of the call
[ms]. The least distance is often that of a door, or of the start or the goal themselves. Distances
are the robot's centre's: with a radius of .22 m a clearance of .1 m is kept by every path.
"""


class Trade(NamedTuple):
    """Results for one requested clearance on one map."""

    problem: str
    clearance: float
    length: float
    least: float
    mean: float
    kept: float
    seconds: float


def trades(chosen: list[Problem]) -> Iterator[Trade]:
    """Measure all clearances on every map."""
    for problem in chosen:
        runs = np.array(
            [
                [_run(problem.space, ends, seed, clearance) for clearance in CLEARANCES]
                for ends in problem.requests
                for seed in range(SEEDS)
            ]
        )
        lengths = runs[:, :, 0] / runs[:, :1, 0]
        for k, clearance in enumerate(CLEARANCES):
            least, mean, kept = runs[:, k, 1:4].mean(axis=0)
            seconds = float(np.median(runs[:, k, 4]))
            yield Trade(problem.name, clearance, lengths[:, k].mean(), least, mean, kept, seconds)


def _run(space: GridSpace, ends: Floats, seed: int, clearance: float) -> list[float]:
    """Return length, least, mean and kept clearance [m], and the time [s] of one request."""
    began = time.perf_counter()
    path = plan(space, *ends, seed=seed, clearance=clearance).path
    seconds = time.perf_counter() - began
    along = _points_along(path, space.resolution)
    distances = space.clearance(along)
    kept = np.minimum(distances / clearance, 1.0).mean() if clearance else 1.0
    length = np.hypot(*np.diff(path, axis=0).T).sum()
    return [length, space.path_clearance(path), distances.mean(), kept, seconds]


def _points_along(path: Floats, spacing: float) -> Floats:
    """Return evenly spaced points (k, 2) on a path."""
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    points = np.arange(0.0, at[-1], spacing)
    return np.stack([np.interp(points, at, path[:, i]) for i in range(2)], axis=1)


def clearance(bench: Bench) -> Section:
    """Measure length against clearance on every map of a building."""
    rows = []
    for trade in trades([problem for problem in bench.problems if not problem.is_spiral]):
        show(f'clearance {trade.clearance:g} m on {trade.problem}')
        rows.append(
            [
                trade.problem,
                f'{trade.clearance:g}',
                *(f'{x:.3f}' for x in (trade.length, trade.least, trade.mean, trade.kept)),
                f'{1e3 * trade.seconds:.2f}',
            ]
        )
    body = table('map | clearance | length | least | mean | kept | time', rows)
    return Section('Length against clearance', f'{EXPLAINED}\n{body}')
