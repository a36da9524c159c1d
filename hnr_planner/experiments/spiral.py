"""
Transitions of Hit-and-Run and RRT through a spiral (paper, section "Planning", position only).

The paper claims that Hit-and-Run needs fewer transitions than RRT for all but the hardest
problems, usually by a large margin, and that a wider middle arm makes the problem harder for RRT
alone.
"""

from functools import cache
from typing import Any, NamedTuple

from hnr_planner.core import GridSpace, plan, PlanResult
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, LOOKS, new_figure, style
from hnr_planner.experiments.median_run import draw_run, median_run
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import Corridor, spiral
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

#: Widths of the arms [m] in a square of 10 m.
WIDTHS = (0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4)
#: The second family: all arms have one width, except the middle arm with these widths [m]. The
#: square grows with that arm, so that the corridor keeps its number of arms (17 or 18).
NARROW = 1.0
MIDDLES = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0)
#: Algorithm and goal test: a sample in the region around the goal, as in the paper, or a sample
#: that sees the goal.
SEARCHES = (
    ('hit_and_run', 'region'),
    ('rrt', 'region'),
    ('hit_and_run', 'sight'),
    ('rrt', 'sight'),
    ('auto', 'region'),
)
#: Width of the runs whose samples are drawn, as in the paper's lower plots [m].
SHOWN_WIDTH = 1.2
LAYOUT: list[Any] = [['even', 'fat'], ['hit_and_run', 'rrt']]


class Case(NamedTuple):
    """A case: widths of the arms and of the middle arm [m], algorithm, and goal test."""

    width: float
    middle: float
    algorithm: str
    ends: str


#: The spirals of both families, as the first two fields of their cases. They share one spiral.
EVEN = [(width, width) for width in WIDTHS]
FAT = [(NARROW, middle) for middle in MIDDLES]


def cases() -> list[Case]:
    """Return every search through every spiral."""
    shapes = dict.fromkeys(EVEN + FAT)
    return [Case(*shape, *search) for shape in shapes for search in SEARCHES]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once and return transitions, rejected proposals and path length [m]."""
    result = search(case, seed)
    return {
        'transitions': result.iterations,
        'rejected': result.counts.get('rejected_proposals', 0),
        'length': result.length,
    }


def search(case: Case, seed: int) -> PlanResult:
    """Search for one path, without time limit and without shortening."""
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
def built(width: float, middle: float) -> tuple[Corridor, GridSpace]:
    """Build the spiral of widths of the arms and the middle arm [m]; return it and its space."""
    if middle == width:
        made = spiral(width)
    else:
        made = spiral(width, middle_width=middle, size=10.0 + middle - width)
    return made, GridSpace.from_blocked(made.blocked, made.resolution)


def figure(results: Results) -> Figure:
    """Draw transitions against width for both families, and the samples of the median runs."""
    drawn = new_figure(10.0, 9.2)
    axes = drawn.subplot_mosaic(LAYOUT, height_ratios=(1, 1.1))
    _draw_family(axes['even'], results, EVEN)
    style(axes['even'], 'All arms equally wide', 'width of the arms [m]', 'transitions, mean')
    _draw_family(axes['fat'], results, FAT)
    style(
        axes['fat'],
        f'Arms {NARROW} m wide, the middle one fatter',
        'width of the middle arm [m]',
        'transitions, mean',
    )
    legend(axes['even'], 'lower left')
    made, _ = built(SHOWN_WIDTH, SHOWN_WIDTH)
    for name in ('hit_and_run', 'rrt'):
        shown = Case(SHOWN_WIDTH, SHOWN_WIDTH, name, 'region')
        label = f'{LOOKS[name].label}, width {SHOWN_WIDTH}'
        draw_run(axes[name], made, median_run(results, shown, search), label)
    return drawn


def _draw_family(axes: Axes, results: Results, shapes: list[tuple[float, float]]) -> None:
    middles = [middle for _, middle in shapes]
    for search in SEARCHES:
        algorithm, ends = search
        means = [results.of(Case(*shape, *search)).mean('transitions') for shape in shapes]
        line = '-' if ends == 'region' else '--'
        draw_profile(axes, middles, means, LOOKS[algorithm], label=_label(*search), line=line)
    axes.set_xticks(middles)
    axes.set_yscale('log')


def tables(results: Results) -> str:
    """Return a table for each family: mean transitions of every search on every spiral."""
    families = {
        'width of the arms [m]': EVEN,
        f'width of the middle arm [m], the others {NARROW}': FAT,
    }
    return '\n'.join(_table(results, *family) for family in families.items())


def _table(results: Results, title: str, shapes: list[tuple[float, float]]) -> str:
    header = [title, *(_label(*search) for search in SEARCHES), 'RRT / Hit-and-Run']
    rows = []
    for shape in shapes:
        means = [results.of(Case(*shape, *search)).mean('transitions') for search in SEARCHES]
        hit_and_run, rrt, *_ = means
        rows.append([shape[-1], *means, f'{rrt.value / hit_and_run.value:.2f}'])
    return markdown(header, rows)


def _label(algorithm: str, ends: str) -> str:
    label = LOOKS[algorithm].label
    return label if ends == 'region' else f'{label}, by sight'


EXPERIMENT = Experiment(
    EXPERIMENTS['spiral'],
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
