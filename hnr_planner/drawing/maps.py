"""Draw the cells of a map, each in the colour of its kind: free, unknown and so on."""

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


#: Values of a map from here to 100 are drawn as occupied.
OCCUPIED_FROM = 65
#: Side of the largest image of a map [pixels]; cells of larger maps are averaged in blocks, which
#: no figure is large enough to show.
LARGEST_SIDE = 4000
#: About how many cells are averaged at a time, to save memory.
_STRIP = 2**22
#: The kind of each cell value, by the value as an unsigned byte; 0 free, 2 unknown, 3 occupied.
_KIND_OF_VALUE = np.full(256, 2, np.uint8)
_KIND_OF_VALUE[:OCCUPIED_FROM] = 0
_KIND_OF_VALUE[OCCUPIED_FROM:101] = 3


def draw_map(
    axes: Axes, occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None = None
) -> None:
    """
    Draw the cells of a map and fit the axes to the part of it that is known.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes to draw on.
    occupancy : OccupancyMap
        The map.
    blocked : (rows, cols) bool, optional
        Cells that the planner may not enter; those that are neither occupied nor unknown are
        blocked by the robot's radius alone, and drawn in a light colour of their own.

    """
    image, block = _image(cell_kinds(occupancy, blocked))
    rows, cols = image.shape[:2]
    axes.imshow(
        image,
        origin='lower',
        extent=(0, cols * block, 0, rows * block),
        transform=_to_map_frame(occupancy) + axes.transData,
        interpolation_stage='rgba',
        zorder=0,
    )
    (left, low), (right, high) = known_box(occupancy)
    axes.set(xlim=(left, right), ylim=(low, high), aspect='equal')
    _style(axes)


def cell_kinds(
    occupancy: OccupancyMap, blocked: NDArray[np.bool_] | None = None
) -> NDArray[np.uint8]:
    """
    Return the kind of each cell (rows, cols), as an index of ``KINDS``.

    A free cell that is ``blocked`` (rows, cols) is too near for the robot; with None no cell is.
    """
    kinds: NDArray[np.uint8] = _KIND_OF_VALUE[_as_bytes(occupancy)]
    if blocked is not None:
        kinds[(kinds == 0) & blocked] = 1
    return kinds


def kinds_present(kinds: NDArray[np.uint8]) -> list[int]:
    """Return the indices of ``KINDS`` that occur among cells, in increasing order."""
    return [kind for kind in range(len(KINDS)) if (kinds == kind).any()]


def known_box(occupancy: OccupancyMap) -> NDArray[np.float64]:
    """
    Return the box ((x, y) low, (x, y) high) [m] in the map frame around the known cells.

    Its sides are parallel to the axes of the map frame, with a margin of 1.2 % of the longer side.
    Where no cell is known the box is around all cells.
    """
    known = _as_bytes(occupancy) <= 100
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


def _image(kinds: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], int]:
    """
    Return the pixels (rows, cols, 4) of an image of cells, and the side of a pixel in cells.

    The colours are red, green, blue and alpha in 0..255. A pixel is the mean of its
    block of cells; a block at the last rows or columns may be smaller.
    """
    colours = np.round(255 * to_rgba_array([colour for _, colour in KINDS])).astype(np.uint8)
    block = -(-max(kinds.shape) // LARGEST_SIDE)
    if block == 1:
        return colours[kinds], block
    columns = np.arange(0, kinds.shape[1], block)
    n_rows = max(_STRIP // (kinds.shape[1] * block), 1) * block
    strips = []
    for first in range(0, len(kinds), n_rows):
        strip = kinds[first:][:n_rows]
        rows = np.arange(0, len(strip), block)
        total = np.zeros((len(rows), len(columns), 4))
        for kind, colour in enumerate(colours):
            is_kind = (strip == kind).view(np.uint8)
            counts = np.add.reduceat(is_kind, rows, axis=0, dtype=np.uint32)
            counts = np.add.reduceat(counts, columns, axis=1)
            total += counts[..., np.newaxis] * colour.astype(float)
        strips.append(np.round(255 * total / total[..., 3:]).astype(np.uint8))
    return np.concatenate(strips), block


def _as_bytes(occupancy: OccupancyMap) -> NDArray[np.uint8]:
    """Return the values of the cells (rows, cols) as unsigned bytes; -1 becomes 255."""
    return np.asarray(occupancy.data, dtype=np.int8).view(np.uint8)


def _to_map_frame(occupancy: OccupancyMap) -> Affine2D:
    """
    Return the transform from (column, row) of the grid to (x, y) [m] in the map frame.

    (0, 0) is the outer corner of cell [0, 0], so that cell centres are at halves.
    """
    x, y, yaw = occupancy.origin
    return Affine2D().scale(occupancy.resolution).rotate(yaw).translate(x, y)


def _style(axes: Axes) -> None:
    """Label the axes in metres, in faint colours, on a background as for unknown cells."""
    axes.set_xlabel('x [m]', color=FAINT_INK, fontsize=9)
    axes.set_ylabel('y [m]', color=FAINT_INK, fontsize=9)
    axes.tick_params(colors=FAINT_INK, labelsize=8, length=3)
    axes.set_facecolor(UNKNOWN)
    for spine in axes.spines.values():
        spine.set_color(FRAME)
        spine.set_linewidth(0.8)
