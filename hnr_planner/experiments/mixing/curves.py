"""Total variation against steps for all walks, in sets in the plane."""

import math

from hnr_planner.core import BallWalk, HitAndRunWalk
from hnr_planner.core.sampling.walks import Walk
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.figures import draw_profile, Look, LOOKS, style
from hnr_planner.experiments.mixing.variation import (
    between,
    CHECKPOINTS,
    format_steps,
    MIXED,
    steps,
)
from hnr_planner.experiments.results import markdown, Results
from matplotlib.axes import Axes
import numpy as np

#: The walks by their names in the results, and the names of the ball walks.
WALKS = {
    'hit_and_run': LOOKS['hit_and_run'],
    'ball_walk': Look('ball walk, segment visible', '#E69F00', '^'),
    'end_point': Look('ball walk, end point only', '#CC79A7', 's'),
}
BALL_WALKS = ('ball_walk', 'end_point')
#: Smallest radius of the ball walks in a set [m]. Each version runs with ``TIMES`` that radius;
#: the one that mixes first is shown.
RADII = {
    **dict.fromkeys(('L', 'star', 'door 0.05', 'door 0.1', 'door 0.2', 'door 0.4'), 0.6),
    'spiral 6': 0.8,
}
TIMES = (1, 2, 4, 8)
#: Checkpoints that are drawn: from 8 on every doubling of the steps, which is where chains stop.
DRAWN = (*CHECKPOINTS[:4], CHECKPOINTS[5], *CHECKPOINTS[7::4])
#: Sets whose curves are drawn, and the titles of their panels.
PANELS = {
    'L': 'L, arms 1 m wide',
    'star': 'Star of five rays',
    'spiral 6': 'Spiral, corridor 1.2 m wide',
    'door 0.4': 'Two rooms, door 0.4 m wide',
    'door 0.1': 'Two rooms, door 0.1 m wide',
    'door 0.05': 'Two rooms, door 0.05 m wide',
}


def make_walk(name: str, radius: float) -> Walk:
    """Return the walk of a name in ``WALKS``; Hit-and-Run ignores the radius [m]."""
    if name == 'hit_and_run':
        return HitAndRunWalk()
    return BallWalk(radius, segment_visible=name == 'ball_walk')


def best(results: Results) -> Results:
    """Return the rows of one radius: that with the fewest steps to mix, by the upper estimate."""

    def last(rows: Results) -> float:
        value = steps(rows)[1].value
        return value if math.isfinite(value) else math.inf

    return min((results.where(radius=radius) for radius in results.distinct('radius')), key=last)


def draw_curves(axes: Axes, results: Results, name: str) -> None:
    """Draw the total variation of each walk in the set ``name``, between its two estimates."""
    for walk, look in WALKS.items():
        rows = best(results.where(shape=name, walk=walk))
        drawn = [k for k in DRAWN if np.isfinite(rows[f'above_{k}']).all()]
        means = [between(rows.mean(f'below_{k}'), rows.mean(f'above_{k}')) for k in drawn]
        draw_profile(axes, drawn, means, look)
    floor = float(rows['floor'][0])
    for level, line, label in ((MIXED, '-', f'{MIXED}: mixed'), (floor, ':', 'floor')):
        axes.axhline(level, color=FAINT_INK, linewidth=1.0, linestyle=line, label=label)
    axes.set(xscale='log', ylim=(0.0, 1.0), yticks=(0.0, 0.5, 1.0))
    axes.minorticks_off()
    style(axes, PANELS[name], 'steps', 'total variation')


def curves_table(results: Results) -> str:
    """Return a table of the mixing steps of each walk, the ball walks with their best radius."""
    header = ['set', WALKS['hit_and_run'].label]
    for walk in BALL_WALKS:
        header += [WALKS[walk].label, 'its radius [m]']
    rows = []
    for name in RADII:
        here = results.where(shape=name)
        row: list[object] = [name, format_steps(here.where(walk='hit_and_run'))]
        for walk in BALL_WALKS:
            chosen = best(here.where(walk=walk))
            row += [format_steps(chosen), chosen['radius'][0]]
        rows.append([*row, f'{here.mean("floor").value:.3f}'])
    return markdown([*header, 'floor'], rows)


def radii_table(results: Results) -> str:
    """Return a table of the ball walks' mixing steps for each radius, by the upper estimate."""
    rows = []
    for name, least in RADII.items():
        for walk in BALL_WALKS:
            chosen = results.where(shape=name, walk=walk)
            each = [steps(chosen.where(radius=times * least))[1] for times in TIMES]
            rows.append([f'{name}, {WALKS[walk].label}', least, *each])
    header = ['set, walk', 'least radius [m]', *(f'{times} x' for times in TIMES)]
    return markdown(header, rows)
