"""What a step of the walk costs in a union of many boxes."""

from __future__ import annotations

from collections.abc import Iterable
from statistics import median
import time

from benchmarks.sections import table, Verdict
from hnr_planner.core import BoxSpace, sample, UnionSpace
import numpy as np

#: Numbers of boxes to compare, and target: the time of a step in many over one in few.
FEW, MANY, AT_MOST = 20, 200, 2.0
DIM, STEPS, TURNS = 10, 20_000, 5


def corridor(n_boxes: int) -> UnionSpace:
    """Return rooms that abut, each beside the one before in a random direction."""
    rng = np.random.default_rng(0)
    lower, upper = np.zeros(DIM), np.ones(DIM)
    rooms = [BoxSpace(lower, upper)]
    for _ in range(n_boxes - 1):
        lower, upper, axis = lower.copy(), upper.copy(), rng.integers(DIM)
        lower[axis] = upper[axis]
        upper[axis] += rng.uniform(0.6, 1.4)
        rooms.append(BoxSpace(lower, upper))
    return UnionSpace(*rooms)


def crowd(n_boxes: int) -> UnionSpace:
    """Return boxes that overlap, each around a point near the one before."""
    rng = np.random.default_rng(1)
    centre, boxes = np.full(DIM, 0.5), []
    for _ in range(n_boxes):
        half = rng.uniform(0.3, 0.6, DIM)
        boxes.append(BoxSpace(centre - half, centre + half))
        centre = centre + rng.normal(0.0, 0.2, DIM)
    return UnionSpace(*boxes)


def seconds_of_a_step(spaces: Iterable[UnionSpace]) -> list[float]:
    """Return the processor time [s] of a step in each space: medians of turns."""
    taken: list[list[float]] = []
    for space in spaces:
        sample(space, np.full(DIM, 0.5), 10, seed=0, n_jobs=1)
        taken.append([])
    for turn in range(TURNS):
        for own, space in zip(taken, spaces, strict=True):
            began = time.process_time()
            sample(space, np.full(DIM, 0.5), STEPS, seed=turn, n_jobs=1)
            own.append((time.process_time() - began) / STEPS)
    return [median(own) for own in taken]


def many_boxes() -> tuple[str, list[Verdict]]:
    """Return a table of the time of a step, and the verdicts."""
    rows, verdicts = [], []
    for name, make in (('rooms that abut', corridor), ('boxes that overlap', crowd)):
        few, many = seconds_of_a_step([make(FEW), make(MANY)])
        rows.append([name, f'{1e9 * few:.0f}', f'{1e9 * many:.0f}', f'{many / few:.2f}'])
        what = f'step in a {DIM}-D union of {MANY} {name}, against {FEW}'
        measured = f'{many / few:.2f} x'
        verdicts.append(Verdict(what, f'{AT_MOST:g} x', measured, many <= AT_MOST * few))
    head = f'union in {DIM} dimensions | {FEW} boxes [ns] | {MANY} boxes [ns] | ratio'
    return table(head, rows), verdicts
