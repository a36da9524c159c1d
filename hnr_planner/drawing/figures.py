"""Make whole figures: plans side by side over a map, and the samples of a walk."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, TYPE_CHECKING

from hnr_planner.drawing.maps import cell_kinds, draw_map, kinds_present, known_box
from hnr_planner.drawing.searches import (
    draw_ends,
    draw_footprints,
    draw_path,
    draw_samples,
    draw_tree,
)
from hnr_planner.drawing.style import (
    AGES,
    draw_title,
    FAINT_INK,
    FRAME,
    GOAL,
    INK,
    KINDS,
    OTHER_PATH,
    PATH,
    START,
)
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np

if TYPE_CHECKING:
    from hnr_planner.maps import OccupancyMap
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray


class Plan(NamedTuple):
    """
    Path and samples of one search, for one panel of a figure.

    ``path`` is (m, 2), ``samples`` (k, 2) and each of ``others``, further paths, (n, 2); points
    are (x, y) in the map frame [m]. ``parents`` (k,) has the row in ``samples`` of each sample's
    parent, -1 for a root. ``outlines`` are footprints (n, 2) of the robot, closely along the path.
    """

    title: str
    path: NDArray[np.float64]
    samples: NDArray[np.float64]
    parents: NDArray[np.int64]
    start: tuple[float, float]
    goal: tuple[float, float]
    others: Sequence[NDArray[np.float64]] = ()
    outlines: Sequence[NDArray[np.float64]] = ()


def figure_of_plans(
    occupancy: OccupancyMap,
    plans: Sequence[Plan],
    *,
    blocked: NDArray[np.bool_] | None = None,
) -> Figure:
    """
    Return a figure with one panel for each plan, side by side over the same map.

    Parameters
    ----------
    occupancy : OccupancyMap
        The map of all panels.
    plans : sequence of Plan
        At least one plan; a path without points is not drawn.
    blocked
        (rows, cols) bool, optional: cells that the planner may not enter.

    """
    figure, panels = _panels(occupancy, len(plans))
    for axes, plan in zip(panels, plans, strict=True):
        draw_map(axes, occupancy, blocked)
        if len(plan.outlines):
            draw_footprints(axes, plan.outlines)
        draw_tree(axes, plan.samples, plan.parents)
        draw_samples(axes, plan.samples)
        for path in plan.others[::-1]:
            draw_path(axes, path, colour=OTHER_PATH)
        if len(plan.path):
            draw_path(axes, plan.path)
        draw_ends(axes, plan.start, plan.goal)
        draw_title(axes, plan.title)
    for axes in panels[1:]:
        axes.set_ylabel('')
    handles = [*_cell_handles(occupancy, blocked), _line(PATH, 'path')]
    if any(plan.others for plan in plans):
        handles.append(_line(OTHER_PATH, 'other paths'))
    handles += [_mark(START, 'o', 9, 'start'), _mark(GOAL, '*', 14, 'goal')]
    _legend(figure, handles, n_columns=len(handles) if len(panels) > 1 else 4)
    _age_scale(figure, panels[-1])
    return figure


def figure_of_samples(
    occupancy: OccupancyMap,
    samples: ArrayLike,
    *,
    title: str,
    blocked: NDArray[np.bool_] | None = None,
) -> Figure:
    """
    Return a figure of the map with the points (k, 2) [m] of a walk, coloured in their order.

    ``blocked`` (rows, cols) are the cells that the walk may not enter, as for ``draw_map``.
    """
    figure, (axes,) = _panels(occupancy, 1)
    draw_map(axes, occupancy, blocked)
    draw_samples(axes, samples)
    draw_title(axes, title)
    _legend(figure, _cell_handles(occupancy, blocked), n_columns=4)
    _age_scale(figure, axes)
    return figure


def save(figure: Figure, file: str | Path) -> None:
    """Write a figure to a file; the file's suffix (.png, .svg, .pdf) chooses the format."""
    figure.savefig(file, dpi=160, facecolor='white', bbox_inches='tight', pad_inches=0.12)


def _panels(occupancy: OccupancyMap, count: int) -> tuple[Figure, list[Axes]]:
    """Return a figure of ``count`` panels, side by side, whose shape suits the map."""
    width, height = np.ptp(known_box(occupancy), axis=0)
    panel_width = 6.4 if count == 1 else 6.0
    panel_height = float(np.clip(panel_width * height / width, 2.2, 9.0))
    figure = Figure(figsize=(count * panel_width + 0.4, panel_height + 0.6), layout='constrained')
    return figure, list(figure.subplots(1, count, squeeze=False)[0])


def _legend(figure: Figure, handles: Sequence[Patch | Line2D], n_columns: int) -> None:
    """Add one legend for all panels to a figure, below the panels."""
    figure.legend(
        handles=handles,
        loc='upper center',
        bbox_to_anchor=(0.5, 0.0),
        ncols=n_columns,
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        handlelength=1.4,
        columnspacing=1.6,
    )


def _cell_handles(
    occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None
) -> list[Patch | Line2D]:
    """Return one entry of the legend for each kind of cell that occurs on the map."""
    kinds = (KINDS[kind] for kind in kinds_present(cell_kinds(occupancy, blocked)))
    return [
        Patch(facecolor=colour, edgecolor=FRAME, linewidth=0.5, label=label)
        for label, colour in kinds
    ]


def _line(colour: str, label: str) -> Line2D:
    """Return the entry of the legend for a path."""
    return Line2D([], [], color=colour, linewidth=2.4, label=label)


def _mark(colour: str, shape: str, size: float, label: str) -> Line2D:
    """Return the entry of the legend for a mark of a size in points."""
    return Line2D(
        [],
        [],
        color=colour,
        marker=shape,
        markersize=size,
        markeredgecolor='white',
        linestyle='none',
        label=label,
    )


def _age_scale(figure: Figure, axes: Axes) -> None:
    """Add the scale of the samples' colours to a figure, at the right of ``axes``."""
    beside = axes.inset_axes((1.025, 0, 0.022, 1))
    scale = figure.colorbar(ScalarMappable(Normalize(0, 1), AGES), cax=beside)
    scale.set_ticks([0, 1], labels=['first', 'last'])
    scale.set_label('samples, in their order', color=FAINT_INK, fontsize=9, labelpad=-8)
    beside.tick_params(colors=FAINT_INK, labelsize=8, length=0)
    for spine in beside.spines.values():
        spine.set_visible(False)
