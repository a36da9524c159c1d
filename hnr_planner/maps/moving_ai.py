"""
Grid maps of the Moving AI benchmarks (``.map`` files of type octile).

A header (``type octile``, ``height``, ``width``, ``map``) and one character for each cell:
``.`` and ``G`` are passable, every other character is blocked.

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

PASSABLE = b'.G'


def load_moving_ai(path: Path) -> OccupancyMap:
    """Read a ``.map`` file: resolution 1, origin 0; MapFileError tells what is wrong with it."""
    try:
        lines = path.read_bytes().replace(b'\r\n', b'\n').split(b'\n')
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
    passable = np.isin(cells, list(PASSABLE))
    return OccupancyMap(np.where(passable, FREE, OCCUPIED).astype(np.int8), 1.0)


def _split(path: Path, lines: list[bytes]) -> tuple[dict[bytes, bytes], list[bytes]]:
    """Return the header's keys, and the rows without the empty lines at the file's end."""
    if b'map' not in (stripped := [line.strip() for line in lines]):
        raise MapFileError.about(path, 'the line "map", which starts the cells, is missing')
    first = stripped.index(b'map') + 1
    header = {}
    for line in stripped[: first - 1]:
        key, _, value = line.partition(b' ')
        header[key] = value.strip()
    body = lines[first:]
    while body and not body[-1]:
        body.pop()
    return header, body


def _size(path: Path, header: dict[bytes, bytes], key: str) -> int:
    value = header.get(key.encode())
    if value is None:
        raise MapFileError.about(path, f'the key {key} is missing')
    if not value.isdigit() or len(value) > 9 or int(value) == 0:
        raise MapFileError.about(path, f'{key}: must be a whole number > 0, not {_shown(value)}')
    return int(value)


def _shown(value: bytes | None) -> str:
    return 'missing' if value is None else repr(value.decode('latin-1'))
