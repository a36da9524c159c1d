"""Draw the samples of a search, their tree, and a path between two ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hnr_planner.drawing.style import AGES, GOAL, PATH, START
from matplotlib.collections import LineCollection
from matplotlib.patheffects import Normal, Stroke
import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray


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
