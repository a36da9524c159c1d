"""
The common style of the experiments' figures.

Every algorithm has the same colour, marker and name in all figures. The colours are distinct for
people with any kind of colour vision, and the markers are distinct in greyscale. Lines are means,
the bands around them 95 % intervals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, NamedTuple

from hnr_planner.drawing import draw_title, FAINT_INK, FRAME, INK
from hnr_planner.experiments.results import Mean
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import ArrayLike, NDArray


class Look(NamedTuple):
    """The look of an algorithm in figures: label, colour and matplotlib marker."""

    label: str
    colour: str
    mark: str


#: Label, colour and marker of each algorithm.
LOOKS = {
    'hit_and_run': Look('Hit-and-Run', '#0072B2', 'o'),
    'rrt': Look('RRT', '#D55E00', 's'),
    'auto': Look('two trees (auto)', '#009E73', '^'),
    'a_star': Look('A*', '#CC79A7', 'D'),
    'wavefront': Look('wavefront (as NavFn)', '#E69F00', 'v'),
}
Location = Literal['best', 'upper left', 'upper right', 'lower left', 'lower right']
#: Opacity of the band of an interval.
BAND = 0.18
#: A line of this many points or more has smaller markers.
MANY = 15


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of a width and height [inches], without pyplot's global state."""
    return Figure(figsize=(width, height), layout='constrained')


def style(axes: Axes, title: str, x: str, y: str) -> None:
    """Set title and axis labels, and reduce the frame to two thin spines and a grid."""
    draw_title(axes, title)
    axes.set_xlabel(x, color=INK, fontsize=9.5)
    axes.set_ylabel(y, color=INK, fontsize=9.5)
    axes.tick_params(colors=FAINT_INK, labelsize=9)
    axes.grid(True, which='major', color='#E4E7EA', linewidth=0.8)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ('left', 'bottom'))
        spine.set_color(FRAME)


def draw_profile(
    axes: Axes,
    x: ArrayLike,
    means: Sequence[Mean],
    look: Look,
    *,
    label: str | None = None,
    line: str = '-',
) -> None:
    """Draw ``k`` means at ``x`` (k,) as a line, and their 95 % intervals as a band around it."""
    values, halves = np.array(means).T
    axes.fill_between(
        x, values - halves, values + halves, color=look.colour, alpha=BAND, linewidth=0
    )
    axes.plot(
        x,
        values,
        line,
        color=look.colour,
        marker=look.mark,
        markersize=5.5 if len(values) < MANY else 3.5,
        markerfacecolor=look.colour if line == '-' else 'white',
        linewidth=1.8,
        label=label or look.label,
    )


def draw_bars(
    axes: Axes,
    names: Sequence[str],
    groups: Mapping[str, Sequence[Mean]],
    colours: Sequence[str],
) -> None:
    """
    Draw one horizontal bar with its 95 % interval for each name in each group.

    The bars of a name lie together. Those of later groups are paler and below those of earlier
    ones. ``groups`` has one mean for each name, and ``colours`` one colour for each name.
    """
    thickness = 0.8 / len(groups)
    at = np.arange(len(names))[::-1]
    for k, (group, means) in enumerate(groups.items()):
        values, halves = np.array(means).T
        axes.barh(
            at + (0.5 * (len(groups) - 1) - k) * thickness,
            values,
            0.92 * thickness,
            xerr=halves,
            color=[_paler(colour, k) for colour in colours],
            error_kw={'ecolor': INK, 'elinewidth': 1.0},
        )
        axes.barh([0], [np.nan], color=_paler(FAINT_INK, k), label=group)  # for the legend
    axes.set_yticks(at, names)


def _paler(colour: str, times: int) -> NDArray[np.float64]:
    """Return a colour (3,) as RGB in [0, 1], mixed with 55 % white ``times`` times."""
    return 1.0 - 0.45**times * (1.0 - np.array(to_rgb(colour)))


def legend(axes: Axes, location: Location = 'best') -> None:
    """Add a legend without a frame at a location, one of matplotlib's names."""
    axes.legend(loc=location, frameon=False, fontsize=9, labelcolor=INK)


def sign(figure: Figure, text: str) -> None:
    """Print ``text`` at the foot of a figure, in small type."""
    figure.supxlabel(text, x=0.01, ha='left', fontsize=7.5, color=FAINT_INK)


def save(figure: Figure, file: Path) -> None:
    """
    Write a figure to a file whose ending selects the format.

    In an SVG file the same results give the same bytes, and text stays text.
    """
    with rc_context({'svg.hashsalt': 'hnr_planner', 'svg.fonttype': 'none'}):
        figure.savefig(
            file, dpi=200, facecolor='white', metadata={'Date': None}, bbox_inches='tight'
        )
