"""
Transitions of Hit-and-Run into a goal: computed, bounded and measured.

The paper bounds the mixing time of a set and from it the length of a path (Section 4). Its
constants are too large to compare with any walk, but the same reasoning works with computed flows.
In a set of square blocks an integral over lines gives the flow of one step between all blocks; the
flow gives the expected number of transitions into a goal, and the relaxation time gives a bound on
it. Experiment ``mixing`` measures the relaxation time itself.
"""

from functools import cache
from typing import NamedTuple

from hnr_planner.core import GridSpace, sample
from hnr_planner.core.theory import cell_flow, CellFlow, expected_transitions, transitions_bound
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, Look, new_figure, style
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import spiral
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Widths of the door between two rooms of 1 m x 1 m, and of the spiral's corridor [m].
DOORS = (0.05, 0.1, 0.2, 0.4)
WIDTHS = (0.8, 1.2, 1.6, 2.0)
#: Side of a block [m], which is also the thickness of the walls; grid cells along that side.
ROOMS_BLOCK, SPIRAL_BLOCK, FINENESS = 0.05, 0.4, 5
#: Number of lines in the quadrature of the flow.
N_LINES = 1 << 17
LOOKS = {
    'rooms': Look('two rooms and a door', '#0072B2', 'o'),
    'spiral': Look('spiral', '#D55E00', 's'),
}


class Case(NamedTuple):
    """A case: shape, ``rooms`` or ``spiral``, and width [m] of the door or of the corridor."""

    shape: str
    width: float


class Blocks(NamedTuple):
    """
    A set of square blocks, with some of them as the goal.

    Attributes
    ----------
    space : GridSpace
        The set.
    size : float
        Side of a block [m].
    free, goal : (rows, columns) bool
        Whether each block belongs to the set, and whether to the goal.

    """

    space: GridSpace
    size: float
    free: NDArray[np.bool_]
    goal: NDArray[np.bool_]


class Theory(NamedTuple):
    """Computed relaxation time [steps], expected transitions into the goal, and their bound."""

    relaxation: float
    expected: float
    bound: float


def cases() -> list[Case]:
    """Return the cases: two rooms with each width of door, and spirals of each width."""
    rooms = [Case('rooms', width) for width in DOORS]
    return rooms + [Case('spiral', width) for width in WIDTHS]


def run(case: Case, seed: int) -> dict[str, float]:
    """Walk from a uniform point of the set until in the goal; return the number of transitions."""
    blocks = blocks_of(case)
    start = _uniform_point(blocks, np.random.default_rng(seed))
    return {'transitions': _transitions(blocks, start, seed)}


def _transitions(blocks: Blocks, start: NDArray, seed: int) -> int:
    """Return the number of steps until the walk from ``start`` (2,) [m] is first in the goal."""
    if _inside(blocks, blocks.goal, start[np.newaxis])[0]:
        return 0
    n_draws = 1000
    while True:
        (walk,) = sample(blocks.space, start, n_draws, seed=seed)
        arrived = _inside(blocks, blocks.goal, walk)
        if arrived.any():
            return int(arrived.argmax()) + 1
        n_draws *= 4  # the same walk, longer


def _inside(blocks: Blocks, chosen: NDArray, points: NDArray) -> NDArray[np.bool_]:
    """Return whether (k,) each point (k, 2) [m] lies in a chosen block (rows, columns)."""
    columns, rows = np.floor(points / blocks.size).astype(int).T
    inside: NDArray[np.bool_] = chosen[rows, columns]
    return inside


def _uniform_point(blocks: Blocks, rng: np.random.Generator) -> NDArray[np.float64]:
    rows, columns = np.nonzero(blocks.free)
    k = rng.integers(len(rows))
    point: NDArray[np.float64] = (
        np.array([columns[k], rows[k]]) + rng.uniform(size=2)
    ) * blocks.size
    return point


@cache
def blocks_of(case: Case) -> Blocks:
    """Build the blocks of a case: two rooms or a spiral, with its goal."""
    return _rooms(case.width) if case.shape == 'rooms' else _spiral(case.width)


def _rooms(door: float) -> Blocks:
    """Build two rooms; the goal is the upper right quarter of the right room."""
    n = round(1.0 / ROOMS_BLOCK)
    free = np.ones((n, 2 * n + 1), dtype=bool)
    free[:, n] = False
    n_door = round(door / ROOMS_BLOCK)
    first, last = (n - n_door) // 2, (n + n_door) // 2
    free[first:last, n] = True
    goal = np.zeros_like(free)
    half = n // 2
    goal[half:, -half:] = True
    return _blocks(free, goal, ROOMS_BLOCK)


def _spiral(width: float) -> Blocks:
    """Build a spiral whose walls are one block thick; the goal is the square at its inner end."""
    made = spiral(width, resolution=SPIRAL_BLOCK, wall=SPIRAL_BLOCK)
    rows, columns = np.indices(made.blocked.shape)
    centres = (np.stack([columns, rows], axis=-1) + 0.5) * SPIRAL_BLOCK
    near = np.abs(centres - np.array(made.goal)).max(axis=-1) < width / 2
    return _blocks(~made.blocked, near & ~made.blocked, SPIRAL_BLOCK)


def _blocks(free: NDArray, goal: NDArray, size: float) -> Blocks:
    fine = np.kron(~free, np.ones((FINENESS, FINENESS), dtype=bool)).astype(bool)
    return Blocks(GridSpace.from_blocked(fine, size / FINENESS), size, free, goal)


def _flow(blocks: Blocks) -> CellFlow:
    """Return the flow between the free blocks; blocked ones would only add rounding errors."""
    flow = cell_flow(blocks.space, blocks.free.shape, N_LINES)
    free = _inside(blocks, blocks.free, flow.centre)
    return CellFlow(flow.area[free], flow.flow[np.ix_(free, free)], flow.centre[free])


@cache
def theory_of(case: Case) -> Theory:
    """Compute relaxation time, expected transitions and their bound for a case."""
    blocks = blocks_of(case)
    flow = _flow(blocks)
    goal = _inside(blocks, blocks.goal, flow.centre)
    fraction = float(flow.area[goal].sum() / flow.area.sum())
    relaxation = flow.relaxation_time
    expected = float((expected_transitions(flow, goal) * flow.area).sum() / flow.area.sum())
    return Theory(relaxation, expected, transitions_bound(relaxation, fraction))


def figure(results: Results) -> Figure:
    """Draw the measured transitions into the goal and the bound against those computed."""
    drawn = new_figure(6.4, 4.6)
    axes = drawn.subplots()
    for shape, look in LOOKS.items():
        here = [case for case in cases() if case.shape == shape]
        theories = [theory_of(case) for case in here]
        expected = [theory.expected for theory in theories]
        measured = [results.of(case).mean('transitions') for case in here]
        draw_profile(axes, expected, measured, look)
        bounds = [theory.bound for theory in theories]
        axes.plot(expected, bounds, '--', color=look.colour, label=f'{look.label}: the bound')
    axes.set(xscale='log', yscale='log')
    reach = axes.get_xlim()
    axes.plot(reach, reach, ':', color=FAINT_INK, linewidth=1.0, label='as computed')
    style(axes, 'Transitions into the goal', 'computed from the flow', 'measured, and bound')
    legend(axes, 'upper left')
    return drawn


def tables(results: Results) -> str:
    """Return a table of computed, measured and bounded transitions."""
    header = ['set', 'relaxation time', 'transitions, computed', 'measured', 'bound']
    rows = []
    for case in cases():
        theory = theory_of(case)
        measured = results.of(case).mean('transitions')
        computed = f'{theory.relaxation:.1f}', f'{theory.expected:.1f}'
        rows.append([f'{case.shape} {case.width}', *computed, measured, f'{theory.bound:.1f}'])
    return markdown(header, rows)


EXPERIMENT = Experiment(
    EXPERIMENTS['theory'],
    runs=1000,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
