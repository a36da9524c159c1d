"""
Transitions of Hit-and-Run and RRT under kinematics (paper, section "Kinematic Planning").

The paper says: in a corridor with two turns, for a robot with bounded acceleration that the
boundary stops, Hit-and-Run needs fewer transitions, by as much as a factor of three. It does not
say what a transition is; here are both readings, and the integration steps beside them.
"""

from functools import cache
import math
from typing import Any, NamedTuple

from hnr_planner.core import GridSpace, plan, PlanResult
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.drawing import draw_ends, draw_map, draw_samples, INK
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_means, legend, LOOKS, new_figure, style
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import OccupancyMap
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Widths of the corridor [m].
WIDTHS = (1.0, 1.5, 2.0, 3.0)
#: Length of an arm of the serpentine, side of the square that the Z fills, walls, cells [m].
ARM, SQUARE, WALL, RESOLUTION = 10.0, 10.0, 0.1, 0.05
#: The robot: largest acceleration [m/s^2] and speed [m/s], and the controller's step [s].
ROBOT = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=3.0)
TIME_STEP = 0.2
ALGORITHMS = {'hit_and_run': 'kinodynamic_hit_and_run', 'rrt': 'kinodynamic_rrt'}
#: A transition drives until the target is no longer getting nearer, or for one step.
TRANSITIONS = ('arrival', 'step')
SHOWN_WIDTH = 2.0
LAYOUT: list[Any] = [
    [shape for shape in ('serpentine', 'z', 'steps') for _ in range(2)],
    [algorithm for algorithm in ALGORITHMS for _ in range(3)],
]


class Case(NamedTuple):
    """A corridor of a width [m], a planner, and what a transition is."""

    shape: str
    width: float
    algorithm: str
    transition: str


class Corridor(NamedTuple):
    """A corridor and a request from its one end to its other."""

    space: GridSpace
    start: tuple[float, float]
    goal: tuple[float, float]


def cases() -> list[Case]:
    """List both corridors."""
    return [
        Case(shape, width, algorithm, transition)
        for shape in ('serpentine', 'z')
        for width in WIDTHS
        for transition in TRANSITIONS
        for algorithm in ALGORITHMS
    ]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once, and count."""
    result = search(case, seed)
    return {
        'transitions': result.iterations,
        'steps': result.counts['integration_steps'],
        'duration': math.nan if result.trajectory is None else result.trajectory.times[-1],
    }


def search(case: Case, seed: int) -> PlanResult:
    """Search once, from rest; nothing cuts it and nothing shortens its motion."""
    corridor = built(case.shape, case.width)
    return plan(
        corridor.space,
        (*corridor.start, 0.0, 0.0),
        corridor.goal,
        system=ROBOT,
        algorithm=ALGORITHMS[case.algorithm],
        goal_radius=case.width / 2,
        transition=case.transition,
        time_step=TIME_STEP,
        seed=seed,
        simplify=False,
        time_limit=math.inf,
    )


@cache
def built(shape: str, width: float) -> Corridor:
    """Build a corridor."""
    return _serpentine(width) if shape == 'serpentine' else _z(width)


def _serpentine(width: float) -> Corridor:
    """Build three arms side by side, each open to the next at one end."""
    pitch = width + WALL
    free = _solid(ARM, 3 * pitch - WALL)
    for k in range(3):
        _open(free, 0.0, k * pitch, ARM, width)
    _open(free, ARM - width, width, width, WALL)
    _open(free, 0.0, pitch + width, width, WALL)
    middle = width / 2
    return _corridor(free, (middle, middle), (ARM - middle, 2 * pitch + middle))


def _z(width: float) -> Corridor:
    """Build a Z: along the top of a square, down its diagonal in a step, along the bottom."""
    free = _solid(SQUARE, SQUARE)
    _open(free, 0.0, 0.0, (SQUARE + width) / 2, width)
    _open(free, (SQUARE - width) / 2, 0.0, width, SQUARE)
    _open(free, (SQUARE - width) / 2, SQUARE - width, (SQUARE + width) / 2, width)
    middle = width / 2
    return _corridor(free, (middle, middle), (SQUARE - middle, SQUARE - middle))


def _solid(width: float, height: float) -> NDArray[np.bool_]:
    return np.zeros((round(height / RESOLUTION), round(width / RESOLUTION)), dtype=bool)


def _open(free: NDArray, x: float, y: float, width: float, height: float) -> None:
    left, low = round(x / RESOLUTION), round(y / RESOLUTION)
    right, high = round((x + width) / RESOLUTION), round((y + height) / RESOLUTION)
    free[low:high, left:right] = True


def _corridor(free: NDArray, start: tuple[float, float], goal: tuple[float, float]) -> Corridor:
    return Corridor(GridSpace.from_blocked(~free, RESOLUTION), start, goal)


def figure(results: Results) -> Figure:
    """Draw transitions and steps over the width, and the motion of one run of each planner."""
    drawn = new_figure(10.0, 6.8)
    axes = drawn.subplot_mosaic(LAYOUT, height_ratios=(1.3, 1))
    titles = {'serpentine': 'Serpentine: transitions', 'z': 'Z: transitions'}
    for shape, title in titles.items():
        _draw_lines(axes[shape], results.where(shape=shape), 'transitions')
        style(axes[shape], title, 'width of the corridor [m]', 'transitions, mean')
    _draw_lines(axes['steps'], results.where(shape='serpentine'), 'steps')
    style(
        axes['steps'], 'Serpentine: steps', 'width of the corridor [m]', 'integration steps, mean'
    )
    axes['z'].set_ylim(top=8.0 * axes['z'].get_ylim()[1])  # room for the legend
    legend(axes['z'], 'upper right')
    for name in ALGORITHMS:
        _draw_typical_run(axes[name], results, name)
    return drawn


def _draw_lines(axes: Axes, results: Results, column: str) -> None:
    for algorithm in ALGORITHMS:
        for transition, line in zip(TRANSITIONS, ('-', '--'), strict=True):
            look = LOOKS[algorithm]
            words = look.label if transition == 'arrival' else f'{look.label}, one step'
            chosen = results.where(algorithm=algorithm, transition=transition)
            draw_means(axes, chosen, 'width', column, look, label=words, line=line)
    axes.set_yscale('log')


def _draw_typical_run(axes: Axes, results: Results, algorithm: str) -> None:
    """Draw the states and the motion of the run with the median number of transitions."""
    case = Case('serpentine', SHOWN_WIDTH, algorithm, 'arrival')
    runs = results.where(**case._asdict())
    median = np.argsort(runs['transitions'])[len(runs) // 2]
    corridor = built(case.shape, case.width)
    result = search(case, int(runs['seed'][median]))
    data = np.where(corridor.space.blocked, 100, 0).astype(np.int8)
    draw_map(axes, OccupancyMap(data, RESOLUTION))
    draw_samples(axes, result.samples)
    axes.plot(*result.path.T, color=LOOKS[algorithm].colour, linewidth=1.0)
    draw_ends(axes, corridor.start, corridor.goal)
    axes.set_title(
        f'{LOOKS[algorithm].label}: median run, {result.iterations:,} transitions',
        loc='left',
        fontsize=10.5,
        color=INK,
        pad=8,
    )


def tables(results: Results) -> str:
    """Return the mean transitions and integration steps of every search."""
    columns = [(column, name) for column in ('transitions', 'steps') for name in ALGORITHMS]
    header = ['corridor, width [m], transition']
    header += [f'{LOOKS[name].label}: {column}' for column, name in columns]
    rows = []
    for shape in ('serpentine', 'z'):
        for transition in TRANSITIONS:
            for width in WIDTHS:
                here = results.where(shape=shape, width=width, transition=transition)
                means = [here.where(algorithm=name).mean(column) for column, name in columns]
                rows.append([f'{shape}, {width}, {transition}', *means])
    return markdown(header, rows)


EXPERIMENT = Experiment(
    name='corridor',
    about='Transitions and integration steps through a corridor with two turns, under kinematics.',
    runs=100,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
