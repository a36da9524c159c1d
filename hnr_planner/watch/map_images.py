"""Images of maps for the page, made in a thread of their own."""

from __future__ import annotations

from collections.abc import Callable
import threading
import time

from hnr_planner.drawing import cell_kinds
from hnr_planner.maps import OccupancyMap
from hnr_planner.page.map_image import map_data, map_image
from hnr_planner.watch.wire import pack
import numpy as np
from numpy.typing import NDArray

#: Side of the largest image [pixels]; of larger maps, a pixel is a block of cells.
LARGEST_SIDE = 4096
#: So many times as long as an image took is the pause after it, so that a large map that changes
#: all the time takes a fifth of a core.
REST = 4.0


class MapImages:
    """
    Sends an image of each map that differs from the last one, and of the last of many at once.

    Parameters
    ----------
    send : callable
        Called with each message for the page, in the thread that makes the images.

    """

    def __init__(self, send: Callable[[bytes], None]) -> None:
        self._send = send
        self._is_due = threading.Event()
        self._next: OccupancyMap | None = None
        self._last: OccupancyMap | None = None
        threading.Thread(target=self._run, name='map images', daemon=True).start()

    def put(self, occupancy: OccupancyMap) -> None:
        """Send an image of a map soon, unless a newer map comes first."""
        self._next = occupancy
        self._is_due.set()

    def forget(self) -> None:
        """Send the next map whatever the last one was."""
        self._next = self._last = None

    def _run(self) -> None:
        while True:
            self._is_due.wait()
            self._is_due.clear()
            occupancy, last = self._next, self._last
            if occupancy is None or (last is not None and _is_same(occupancy, last)):
                continue
            began = time.thread_time()
            self._last = occupancy
            self._send(map_message(occupancy))
            time.sleep(REST * (time.thread_time() - began))


def map_message(occupancy: OccupancyMap) -> bytes:
    """Return the message with the image of a map, and what the page has to know about it."""
    kinds = cell_kinds(occupancy)
    block = -(-max(kinds.shape) // LARGEST_SIDE)
    header = map_data(occupancy, kinds)
    header['resolution'] *= block
    image = map_image(_in_blocks(kinds, block), compress_level=1)
    return pack('map', {'map': header}, [np.frombuffer(image, dtype=np.uint8)])


def _in_blocks(kinds: NDArray[np.uint8], block: int) -> NDArray[np.uint8]:
    """Return the highest kind in each block of cells: what is occupied is seen from afar."""
    if block == 1:
        return kinds
    rows, cols = (np.arange(0, size, block) for size in kinds.shape)
    highest = np.maximum.reduceat(np.maximum.reduceat(kinds, rows, axis=0), cols, axis=1)
    return np.asarray(highest)


def _is_same(one: OccupancyMap, other: OccupancyMap) -> bool:
    if (one.resolution, one.origin) != (other.resolution, other.origin):
        return False
    return np.array_equal(one.data, other.data)
