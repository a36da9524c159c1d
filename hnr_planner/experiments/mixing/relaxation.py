"""
Relaxation time of Hit-and-Run, compared with the conductance Phi of a set in the plane.

Time and conductance are computed from the flow between the cells of a lattice. The time is also
measured, from the moves of chains between cells. By Cheeger's inequality the time lies between
1 / (2 Phi) and 2 / Phi^2 (Lawler and Sokal 1988): near the lower bound where one narrow door is
the only obstacle to mixing, nearer the upper bound in long sets.
"""

from functools import cache
from typing import NamedTuple

from hnr_planner.core import Chains, relaxation_time, walk_on
from hnr_planner.core.theory import best_cut, cell_flow
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.figures import draw_profile, legend, Look, style
from hnr_planner.experiments.mixing.sets import planar_sets
from hnr_planner.experiments.mixing.variation import format_steps
from hnr_planner.experiments.results import markdown, Mean, Results
from matplotlib.axes import Axes
import numpy as np

#: Refinement of the lattice along each axis, and number of lines, for the computed flow.
REFINEMENT, N_LINES = 4, 1 << 18
#: Draws of each chain in which moves between cells are counted; lag of a move, the steps between
#: its two ends, as a fraction of the computed relaxation time; and the least lag [steps].
#: The error that the size of the cells causes falls with the lag.
N_DRAWS, LAG, MIN_LAG = 1000, 0.5, 8
#: Label, colour and marker of each set, by the first word of its name.
LOOKS = {
    'L': Look('L', '#CC79A7', 'D'),
    'star': Look('star', '#E69F00', '^'),
    'door': Look('two rooms', '#0072B2', 'o'),
    'spiral': Look('spirals', '#D55E00', 's'),
}


class Computed(NamedTuple):
    """Computed values of a set: conductance of the best cut found, and relaxation time [steps]."""

    conductance: float
    relaxation: float


@cache
def computed(name: str) -> Computed:
    """Compute conductance and relaxation time of a set in the plane from Hit-and-Run's flow."""
    mixing_set = planar_sets()[name]
    rows, columns = mixing_set.lattice
    flow = cell_flow(mixing_set.space, (REFINEMENT * rows, REFINEMENT * columns), N_LINES)
    return Computed(best_cut(flow).conductance, flow.relaxation_time)


def measured(name: str, chains: Chains) -> float:
    """
    Return the relaxation time [steps] of Hit-and-Run in the set ``name``, from moves of chains.

    The mixed ``chains`` are continued for ``N_DRAWS`` steps.
    """
    mixing_set = planar_sets()[name]
    draws, _ = walk_on(mixing_set.space, chains, N_DRAWS)
    cells = mixing_set.cells(draws.reshape(-1, 2)).reshape(draws.shape[:2])
    return relaxation_time(cells, max(MIN_LAG, round(LAG * computed(name).relaxation)))


def draw_relaxation(axes: Axes, results: Results) -> None:
    """Draw measured relaxation times against 1 / Phi, with the bounds of Cheeger's inequality."""
    for word, look in LOOKS.items():
        names = [name for name in planar_sets() if name.split()[0] == word]
        inverse = [1.0 / computed(name).conductance for name in names]
        draw_profile(axes, inverse, [_mean(results, name) for name in names], look)
    reach = np.geomspace(4.0, 160.0, 2)
    for bound, line, label in (
        (reach / 2.0, ':', '1 / (2 \u03a6)'),
        (2.0 * reach**2, '--', '2 / \u03a6\u00b2'),
    ):
        axes.plot(reach, bound, line, color=FAINT_INK, linewidth=1.2, label=label)
    axes.set(xscale='log', yscale='log')
    axes.minorticks_off()
    style(axes, 'Relaxation time of Hit-and-Run', '1 / \u03a6, of the best cut', 'steps')
    legend(axes, 'upper left')


def relaxation_table(results: Results) -> str:
    """Return a table of conductances, computed and measured times, and mixing steps."""
    header = ['set', '\u03a6', '1 / (2 \u03a6)', 'relaxation time, computed', 'measured', 'steps']
    rows = []
    for name in planar_sets():
        conductance, relaxation = computed(name)
        half = f'{0.5 / conductance:.2f}'
        mixed = format_steps(results.where(shape=name, walk='hit_and_run'))
        times = half, f'{relaxation:.2f}', _mean(results, name), mixed
        rows.append([name, f'{conductance:.4f}', *times])
    return markdown(header, rows)


def _mean(results: Results, name: str) -> Mean:
    return results.where(shape=name, walk='hit_and_run').mean('relaxation')
