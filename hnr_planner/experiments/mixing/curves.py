"""The walks beside each other: total variation against steps, in sets in the plane."""

import math

from hnr_planner.core import BallWalk, HitAndRunWalk
from hnr_planner.core.sampling.walks import Walk
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.figures import draw_profile, Look, LOOKS, style
from hnr_planner.experiments.mixing.variation import between, in_words, MIXED, SEEN_AT, steps
from hnr_planner.experiments.results import markdown, Results
from matplotlib.axes import Axes
import numpy as np

WALKS = {
    'hit_and_run': LOOKS['hit_and_run'],
    'ball_walk': Look('ball walk, segment visible', '#E69F00', '^'),
    'end_point': Look('ball walk, end point only', '#CC79A7', 's'),
}
BALL_WALKS = ('ball_walk', 'end_point')
#: The least radius of the ball walks in a set [m]; the others are so many times that. Each version
#: is shown with the radius that does best.
RADII = {
    **dict.fromkeys(('L', 'star', 'door 0.05', 'door 0.1', 'door 0.2', 'door 0.4'), 0.6),
    'spiral 6': 0.8,
}
TIMES = (1, 2, 4, 8)
#: Looks that are drawn: from 8 on every time the steps have doubled, which is when chains stop.
DRAWN = (*SEEN_AT[:4], SEEN_AT[5], *SEEN_AT[7::4])
#: The sets whose curves are drawn.
PANELS = {
    'L': 'L, arms 1 m wide',
    'star': 'Star of five rays',
    'spiral 6': 'Spiral, corridor 1.2 m wide',
    'door 0.4': 'Two rooms, door 0.4 m wide',
    'door 0.1': 'Two rooms, door 0.1 m wide',
    'door 0.05': 'Two rooms, door 0.05 m wide',
}


def make_walk(name: str, radius: float) -> Walk:
    """Return a walk; Hit-and-Run has no radius."""
    if name == 'hit_and_run':
        return HitAndRunWalk()
    return BallWalk(radius, segment_visible=name == 'ball_walk')


def best(results: Results) -> Results:
    """Return the rows of the radius with which a walk in a set mixes first."""

    def last(rows: Results) -> float:
        value = steps(rows)[1].value
        return value if math.isfinite(value) else math.inf

    return min((results.where(radius=radius) for radius in results.distinct('radius')), key=last)


def draw_curves(axes: Axes, results: Results, name: str) -> None:
    """Draw the total variation of each walk: bands reach from one estimate to the other."""
    for walk, look in WALKS.items():
        rows = best(results.where(shape=name, walk=walk))
        looks = [k for k in DRAWN if np.isfinite(rows[f'above_{k}']).all()]
        means = [between(rows.mean(f'below_{k}'), rows.mean(f'above_{k}')) for k in looks]
        draw_profile(axes, looks, means, look)
    floor = float(rows['floor'][0])
    for at, line, words in ((MIXED, '-', f'{MIXED}: mixed'), (floor, ':', 'floor')):
        axes.axhline(at, color=FAINT_INK, linewidth=1.0, linestyle=line, label=words)
    axes.set(xscale='log', ylim=(0.0, 1.0), yticks=(0.0, 0.5, 1.0))
    axes.minorticks_off()
    style(axes, PANELS[name], 'steps', 'total variation')


def curves_table(results: Results) -> str:
    """Return the steps until each walk is mixed, the ball walks with the best of their radii."""
    header = ['set', WALKS['hit_and_run'].label]
    for walk in BALL_WALKS:
        header += [WALKS[walk].label, 'its radius [m]']
    rows = []
    for name in RADII:
        here = results.where(shape=name)
        row: list[object] = [name, in_words(here.where(walk='hit_and_run'))]
        for walk in BALL_WALKS:
            chosen = best(here.where(walk=walk))
            row += [in_words(chosen), chosen['radius'][0]]
        rows.append([*row, f'{here.mean("floor").value:.3f}'])
    return markdown([*header, 'floor'], rows)


def radii_table(results: Results) -> str:
    """Return the steps of the ball walks with each radius, by the estimate from above."""
    rows = []
    for name, least in RADII.items():
        for walk in BALL_WALKS:
            chosen = results.where(shape=name, walk=walk)
            each = [steps(chosen.where(radius=times * least))[1] for times in TIMES]
            rows.append([f'{name}, {WALKS[walk].label}', least, *each])
    header = ['set, walk', 'least radius [m]', *(f'{times} x' for times in TIMES)]
    return markdown(header, rows)
