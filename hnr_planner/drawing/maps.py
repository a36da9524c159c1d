"""Maps: what every cell is, in its colour."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hnr_planner.drawing.style import FAINT_INK, FRAME, KINDS, UNKNOWN
from matplotlib.colors import to_rgba_array
from matplotlib.transforms import Affine2D
import numpy as np

if TYPE_CHECKING:
    from hnr_planner.maps import OccupancyMap
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


#: Values of a map from here on are occupied, 0..100.
OCCUPIED_FROM = 65


def draw_map(
    axes: Axes, occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None = None
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

    """
    kinds = cell_kinds(occupancy, blocked)
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


def cell_kinds(
    occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None = None
) -> NDArray[np.int8]:
    """Return what each cell (rows, cols) is, as a row of `KINDS`."""
    data = np.asarray(occupancy.data)
    known = _known(data)
    kinds = np.where(known, 0, 2).astype(np.int8)
    if blocked is not None:
        kinds[known & blocked] = 1
    kinds[known & (data >= OCCUPIED_FROM)] = 3
    return kinds


def known_box(occupancy: OccupancyMap) -> NDArray[np.float64]:
    """Return the box ((x, y) low, (x, y) high) [m] around the known cells, with a margin."""
    known = _known(np.asarray(occupancy.data))
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


def _known(data: NDArray[np.int8]) -> NDArray[np.bool_]:
    return (data >= 0) & (data <= 100)


def _to_map_frame(occupancy: OccupancyMap) -> Affine2D:
    """Return the transform from (column, row) to (x, y) in metres."""
    x, y, yaw = occupancy.origin
    return Affine2D().scale(occupancy.resolution).rotate(yaw).translate(x, y)


def _style(axes: Axes) -> None:
    """Label the axes in metres, with little ink."""
    axes.set_xlabel('x [m]', color=FAINT_INK, fontsize=9)
    axes.set_ylabel('y [m]', color=FAINT_INK, fontsize=9)
    axes.tick_params(colors=FAINT_INK, labelsize=8, length=3)
    axes.set_facecolor(UNKNOWN)
    for spine in axes.spines.values():
        spine.set_color(FRAME)
        spine.set_linewidth(0.8)
