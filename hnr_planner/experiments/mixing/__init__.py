"""
Mixing time of random walks: steps until the start is forgotten (paper, Theorem 5: order n^6).

Many chains of a walk start at one end of a set: at a single point, or for one of the solids
uniformly in one half. The total variation distance between the distribution of the chains and the
uniform distribution is measured after a growing number of steps, until it is below 0.1:

- in sets in the plane, for Hit-and-Run and both ball walks (``curves``);
- in sets of 2 to 30 dimensions, for Hit-and-Run, beside the paper's bound (``dimension``).

In the plane the mixed chains of Hit-and-Run continue, to measure the relaxation time, which is
compared with the conductance (``relaxation``).
"""

import math
from typing import Any, NamedTuple

from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import legend, new_figure
from hnr_planner.experiments.mixing.curves import (
    BALL_WALKS,
    curves_table,
    draw_curves,
    make_walk,
    PANELS,
    RADII,
    radii_table,
    TIMES,
)
from hnr_planner.experiments.mixing.dimension import (
    DIMENSIONS,
    dimensions_table,
    draw_dimensions,
)
from hnr_planner.experiments.mixing.relaxation import draw_relaxation, measured, relaxation_table
from hnr_planner.experiments.mixing.sets import planar_sets
from hnr_planner.experiments.mixing.solids import solid, SOLIDS
from hnr_planner.experiments.mixing.variation import columns, run_until_mixed
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.results import Results
from matplotlib.figure import Figure

#: Panels of the figure: three curves in a row, and two wider panels below.
LAYOUT: list[Any] = [[name for name in list(PANELS)[k:][:3] for _ in range(2)] for k in (0, 3)]
LAYOUT.append(3 * ['relaxation'] + 3 * ['dimension'])


class Case(NamedTuple):
    """A case: name and dimension of a set, a walk, and its radius [m], 0 for Hit-and-Run."""

    shape: str
    dim: int
    walk: str
    radius: float


def cases() -> list[Case]:
    """
    Return the sets in the plane and the solids with Hit-and-Run, and the sets with ball walks.

    Ball walks run in the sets of ``RADII`` only, with every radius.
    """
    planar = [Case(name, 2, 'hit_and_run', 0.0) for name in planar_sets()]
    balls = [
        Case(name, 2, walk, times * least)
        for name, least in RADII.items()
        for walk in BALL_WALKS
        for times in TIMES
    ]
    return [
        *planar,
        *balls,
        *(Case(name, dim, 'hit_and_run', 0.0) for name in SOLIDS for dim in DIMENSIONS),
    ]


def run(case: Case, seed: int) -> dict[str, float]:
    """
    Run chains until they are mixed; return the distances on the way and the relaxation time.

    The relaxation time [steps] is measured for Hit-and-Run in the plane only, else nan.
    """
    if case.shape in SOLIDS:
        mixing_set = solid(case.shape, case.dim)
    else:
        mixing_set = planar_sets()[case.shape]
    distances, chains = run_until_mixed(mixing_set, make_walk(case.walk, case.radius), seed)
    timed = case.shape in planar_sets() and case.walk == 'hit_and_run'
    relaxation = measured(case.shape, chains) if timed else math.nan
    return {'relaxation': relaxation, **columns(distances)}


def figure(results: Results) -> Figure:
    """Draw total variation against steps, relaxation times, and steps against dimension."""
    drawn = new_figure(10.0, 11.0)
    axes = drawn.subplot_mosaic(LAYOUT, height_ratios=(1, 1, 1.5))
    for k, name in enumerate(PANELS):
        axes[name].sharex(axes['L'])
        draw_curves(axes[name], results, name)
        axes[name].tick_params(labelleft=k % 3 == 0, labelbottom=k >= 3)
        axes[name].set_ylabel('total variation' if k % 3 == 0 else '')
        axes[name].set_xlabel('steps' if k >= 3 else '')
    legend(axes['star'], 'upper right')
    draw_relaxation(axes['relaxation'], results)
    draw_dimensions(axes['dimension'], results)
    return drawn


def tables(results: Results) -> str:
    """Return the tables of mixing steps, ball radii, relaxation times and dimensions."""
    return '\n'.join(
        [
            'Steps until the total variation is below .1, by the estimates from below and from '
            'above.\n',
            curves_table(results),
            'The ball walks with each radius, by the estimate from above.\n',
            radii_table(results),
            'Relaxation time [steps] of Hit-and-Run, and conductance \u03a6 of the best cut.\n',
            relaxation_table(results),
            'Steps of Hit-and-Run until the total variation is below .1.\n',
            dimensions_table(results),
        ]
    )


EXPERIMENT = Experiment(
    EXPERIMENTS['mixing'],
    runs=10,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
