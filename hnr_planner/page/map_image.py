"""The image of a map for a page, and what the page has to know about it."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from hnr_planner.drawing import KINDS, kinds_present, known_box
from hnr_planner.maps import OccupancyMap
from matplotlib.colors import to_rgb
import numpy as np
from numpy.typing import NDArray
from PIL import Image


def map_data(occupancy: OccupancyMap, kinds: NDArray[np.uint8]) -> dict[str, Any]:
    """
    Return a page's data of a map, besides its image.

    They are the resolution [m], the origin (x, y, yaw) [m, m, rad], the box around the known cells
    [m], and label and colour of each kind of cell that ``kinds`` (rows, cols) has.
    """
    return {
        'resolution': occupancy.resolution,
        'origin': list(occupancy.origin),
        'box': known_box(occupancy).tolist(),
        'kinds': [KINDS[kind] for kind in kinds_present(kinds)],
    }


def map_image(kinds: NDArray[np.uint8], compress_level: int = 9) -> bytes:
    """
    Return a PNG image of the kinds of cells (rows, cols), whose top row is row 0 of the map.

    ``compress_level`` is that of zlib: 1 is fast, 9 gives small images.
    """
    image = Image.fromarray(kinds, mode='P')
    colours = np.round(255 * np.array([to_rgb(colour) for _, colour in KINDS]))
    image.putpalette(colours.astype(np.uint8).tobytes())
    written = BytesIO()
    image.save(written, 'PNG', compress_level=compress_level)
    return written.getvalue()
