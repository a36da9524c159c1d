"""
Transitions of Hit-and-Run and RRT through a spiral (paper, section "Planning", position only).

The paper says: Hit-and-Run needs fewer transitions for all but the hardest problems, mostly by
far; a fatter middle part makes it harder for RRT alone; and RRT covers the space more evenly.
"""

from functools import cache
from typing import Any, NamedTuple

from hnr_planner.core import GridSpace, plan, PlanResult
from hnr_planner.drawing import draw_ends, draw_map, draw_samples, INK
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_means, legend, LOOKS, new_figure, style
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import OccupancyMap, Spiral, spiral
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

#: Widths of the corridor [m] in a square of 10 m.
WIDTHS = (0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4)
#: The other family: a corridor of one width, with a middle arm of these widths [m]. The square
#: grows with that arm, so that the corridor keeps its number of arms (17 or 18).
NARROW = 1.0
MIDDLES = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0)
#: An algorithm and when it ends: at a sample in the region around the goal, the paper's test, or
#: as soon as a sample sees the goal.
SEARCHES = (
    ('hit_and_run', 'region'),
    ('rrt', 'region'),
    ('hit_and_run', 'sight'),
    ('rrt', 'sight'),
    ('auto', 'region'),
)
#: The paper's lower plots: the samples of one run at this width.
SHOWN_WIDTH = 1.2
LAYOUT: list[Any] = [['even', 'fat'], ['hit_and_run', 'rrt']]


class Case(NamedTuple):
    """A spiral and a search through it; widths in metres."""

    family: str
    width: float
    middle: float
    algorithm: str
    ends: str


def cases() -> list[Case]:
    """List both families."""
    even = [('even', width, width) for width in WIDTHS]
    fat = [('fat', NARROW, middle) for middle in MIDDLES]
    return [Case(*shape, *search) for shape in even + fat for search in SEARCHES]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once, and count."""
    result = search(case, seed)
    return {
        'transitions': result.iterations,
        'rejected': result.counts.get('rejected_proposals', 0),
        'length': result.length,
    }


def search(case: Case, seed: int) -> PlanResult:
    """Search once; nothing cuts it and nothing shortens its path."""
    made, space = built(case.width, case.middle)
    return plan(
        space,
        made.start,
        made.goal,
        algorithm=case.algorithm,
        goal_radius=made.goal_radius if case.ends == 'region' else 0.0,
        seed=seed,
        simplify=False,
        time_limit=np.inf,
    )


@cache
def built(width: float, middle: float) -> tuple[Spiral, GridSpace]:
    """Build a spiral and its space."""
    if middle == width:
        made = spiral(width)
    else:
        made = spiral(width, middle_width=middle, size=10.0 + middle - width)
    return made, GridSpace.from_blocked(made.blocked, made.resolution)


def figure(results: Results) -> Figure:
    """Draw transitions over both families' widths, and the samples of one run of each planner."""
    drawn = new_figure(10.0, 9.2)
    axes = drawn.subplot_mosaic(LAYOUT, height_ratios=(1, 1.1))
    _draw_family(axes['even'], results.where(family='even'), 'width')
    style(axes['even'], 'All arms equally wide', 'width of the arms [m]', 'transitions, mean')
    _draw_family(axes['fat'], results.where(family='fat'), 'middle')
    style(
        axes['fat'],
        f'Arms {NARROW} m wide, the middle one fatter',
        'width of the middle arm [m]',
        'transitions, mean',
    )
    legend(axes['even'], 'lower left')
    for name in ('hit_and_run', 'rrt'):
        _draw_typical_run(axes[name], results, name)
    return drawn


def _draw_family(axes: Axes, results: Results, x: str) -> None:
    for algorithm, ends in SEARCHES:
        chosen = results.where(algorithm=algorithm, ends=ends)
        look = LOOKS[algorithm]
        line, words = ('-', look.label) if ends == 'region' else ('--', f'{look.label}, by sight')
        draw_means(axes, chosen, x, 'transitions', look, label=words, line=line)
    axes.set_yscale('log')


def _draw_typical_run(axes: Axes, results: Results, algorithm: str) -> None:
    """Draw the samples of the run whose number of transitions is the median one."""
    case = Case('even', SHOWN_WIDTH, SHOWN_WIDTH, algorithm, 'region')
    runs = results.where(**case._asdict())
    median = np.argsort(runs['transitions'])[len(runs) // 2]
    made, space = built(SHOWN_WIDTH, SHOWN_WIDTH)
    result = search(case, int(runs['seed'][median]))
    occupancy = OccupancyMap(np.where(space.blocked, 100, 0).astype(np.int8), made.resolution)
    draw_map(axes, occupancy)
    draw_samples(axes, result.samples)
    draw_ends(axes, made.start, made.goal)
    axes.set_title(
        f'{LOOKS[algorithm].label}: the median run at width {SHOWN_WIDTH}, '
        f'{result.iterations:,} transitions',
        loc='left',
        fontsize=10.5,
        color=INK,
        pad=8,
    )


def tables(results: Results) -> str:
    """Return the mean transitions of every search on every spiral."""
    return '\n'.join(
        _table(results.where(family=family), column, words)
        for family, column, words in (
            ('even', 'width', 'width of the arms [m]'),
            ('fat', 'middle', f'width of the middle arm [m], the others {NARROW}'),
        )
    )


def _table(results: Results, column: str, words: str) -> str:
    header = [words, *(f'{LOOKS[name].label}, {ends}' for name, ends in SEARCHES), 'ratio']
    rows = []
    for width in results.distinct(column):
        here = results.where(**{column: width})
        means = [
            here.where(algorithm=algorithm, ends=ends).mean('transitions')
            for algorithm, ends in SEARCHES
        ]
        rows.append([width, *means, f'{means[1].value / means[0].value:.2f}'])
    return markdown(header, rows)


EXPERIMENT = Experiment(
    name='spiral',
    about='Transitions through a spiral corridor, by the width of its arms.',
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
