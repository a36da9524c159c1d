"""
Transitions of Hit-and-Run and RRT under kinematics (paper, section "Kinematic Planning").

The paper claims that Hit-and-Run needs fewer transitions than RRT, by as much as a factor of
three, in a corridor with two turns, for a robot of bounded acceleration that the boundary stops.
The paper does not define a transition: both readings (``TRANSITIONS``) are measured, and also the
integration steps.
"""

from functools import cache
import math
from typing import Any, NamedTuple

from hnr_planner.core import GridSpace, plan_trajectory, TrajectoryResult
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, LOOKS, new_figure, style
from hnr_planner.experiments.median_run import draw_run, median_run
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import Corridor, serpentine, zigzag
from matplotlib.axes import Axes
from matplotlib.figure import Figure

#: The corridors, and their widths [m].
SHAPES = {'serpentine': serpentine, 'z': zigzag}
WIDTHS = (1.0, 1.5, 2.0, 3.0)
#: The robot: largest acceleration [m/s^2] and speed [m/s], and the controller's step [s].
ROBOT = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=3.0)
TIME_STEP = 0.2
ALGORITHMS = {'hit_and_run': 'kinodynamic_hit_and_run', 'rrt': 'kinodynamic_rrt'}
#: A transition drives until its distance to the target stops falling, or for one time step.
TRANSITIONS = ('arrival', 'step')
#: Width of the run that is drawn, as in the paper's lower plots [m].
SHOWN_WIDTH = 2.0
LAYOUT: list[Any] = [
    ['serpentine'] * 2 + ['z'] * 2 + ['steps'] * 2,
    ['hit_and_run'] * 3 + ['rrt'] * 3,
]


class Case(NamedTuple):
    """A case: shape and width [m] of a corridor, planner, and definition of a transition."""

    shape: str
    width: float
    algorithm: str
    transition: str


def cases() -> list[Case]:
    """Return every planner with both definitions of a transition in every corridor."""
    return [
        Case(shape, width, algorithm, transition)
        for shape in SHAPES
        for width in WIDTHS
        for transition in TRANSITIONS
        for algorithm in ALGORITHMS
    ]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once; return transitions, integration steps and duration [s], nan if unsolved."""
    result = search(case, seed)
    return {
        'transitions': result.iterations,
        'steps': result.counts['integration_steps'],
        'duration': math.nan if result.trajectory is None else result.trajectory.times[-1],
    }


def search(case: Case, seed: int) -> TrajectoryResult:
    """Search for one trajectory from rest, without time limit and without shortening."""
    made, space = built(case.shape, case.width)
    return plan_trajectory(
        space,
        ROBOT,
        (*made.start, 0.0, 0.0),
        made.goal,
        algorithm=ALGORITHMS[case.algorithm],
        goal_radius=made.goal_radius,
        boundary='inelastic',
        transition=case.transition,
        time_step=TIME_STEP,
        seed=seed,
        simplify=False,
        time_limit=math.inf,
    )


@cache
def built(shape: str, width: float) -> tuple[Corridor, GridSpace]:
    """Build the corridor of a shape in ``SHAPES`` and a width [m]; return it and its space."""
    made = SHAPES[shape](width)
    return made, GridSpace.from_blocked(made.blocked, made.resolution)


def figure(results: Results) -> Figure:
    """Draw transitions and steps against the width, and each planner's run of median length."""
    drawn = new_figure(10.0, 6.8)
    axes = drawn.subplot_mosaic(LAYOUT, height_ratios=(1.3, 1))
    for name, shape, column, title, y in (
        ('serpentine', 'serpentine', 'transitions', 'Serpentine: transitions', 'mean'),
        ('z', 'z', 'transitions', 'Z: transitions', ''),
        ('steps', 'serpentine', 'steps', 'Serpentine: integration steps', ''),
    ):
        axes[name].sharey(axes['serpentine'])
        _draw_lines(axes[name], results, shape, column)
        style(axes[name], title, 'width of the corridor [m]', y)
    legend(axes['z'], 'upper right')
    made, _ = built('serpentine', SHOWN_WIDTH)
    for name in ALGORITHMS:
        shown = median_run(results, Case('serpentine', SHOWN_WIDTH, name, 'arrival'), search)
        draw_run(axes[name], made, shown, LOOKS[name].label)
        axes[name].plot(*shown.path.T, color=LOOKS[name].colour, linewidth=1.0)
    return drawn


def _draw_lines(axes: Axes, results: Results, shape: str, column: str) -> None:
    for algorithm in ALGORITHMS:
        for transition, line in zip(TRANSITIONS, ('-', '--'), strict=True):
            look = LOOKS[algorithm]
            label = look.label if transition == 'arrival' else f'{look.label}, one step'
            here = [Case(shape, width, algorithm, transition) for width in WIDTHS]
            means = [results.of(case).mean(column) for case in here]
            draw_profile(axes, WIDTHS, means, look, label=label, line=line)
    axes.set_xticks(WIDTHS)
    axes.set_yscale('log')


def tables(results: Results) -> str:
    """Return a table of the mean transitions and integration steps of every search."""
    columns = [(column, name) for column in ('transitions', 'steps') for name in ALGORITHMS]
    header = ['corridor, width [m], transition']
    header += [f'{LOOKS[name].label}: {column}' for column, name in columns]
    rows = [
        [
            f'{shape}, {width}, {transition}',
            *(
                results.of(Case(shape, width, name, transition)).mean(column)
                for column, name in columns
            ),
        ]
        for shape in SHAPES
        for transition in TRANSITIONS
        for width in WIDTHS
    ]
    return markdown(header, rows)


EXPERIMENT = Experiment(
    EXPERIMENTS['corridor'],
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
