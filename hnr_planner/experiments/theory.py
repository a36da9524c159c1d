"""
From conductance to path length: what theory says of Hit-and-Run, beside what it does.

The paper bounds the conductance of a set, from it the mixing time, and from that the length of a
path (its Section 4). Its own constants are far from any number of steps that one would wait for;
the chain of reasoning is sound, and can be followed with conductances that are computed. In sets
made of square blocks one integral over lines gives the flow between all blocks, and so the
conductance of the best cut, the relaxation time and the expected transitions into a goal.
"""

from functools import cache
import math
from typing import NamedTuple

from hnr_planner.core import GridSpace, sample
from hnr_planner.core.theory import (
    best_cut,
    cell_flow,
    CellFlow,
    expected_transitions,
    transitions_bound,
)
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, Look, new_figure, style
from hnr_planner.experiments.results import markdown, Mean, Results
from hnr_planner.maps import spiral
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Widths of the door between two rooms of 1 m x 1 m, and of the spiral's corridor [m].
DOORS = (0.05, 0.1, 0.2, 0.4)
WIDTHS = (0.8, 1.2, 1.6, 2.0)
#: Side of a block, as thick as the walls [m], and cells of the grid along it.
ROOMS_BLOCK, SPIRAL_BLOCK, FINENESS = 0.05, 0.4, 5
#: Steps and chains that the relaxation time is measured with.
N_STEPS, N_CHAINS = 4000, 8
LOOKS = {
    'rooms': Look('two rooms and a door', '#0072B2', 'o'),
    'spiral': Look('spiral', '#D55E00', 's'),
}


class Case(NamedTuple):
    """Two rooms with a door, or a spiral, of a width [m]."""

    shape: str
    width: float


class Blocks(NamedTuple):
    """
    A set of square blocks.

    ``free`` (rows, columns) are the blocks in the set and ``goal`` those of the goal; ``side``
    (rows, columns) are those on one side of the narrowest place.
    """

    space: GridSpace
    size: float
    free: NDArray[np.bool_]
    goal: NDArray[np.bool_]
    side: NDArray[np.bool_]


class Theory(NamedTuple):
    """What theory says of a set."""

    conductance: float
    relaxation: float
    expected: float
    bound: float


def cases() -> list[Case]:
    """List the rooms and the spirals."""
    rooms = [Case('rooms', width) for width in DOORS]
    return rooms + [Case('spiral', width) for width in WIDTHS]


def run(case: Case, seed: int) -> dict[str, float]:
    """Walk from a uniform point into the goal, and measure how the sides correlate in time."""
    blocks = blocks_of(case)
    start = _uniform_point(blocks, np.random.default_rng(seed))
    near, far = _correlations(blocks, case, start, seed)
    return {'transitions': _transitions(blocks, start, seed), 'near': near, 'far': far}


def _transitions(blocks: Blocks, start: NDArray, seed: int) -> int:
    """Return the steps until the walk is in the goal."""
    if _inside(blocks, blocks.goal, start[np.newaxis])[0]:
        return 0
    n_draws = 1000
    while True:
        (walk,) = sample(blocks.space, start, n_draws, seed=seed)
        arrived = _inside(blocks, blocks.goal, walk)
        if arrived.any():
            return int(arrived.argmax()) + 1
        n_draws *= 4  # the same walk, and more of it


def _correlations(blocks: Blocks, case: Case, start: NDArray, seed: int) -> tuple[float, float]:
    """Return how often a walk is on the same side after the two lags, less how often not."""
    walks = sample(blocks.space, start, N_STEPS, n_chains=N_CHAINS, burn_in=N_STEPS, seed=seed)
    sides = np.where(_inside(blocks, blocks.side, walks.reshape(-1, 2)), 1.0, -1.0)
    sides = sides.reshape(N_CHAINS, N_STEPS)
    near, far = lags(case)
    return _correlation(sides, near), _correlation(sides, far)


def _correlation(sides: NDArray, lag: int) -> float:
    return float((sides[:, :-lag] * sides[:, lag:]).mean())


def lags(case: Case) -> tuple[int, int]:
    """Return the two lags: about half the relaxation time that theory says, and all of it."""
    relaxation = theory_of(case).relaxation
    return max(1, round(relaxation / 2)), max(2, round(relaxation))


def _inside(blocks: Blocks, chosen: NDArray, points: NDArray) -> NDArray[np.bool_]:
    """Say which points (k, 2) lie in chosen blocks."""
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
    """Build a set."""
    return _rooms(case.width) if case.shape == 'rooms' else _spiral(case.width)


def _rooms(door: float) -> Blocks:
    """Build two rooms; the goal is the quarter of the right one that is farthest from the left."""
    n = round(1.0 / ROOMS_BLOCK)
    free = np.ones((n, 2 * n + 1), dtype=bool)
    free[:, n] = False
    wide = round(door / ROOMS_BLOCK)
    first, last = (n - wide) // 2, (n + wide) // 2
    free[first:last, n] = True
    goal, side = np.zeros_like(free), np.zeros_like(free)
    half = n // 2
    goal[half:, -half:] = True
    side[:, :n] = True
    return _blocks(free, goal, side, ROOMS_BLOCK)


def _spiral(width: float) -> Blocks:
    """Build a spiral with walls as thick as a block; the goal is the square at its inner end."""
    made = spiral(width, resolution=SPIRAL_BLOCK, wall=SPIRAL_BLOCK)
    rows, columns = np.indices(made.blocked.shape)
    centres = (np.stack([columns, rows], axis=-1) + 0.5) * SPIRAL_BLOCK
    near = np.abs(centres - np.array(made.goal)).max(axis=-1) < width / 2
    return _blocks(~made.blocked, near & ~made.blocked, np.zeros_like(near), SPIRAL_BLOCK)


def _blocks(free: NDArray, goal: NDArray, side: NDArray, size: float) -> Blocks:
    fine = np.kron(~free, np.ones((FINENESS, FINENESS), dtype=bool)).astype(bool)
    space = GridSpace.from_blocked(fine, size / FINENESS)
    blocks = Blocks(space, size, free, goal, side)
    if not side.any():
        flow = _flow(blocks)
        columns, rows = np.floor(flow.centre[best_cut(flow).inside] / size).astype(int).T
        side[rows, columns] = True
    return blocks


def _flow(blocks: Blocks) -> CellFlow:
    """Return the flow between the free blocks, without what rounding leaves to the others."""
    flow = cell_flow(blocks.space, blocks.free.shape, 1 << 17)
    free = _inside(blocks, blocks.free, flow.centre)
    return CellFlow(flow.area[free], flow.flow[np.ix_(free, free)], flow.centre[free])


@cache
def theory_of(case: Case) -> Theory:
    """Compute what theory says."""
    blocks = blocks_of(case)
    flow = _flow(blocks)
    goal = _inside(blocks, blocks.goal, flow.centre)
    part = float(flow.area[goal].sum() / flow.area.sum())
    relaxation = flow.relaxation_time
    expected = float((expected_transitions(flow, goal) * flow.area).sum() / flow.area.sum())
    return Theory(
        best_cut(flow).conductance, relaxation, expected, transitions_bound(relaxation, part)
    )


def measured_relaxation(results: Results, case: Case) -> Mean:
    """Return the relaxation time at which the correlations fall between the two lags."""
    near, far = lags(case)
    of = results.where(**case._asdict())
    first, last = of.mean('near'), of.mean('far')
    if not 0.0 < last.value < first.value:
        return Mean(math.nan, math.nan)
    decay = math.log(first.value / last.value)
    relative = math.hypot(first.half / first.value, last.half / last.value) / decay
    value = (far - near) / decay
    return Mean(value, value * relative)


def figure(results: Results) -> Figure:
    """Draw measured against computed: relaxation times, and transitions into the goal."""
    drawn = new_figure(10.0, 4.2)
    relaxation, transitions = drawn.subplots(1, 2)
    for shape, look in LOOKS.items():
        here = [case for case in cases() if case.shape == shape]
        said = [theory_of(case) for case in here]
        draw_profile(
            relaxation,
            [1.0 / theory.conductance for theory in said],
            [measured_relaxation(results, case) for case in here],
            look,
        )
        measured = [results.where(**case._asdict()).mean('transitions') for case in here]
        draw_profile(transitions, [theory.expected for theory in said], measured, look)
        transitions.plot(
            [theory.expected for theory in said],
            [theory.bound for theory in said],
            '--',
            color=look.colour,
            label=f'{look.label}: the bound',
        )
    _draw_diagonal(relaxation, 0.5, '1 / (2 \u03a6)')
    _draw_diagonal(transitions, 1.0, 'as computed')
    for axes in (relaxation, transitions):
        axes.set(xscale='log', yscale='log')
    style(
        relaxation, 'Relaxation time', '1 / conductance \u03a6 of the best cut', 'steps, measured'
    )
    style(
        transitions, 'Transitions into the goal', 'computed from the flow', 'measured, and bound'
    )
    legend(relaxation, 'upper left')
    legend(transitions, 'upper left')
    return drawn


def _draw_diagonal(axes: Axes, slope: float, words: str) -> None:
    reach = np.array(axes.get_xlim())
    reach[0] = max(reach[0], 1.0)
    axes.plot(reach, slope * reach, color=FAINT_INK, linewidth=1.0, linestyle=':', label=words)


def tables(results: Results) -> str:
    """Return what was computed and what was measured."""
    header = [
        'set',
        'conductance \u03a6',
        '1 / (2 \u03a6)',
        'relaxation, computed',
        'measured',
        'transitions, computed',
        'measured',
        'bound',
    ]
    rows = []
    for case in cases():
        said = theory_of(case)
        rows.append(
            [
                f'{case.shape} {case.width}',
                f'{said.conductance:.4f}',
                f'{0.5 / said.conductance:.1f}',
                f'{said.relaxation:.1f}',
                measured_relaxation(results, case),
                f'{said.expected:.1f}',
                results.where(**case._asdict()).mean('transitions'),
                f'{said.bound:.1f}',
            ]
        )
    return markdown(header, rows)


EXPERIMENT = Experiment(
    name='theory',
    about='Conductance, relaxation time and path length: computed, and measured.',
    runs=200,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
