"""
Steps that Hit-and-Run takes until it is mixed, as the dimension n of a set grows.

The chains count as mixed when the total variation distance between their distribution and the
uniform one is below ``MIXED``. The measured steps are compared with the paper's bound: Theorem 5
bounds the steps by C' n^6 log(M / epsilon), where M bounds the density of the start relative to
the uniform density and epsilon is the distance wanted. The theorem leaves the constant C' open.
Lemmas 13 and 6 give a number for the ball, the only set here whose boundary meets the theorem's
assumption on curvature.
"""

from collections.abc import Sequence

from hnr_planner.core.theory import BallImage, mixing_bound, printed_conductance
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments.figures import draw_profile, legend, Look, style
from hnr_planner.experiments.mixing.solids import SOLIDS
from hnr_planner.experiments.mixing.variation import between, format_steps, MIXED, steps
from hnr_planner.experiments.results import markdown, Mean, Results
from matplotlib.axes import Axes
import numpy as np
from numpy.typing import NDArray

#: Dimensions of the solids.
DIMENSIONS = (2, 3, 5, 8, 12, 20, 30)
#: Two ranges of dimensions in which an exponent of n is fitted: the two exponents agree if the
#: steps grow like one power of n.
LOW, HIGH = DIMENSIONS[:4], DIMENSIONS[3:]
#: Bound M on the density of the start, relative to the uniform one, in the paper's bound.
WARMTH = 2.0
LOOKS = {
    'simplex': Look('simplex', '#D55E00', 's'),
    'joined boxes': Look('two joined boxes', '#009E73', '^'),
    'cube': Look('cube', '#0072B2', 'o'),
    'crossed beams': Look('crossed beams (star-shaped)', '#CC79A7', 'D'),
    'cube, from a half': Look('cube, from a half of it', '#56B4E9', 'v'),
    'ball': Look('ball', '#E69F00', 'P'),
}


def bound(dim: int) -> float:
    """
    Return the paper's bound on the steps of Hit-and-Run until mixed in the ball of volume 1.

    The bound is as printed, for a start of density at most ``WARMTH`` and the distance ``MIXED``.
    """
    return mixing_bound(printed_conductance(BallImage.unit_ball(dim)), WARMTH, MIXED)


def exponents(results: Results, dimensions: Sequence[int]) -> Mean:
    """
    Return the mean over the runs of the exponent of n that fits the steps until mixed.

    ``results`` are those of one set; of them, those of ``dimensions`` are fitted. The steps of a
    run are the middle of its two estimates.
    """
    each = [results.where(dim=dim) for dim in dimensions]
    middle = np.array([(rows['first'] + rows['last']) / 2.0 for rows in each])
    return Results({'exponent': _slopes(dimensions, middle)}).mean('exponent')


def _slopes(dimensions: Sequence[int], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slope (k,) of each column of log(values) (n_dimensions, k) by log(dimensions)."""
    slopes: NDArray[np.float64] = np.polyfit(np.log(dimensions), np.log(values), 1)[0]
    return slopes


def draw_dimensions(axes: Axes, results: Results) -> None:
    """Draw the steps until mixed against the dimension n for each set, and a line of slope n^6."""
    for name, look in LOOKS.items():
        here = results.where(shape=name)
        each = [steps(here.where(dim=dim)) for dim in DIMENSIONS]
        label = f'{look.label}: $n^{{{exponents(here, HIGH).value:.1f}}}$'
        draw_profile(axes, DIMENSIONS, [between(*both) for both in each], look, label=label)
    reach = np.array([2.0, 9.0])
    axes.plot(reach, 2.0 * (reach / 2.0) ** 6, color=FAINT_INK, linewidth=1.2, linestyle='--')
    axes.annotate('the slope of $n^6$', (9.3, 14_000.0), color=FAINT_INK, fontsize=9)
    axes.set(xscale='log', yscale='log', ylim=(1.0, 3e6))
    axes.set_xticks(DIMENSIONS, [str(dim) for dim in DIMENSIONS])
    axes.minorticks_off()
    style(axes, 'Steps of Hit-and-Run until mixed', 'dimension n', 'steps')
    legend(axes, 'upper left')


def dimensions_table(results: Results) -> str:
    """Return a table of steps until mixed by dimension and set, bounds, and fitted exponents."""
    rows: list[list[object]] = [
        [
            dim,
            *(format_steps(results.where(shape=name, dim=dim)) for name in SOLIDS),
            f'{bound(dim):.1e}',
        ]
        for dim in DIMENSIONS
    ]
    for dimensions in (LOW, HIGH):
        of_bound = _slopes(dimensions, np.array([[bound(dim)] for dim in dimensions]))[0]
        rows.append(
            [
                f'power of n, {dimensions[0]} to {dimensions[-1]}',
                *(exponents(results.where(shape=name), dimensions) for name in SOLIDS),
                f'{of_bound:.2f}',
            ]
        )
    return markdown(['dimension n', *SOLIDS, f'bound for the ball, M = {WARMTH:.0f}'], rows)
