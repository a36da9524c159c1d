"""
Pictures of maps, samples and paths.

Every ``draw_*`` function puts one thing on a matplotlib axes whose unit is the metre of the map
frame; ``figure_of_plans`` and ``figure_of_samples`` put them together. Figures are made without
pyplot, so nothing global is touched and no display is needed. The colours are those of Okabe and
Ito, which people with any kind of colour vision can tell apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, TYPE_CHECKING

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import Normal, Stroke
from matplotlib.transforms import Affine2D
import numpy as np

if TYPE_CHECKING:
    from hnr_planner.maps import OccupancyMap
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

INK = '#22262B'
FAINT_INK = '#6B737C'
UNKNOWN = '#D3D7DB'
KINDS = (
    ('free', '#FFFFFF'),
    ('too near for the robot', '#F6E7CB'),
    ('unknown', UNKNOWN),
    ('occupied', '#2E343B'),
)
"""What a cell can be, and its colour."""
PATH = '#D55E00'
OTHER_PATH = '#E69F00'
START = '#009E73'
GOAL = '#CC79A7'
AGES = LinearSegmentedColormap.from_list('ages', ('#A9D8F5', '#56B4E9', '#0072B2', '#1B2A5C'))
"""Colour of a sample, from the first of a search (light) to the last (dark)."""


class Plan(NamedTuple):
    """What a picture shows of one search; points are (x, y) in metres."""

    title: str
    path: NDArray[np.float64]
    samples: NDArray[np.float64]
    parents: NDArray[np.int64]
    start: tuple[float, float]
    goal: tuple[float, float]
    others: Sequence[NDArray[np.float64]] = ()


def draw_map(
    axes: Axes,
    occupancy: OccupancyMap,
    *,
    blocked: NDArray[np.bool_] | None = None,
    occupied_threshold: int = 65,
) -> None:
    """
    Draw the cells of a map and fit the axes to the part of it that is known.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    occupancy : OccupancyMap
        The map.
    blocked : (rows, cols) bool, optional
        Cells that the planner may not enter; those that are neither occupied nor unknown are
        what the robot's radius takes away, and are drawn in a light colour of their own.
    occupied_threshold : int
        Values from here on are occupied, 0..100.

    """
    kinds = cell_kinds(occupancy, blocked, occupied_threshold)
    colours = np.round(255 * to_rgba_array([colour for _, colour in KINDS])).astype(np.uint8)
    rows, cols = kinds.shape
    axes.imshow(
        colours[kinds],
        origin='lower',
        extent=(0, cols, 0, rows),
        transform=_to_map_frame(occupancy) + axes.transData,
        interpolation_stage='rgba',
        zorder=0,
    )
    (left, low), (right, high) = known_box(occupancy)
    axes.set(xlim=(left, right), ylim=(low, high), aspect='equal')
    _style(axes)


def draw_tree(axes: Axes, samples: ArrayLike, parents: ArrayLike) -> None:
    """
    Draw the edge from every sample to its parent: a chain, a tree or several.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    samples : (k, 2) array_like
        Points [m].
    parents : (k,) array_like of int
        Row of each sample's parent, -1 for a root.

    """
    points, parent_rows = np.asarray(samples, dtype=float), np.asarray(parents, dtype=int)
    children = np.flatnonzero(parent_rows >= 0)
    if children.size == 0:
        return
    edges = np.stack((points[parent_rows[children]], points[children]), axis=1)
    axes.add_collection(
        LineCollection(
            list(edges),
            colors=AGES(_ages(len(points))[children]),
            linewidths=0.5,
            alpha=float(np.clip(400 / len(edges), 0.05, 0.5)),
            rasterized=True,
            zorder=2,
        ),
        autolim=False,
    )


def draw_samples(axes: Axes, samples: ArrayLike) -> None:
    """
    Draw the samples of one search or walk, the first ones light and the last ones dark.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    samples : (k, 2) array_like
        Points [m], in the order in which they were drawn.

    """
    points = np.asarray(samples, dtype=float).reshape(-1, 2)
    axes.scatter(
        points[:, 0],
        points[:, 1],
        s=float(np.clip(9000 / max(len(points), 1), 1.2, 14)),
        c=_ages(len(points)),
        cmap=AGES,
        vmin=0,
        vmax=1,
        linewidths=0,
        alpha=float(np.clip(2500 / max(len(points), 1), 0.35, 0.9)),
        rasterized=True,
        zorder=3,
    )


def draw_path(axes: Axes, path: ArrayLike, *, colour: str = PATH) -> None:
    """Draw the path, an (m, 2) array of points [m], bold and set off from what lies below."""
    points = np.asarray(path, dtype=float).reshape(-1, 2)
    axes.plot(
        points[:, 0],
        points[:, 1],
        color=colour,
        linewidth=2.4,
        solid_capstyle='round',
        solid_joinstyle='round',
        path_effects=[Stroke(linewidth=4.6, foreground='white'), Normal()],
        scalex=False,
        scaley=False,
        zorder=4,
    )


def draw_ends(axes: Axes, start: ArrayLike, goal: ArrayLike | None = None) -> None:
    """Mark the start with a disc and the goal, if there is one, with a star; both are (2,) [m]."""
    marks = [(start, START, 'o', 80)]
    if goal is not None:
        marks.append((goal, GOAL, '*', 210))
    for point, colour, shape, size in marks:
        x, y = np.asarray(point, dtype=float)
        axes.scatter(
            [x],
            [y],
            s=size,
            color=colour,
            marker=shape,
            edgecolors='white',
            linewidths=1.2,
            zorder=5,
        )


def figure_of_plans(
    occupancy: OccupancyMap,
    plans: Sequence[Plan],
    *,
    blocked: NDArray[np.bool_] | None = None,
    occupied_threshold: int = 65,
) -> Figure:
    """
    Return a figure with one panel for each plan, side by side over the same map.

    Parameters
    ----------
    occupancy : OccupancyMap
        The map of all panels.
    plans : sequence of Plan
        At least one; an empty path draws none.
    blocked, occupied_threshold
        As for `draw_map`.

    """
    figure, panels = _panels(occupancy, len(plans))
    for axes, plan in zip(panels, plans, strict=True):
        draw_map(axes, occupancy, blocked=blocked, occupied_threshold=occupied_threshold)
        draw_tree(axes, plan.samples, plan.parents)
        draw_samples(axes, plan.samples)
        for path in plan.others[::-1]:
            draw_path(axes, path, colour=OTHER_PATH)
        if len(plan.path):
            draw_path(axes, plan.path)
        draw_ends(axes, plan.start, plan.goal)
        axes.set_title(plan.title, loc='left', fontsize=10.5, color=INK, pad=8)
    for axes in panels[1:]:
        axes.set_ylabel('')
    kinds = np.unique(cell_kinds(occupancy, blocked, occupied_threshold))
    _legend(figure, panels, kinds, ends=True, others=any(plan.others for plan in plans))
    return figure


def figure_of_samples(
    occupancy: OccupancyMap,
    samples: ArrayLike,
    *,
    title: str,
    blocked: NDArray[np.bool_] | None = None,
    occupied_threshold: int = 65,
) -> Figure:
    """Return a figure of the map with the points (k, 2) of a walk, coloured in their order."""
    figure, (axes,) = _panels(occupancy, 1)
    draw_map(axes, occupancy, blocked=blocked, occupied_threshold=occupied_threshold)
    draw_samples(axes, samples)
    axes.set_title(title, loc='left', fontsize=10.5, color=INK, pad=8)
    kinds = np.unique(cell_kinds(occupancy, blocked, occupied_threshold))
    _legend(figure, [axes], kinds, ends=False)
    return figure


def save(figure: Figure, file: str | Path) -> None:
    """Write the figure to a file; its ending (.png, .svg, .pdf) chooses the format."""
    figure.savefig(file, dpi=160, facecolor='white', bbox_inches='tight', pad_inches=0.12)


def cell_kinds(
    occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None, occupied_threshold: int
) -> NDArray[np.int8]:
    """Return what each cell (rows, cols) is, as a row of `KINDS`."""
    data = np.asarray(occupancy.data)
    known = (data >= 0) & (data <= 100)
    kinds = np.where(known, 0, 2).astype(np.int8)
    if blocked is not None:
        kinds[known & blocked] = 1
    kinds[known & (data >= occupied_threshold)] = 3
    return kinds


def _to_map_frame(occupancy: OccupancyMap) -> Affine2D:
    """Return the transform from (column, row) to (x, y) in metres."""
    x, y, yaw = occupancy.origin
    return Affine2D().scale(occupancy.resolution).rotate(yaw).translate(x, y)


def known_box(occupancy: OccupancyMap) -> NDArray[np.float64]:
    """Return the box ((x, y) low, (x, y) high) [m] around the known cells, with a margin."""
    data = np.asarray(occupancy.data)
    known = (data >= 0) & (data <= 100)
    if not known.any():
        known[:] = True
    rows = np.flatnonzero(known.any(axis=1))
    first = known[rows].argmax(axis=1)
    last = known.shape[1] - known[rows, ::-1].argmax(axis=1)
    corners = [(col, row + side) for col in (first, last) for row, side in ((rows, 0), (rows, 1))]
    points = _to_map_frame(occupancy).transform(np.hstack(corners).T)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.012 * (high - low).max()
    return np.array((low - margin, high + margin))


def _style(axes: Axes) -> None:
    """Label the axes in metres, with little ink."""
    axes.set_xlabel('x [m]', color=FAINT_INK, fontsize=9)
    axes.set_ylabel('y [m]', color=FAINT_INK, fontsize=9)
    axes.tick_params(colors=FAINT_INK, labelsize=8, length=3)
    axes.set_facecolor(UNKNOWN)
    for spine in axes.spines.values():
        spine.set_color('#B4BAC1')
        spine.set_linewidth(0.8)


def _ages(count: int) -> NDArray[np.float64]:
    """Return the place of each of `count` samples in their order, from 0 to 1."""
    return np.linspace(0.0, 1.0, count) if count > 1 else np.ones(count)


def _panels(occupancy: OccupancyMap, count: int) -> tuple[Figure, list[Axes]]:
    """Return a figure of `count` panels, side by side, whose shape suits the map."""
    width, height = np.ptp(known_box(occupancy), axis=0)
    panel_width = 6.4 if count == 1 else 6.0
    panel_height = float(np.clip(panel_width * height / width, 2.2, 9.0))
    figure = Figure(figsize=(count * panel_width + 0.4, panel_height + 0.6), layout='constrained')
    FigureCanvasAgg(figure)
    return figure, list(figure.subplots(1, count, squeeze=False)[0])


def _legend(
    figure: Figure,
    panels: list[Axes],
    kinds: NDArray[np.int8],
    *,
    ends: bool,
    others: bool = False,
) -> None:
    """Add one legend of what is there for all panels, and the scale of the samples' colours."""
    handles: list[Patch | Line2D] = [
        Patch(facecolor=colour, edgecolor='#B4BAC1', linewidth=0.5, label=label)
        for label, colour in (KINDS[kind] for kind in kinds)
    ]
    if ends:
        handles += [
            Line2D([], [], color=PATH, linewidth=2.4, label='path'),
            *[Line2D([], [], color=OTHER_PATH, linewidth=2.4, label='other paths')] * others,
            _mark(START, 'o', 9, 'start'),
            _mark(GOAL, '*', 14, 'goal'),
        ]
    figure.legend(
        handles=handles,
        loc='upper center',
        bbox_to_anchor=(0.5, 0.0),
        ncols=len(handles) if len(panels) > 1 else 4,
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        handlelength=1.4,
        columnspacing=1.6,
    )
    beside_the_last = panels[-1].inset_axes((1.025, 0, 0.022, 1))
    scale = figure.colorbar(ScalarMappable(Normalize(0, 1), AGES), cax=beside_the_last)
    scale.set_ticks([0, 1], labels=['first', 'last'])
    scale.set_label('samples, in their order', color=FAINT_INK, fontsize=9, labelpad=-8)
    beside_the_last.tick_params(colors=FAINT_INK, labelsize=8, length=0)
    for spine in beside_the_last.spines.values():
        spine.set_visible(False)


def _mark(colour: str, shape: str, size: float, label: str) -> Line2D:
    """Return a mark for the legend."""
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
