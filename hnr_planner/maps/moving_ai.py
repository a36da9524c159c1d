"""
Grid maps of the Moving AI benchmarks (``.map`` files of type octile).

A header of keys and values with whitespace between them (``type octile``, ``height``, ``width``,
in any order, then ``map``) and one character for each cell. By the rules of the format:

=======  ==========================================================================
. and G  ground, passable
S        swamp, passable from ground and from swamp
W        water, passable from water but not from ground
@ and O  out of bounds
T        trees, not passable
=======  ==========================================================================

A cell of an occupancy map is free or occupied for every robot, so ground and swamp are free,
and water is occupied, like all else: a robot on the ground can never enter it.

The array's row is the file's row: the file's first line is row 0, y grows downwards in the file
and upwards on the map, so that maps look upside down, and a scenario's cell (x, y) has its
centre at (x + .5, y + .5).

Format: N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", 2012.
"""

from __future__ import annotations

from pathlib import Path

from hnr_planner.maps.errors import MapFileError
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED
import numpy as np

#: Characters of free cells; a cell with any other character is occupied.
PASSABLE = b'.GS'
_MEANINGS = np.full(256, OCCUPIED, np.int8)
_MEANINGS[list(PASSABLE)] = FREE


def load_moving_ai(path: Path) -> OccupancyMap:
    """
    Read a ``.map`` file of type octile as an occupancy map.

    The format states no lengths: a cell has a side of 1 m, and the outer corner of cell [0, 0]
    is at (0, 0) of the map frame, with yaw 0.

    Raises
    ------
    MapFileError
        The file cannot be opened or breaks a rule of the format; the message names the file and
        the reason.

    """
    try:
        lines = path.read_bytes().splitlines()
    except OSError as error:
        raise MapFileError.about(path, f'cannot be opened ({error.strerror or error})') from None
    header, body = _split(path, lines)
    if header.get(b'type') != b'octile':
        raise MapFileError.about(path, f'type: must be octile, not {_shown(header.get(b"type"))}')
    height = _size(path, header, 'height')
    width = _size(path, header, 'width')
    if len(body) != height:
        raise MapFileError.about(path, f'height: is {height}, but {len(body)} rows follow')
    for number, row in enumerate(body):
        if len(row) != width:
            reason = f'width: is {width}, but row {number} has {len(row)} cells'
            raise MapFileError.about(path, reason)
    cells = np.frombuffer(b''.join(body), np.uint8).reshape(height, width)
    return OccupancyMap(_MEANINGS[cells], 1.0)


def _split(path: Path, lines: list[bytes]) -> tuple[dict[bytes, bytes], list[bytes]]:
    """
    Split the lines of a file into the header's values by key, and the rows of cells.

    Blanks at the end of a row and empty lines after the last row are removed. MapFileError is
    raised where the line ``map`` is missing.
    """
    header: dict[bytes, bytes] = {}
    for number, line in enumerate(lines, start=1):
        key, *values = line.split(maxsplit=1)[:2] or [b'']
        if key == b'map' and not values:
            body = [row.rstrip() for row in lines[number:]]
            while body and not body[-1]:
                body.pop()
            return header, body
        header[key] = b''.join(values).rstrip()
    raise MapFileError.about(path, 'the line "map", which starts the cells, is missing')


def _size(path: Path, header: dict[bytes, bytes], key: str) -> int:
    value = header.get(key.encode())
    if value is None:
        raise MapFileError.about(path, f'the key {key} is missing')
    if not value.isdigit() or len(value) > 9 or int(value) == 0:
        raise MapFileError.about(path, f'{key}: must be a whole number > 0, not {_shown(value)}')
    return int(value)


def _shown(value: bytes | None) -> str:
    return 'missing' if value is None else repr(value.decode('latin-1'))
