"""
Repeated runs: how short the best path of several runs is (paper, Section 1).

The paper grants that RRT, run repeatedly, often gives competitive solutions. Each planner runs
several times on one request, on maps of floors; the best path of the first k runs, as found and
shortened, is compared with the shortest path, which is known exactly.
"""

from typing import NamedTuple

from hnr_planner.core import plan, Polyanya, simplify
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, LOOKS, new_figure, style
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.experiments.safety import FLOORS, space_of
from matplotlib.figure import Figure
import numpy as np

ALGORITHMS = ('rrt', 'hit_and_run', 'auto')
#: Numbers of runs of which the best path counts.
REPEATS = (1, 2, 4, 8, 16)
SHAPES = ('found', 'shortened')


class Case(NamedTuple):
    """A case: name of a generated floor, and planner."""

    place: str
    algorithm: str


def cases() -> list[Case]:
    """Return every planner on every floor."""
    return [Case(place, algorithm) for place in FLOORS for algorithm in ALGORITHMS]


def run(case: Case, seed: int) -> dict[str, float]:
    """
    Run a planner ``REPEATS[-1]`` times on one request between two distant points.

    Return the length of the best path of the first k runs over that of the shortest path, as
    found and shortened, for each k of ``REPEATS``.
    """
    space = space_of(case.place)
    (ends,) = far_pairs(space, 1, seed)
    shortest = plan(space, *ends, algorithm=Polyanya(), time_limit=np.inf).length
    ratios = []
    for repeat in range(REPEATS[-1]):
        own = seed * REPEATS[-1] + repeat
        found = plan(
            space, *ends, algorithm=case.algorithm, seed=own, time_limit=np.inf, simplify=False
        )
        shortened = simplify(space, found.path, seed=own)
        lengths = found.length, float(np.hypot(*np.diff(shortened, axis=0).T).sum())
        ratios.append([length / shortest for length in lengths])
    best = np.minimum.accumulate(ratios)
    return {
        f'{shape}_{k}': float(best[k - 1, column])
        for column, shape in enumerate(SHAPES)
        for k in REPEATS
    }


def figure(results: Results) -> Figure:
    """Draw the best length over the shortest against the number of runs, for both shapes."""
    drawn = new_figure(9.0, 3.6)
    for axes, shape in zip(drawn.subplots(1, 2), SHAPES, strict=True):
        for algorithm in ALGORITHMS:
            chosen = results.where(algorithm=algorithm)
            means = [chosen.mean(f'{shape}_{k}') for k in REPEATS]
            draw_profile(axes, REPEATS, means, LOOKS[algorithm])
        axes.set_xscale('log', base=2)
        axes.set_xticks(REPEATS, [str(k) for k in REPEATS])
        title = 'Paths as found' if shape == 'found' else 'Shortened'
        style(axes, title, 'number of runs', 'best length / shortest')
        if shape == 'found':
            axes.set_yscale('log')
    legend(drawn.axes[0], 'upper right')
    return drawn


def tables(results: Results) -> str:
    """Return the tables of the best length over the shortest, as found and shortened."""
    text = 'Length of the best path of so many runs over that of the shortest path.\n'
    return '\n'.join([text, *(_table(results, shape) for shape in SHAPES)])


def _table(results: Results, shape: str) -> str:
    rows = [
        [LOOKS[algorithm].label]
        + [str(results.where(algorithm=algorithm).mean(f'{shape}_{k}')) for k in REPEATS]
        for algorithm in ALGORITHMS
    ]
    return markdown([shape, *(f'{k} run' if k == 1 else f'{k} runs' for k in REPEATS)], rows)


EXPERIMENT = Experiment(
    EXPERIMENTS['restarts'],
    runs=30,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
