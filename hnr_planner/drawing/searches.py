"""Draw the samples of a search, their tree, and a path between two ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hnr_planner.drawing.style import AGES, GOAL, PATH, START
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patheffects import Normal, Stroke
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

#: Most outlines of a footprint that are drawn along a path, and how strong the tint of the colour
#: is that fills what they sweep.
OUTLINES_MAX, SWEPT_TINT = 40, 0.16


def draw_tree(axes: Axes, samples: ArrayLike, parents: ArrayLike) -> None:
    """
    Draw the edge from every sample to its parent; samples may form chains or several trees.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes to draw on.
    samples : (k, 2) array_like
        Points [m].
    parents : (k,) array_like of int
        Row in ``samples`` of each sample's parent, -1 for a root, which has no edge.

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
        The axes to draw on.
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


def draw_sample_cells(axes: Axes, samples: ArrayLike, side: float) -> None:
    """
    Draw samples as the squares of a lattice that contain them.

    Squares are sharp at any size, and take a tenth of the bytes that discs take in a file.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes to draw on.
    samples : (k, 2) array_like
        At least one point [m], in the order in which they were drawn; a square has the colour of
        the last sample in it.
    side : float
        Side of the squares [m].

    """
    columns, rows = np.floor(np.asarray(samples, dtype=float) / side).astype(int).T
    left, low = columns.min(), rows.min()
    ages = np.full((rows.max() - low + 1, columns.max() - left + 1), np.nan)
    ages[rows - low, columns - left] = _ages(len(rows))
    height, width = ages.shape
    axes.imshow(
        ages,
        origin='lower',
        extent=(left * side, (left + width) * side, low * side, (low + height) * side),
        cmap=AGES,
        vmin=0,
        vmax=1,
        interpolation='none',
        zorder=3,
    )


def draw_path(axes: Axes, path: ArrayLike, *, colour: str = PATH) -> None:
    """Draw the path, an (m, 2) array of points [m], as a bold line with a white outline."""
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


def draw_footprints(axes: Axes, outlines: Sequence[ArrayLike], *, colour: str = PATH) -> None:
    """
    Draw what a footprint sweeps, lightly, and some of its outlines.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes to draw on.
    outlines : sequence of (n, 2) array_like
        The footprint at poses that follow each other closely on a path [m]; at least one.
    colour : str
        Colour of the outlines; what is swept has a light tint of it.

    """
    polygons = [np.asarray(outline, dtype=float) for outline in outlines]
    tint = tuple(1.0 - SWEPT_TINT * (1.0 - part) for part in to_rgb(colour))
    swept = PolyCollection(polygons, facecolors=[tint], edgecolors=[tint], linewidths=0.3)
    swept.set(zorder=1, rasterized=True)
    axes.add_collection(swept, autolim=False)
    shown = np.unique(np.linspace(0, len(polygons) - 1, OUTLINES_MAX).astype(int))
    sides = PolyCollection([polygons[k] for k in shown], facecolors='none', edgecolors=[colour])
    sides.set(zorder=4, linewidths=0.7, alpha=0.7)
    axes.add_collection(sides, autolim=False)


def draw_ends(axes: Axes, start: ArrayLike, goal: ArrayLike) -> None:
    """Mark the start with a disc and the goal with a star; both are points (x, y) [m]."""
    for point, colour, shape, size in ((start, START, 'o', 80), (goal, GOAL, '*', 210)):
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


def _ages(count: int) -> NDArray[np.float64]:
    """
    Return the ages (count,) of samples in their order: from 0, the first, to 1, the last.

    A single sample has the age 1.
    """
    return np.linspace(0.0, 1.0, count) if count > 1 else np.ones(count)
