"""
Map files of map_server: a YAML file that gives an image its meaning.

With v the grey value of a pixel (0..255), n = v / 255 and occ = n if ``negate``, else 1 - n:

=======  ====================================================================================
trinary  occ <= free_thresh: 0; else occ >= occupied_thresh: 100; else -1
scale    the same ends, and round(100 (occ - free_thresh) / (occupied_thresh - free_thresh))
         between them
raw      v where it is 0..100, else -1, whatever ``negate`` says
=======  ====================================================================================

In trinary and scale a pixel that is not fully opaque is -1. The image's last row is the grid's
first. The keys and modes are those of Nav2's map_server.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

from hnr_planner.maps.errors import MapFileError
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
from hnr_planner.maps.pixels import Pixels, read_pixels
import numpy as np
from numpy.typing import NDArray
from PIL import Image
import yaml

MODES = ('trinary', 'scale', 'raw')
REQUIRED = ('image', 'resolution', 'origin', 'negate', 'occupied_thresh', 'free_thresh')

# What save_map writes: map_server's customary greys, and thresholds that tell them apart
# (grey 205 is occ = .19608, so that a free_thresh of .25 would call the unknown free).
_GREY_OF = {FREE: 254, UNKNOWN: 205, OCCUPIED: 0}
_OCCUPIED_THRESH, _FREE_THRESH = 0.65, 0.196


class MapHeader(NamedTuple):
    """The YAML part of a map, checked."""

    image: Path
    mode: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float


def load_map_server(path: Path) -> OccupancyMap:
    """Read a map_server YAML file and its image; MapFileError tells what is wrong with them."""
    header = read_header(path)
    try:
        pixels = read_pixels(header.image)
    except OSError as error:
        reason = f'cannot be opened ({error.strerror or error})'
        raise MapFileError.about(path, f'image: {header.image} {reason}') from None
    except ValueError as error:
        raise MapFileError.about(path, f'image: {header.image} {error}') from error
    data = occupancy_of(pixels, header)[::-1]
    return OccupancyMap(np.ascontiguousarray(data), header.resolution, header.origin)


def save_map(occupancy: OccupancyMap, path: str | Path) -> None:
    """
    Write a trinary map as a YAML file with a PNG image of the same name beside it.

    Raises
    ------
    ValueError
        The map holds a value other than -1, 0 and 100, which a trinary map cannot keep.

    """
    strange = np.setdiff1d(occupancy.data, list(_GREY_OF))
    if strange.size:
        raise ValueError(f'a trinary map holds -1, 0 and 100 only, not {strange[0]}')
    path = Path(path)
    image = path.with_suffix('.png')
    _palette_image(occupancy.data[::-1]).save(image, optimize=True)
    header = {
        'image': image.name,
        'mode': 'trinary',
        'resolution': float(occupancy.resolution),
        'origin': [float(number) for number in occupancy.origin],
        'negate': 0,
        'occupied_thresh': _OCCUPIED_THRESH,
        'free_thresh': _FREE_THRESH,
    }
    text = yaml.safe_dump(header, sort_keys=False, default_flow_style=None)
    path.write_text(text, encoding='utf-8')


def _palette_image(data: NDArray[np.int8]) -> Image.Image:
    """Draw trinary data with a palette of three greys: two bits a pixel make a small file."""
    index = np.zeros(data.shape, np.uint8)
    for place, value in enumerate(_GREY_OF):
        index[data == value] = place
    image = Image.fromarray(index)
    image.putpalette([grey for grey in _GREY_OF.values() for _ in 'RGB'])
    return image


def occupancy_of(pixels: Pixels, header: MapHeader) -> NDArray[np.int8]:
    """Return what each pixel means, (rows, cols) from the top of the image."""
    data = _meanings(header)[pixels.thirds]
    if header.mode != 'raw':
        data[pixels.transparent] = UNKNOWN
    return data


def _meanings(header: MapHeader) -> NDArray[np.int8]:
    """Return the occupancy that each grey value means, for the values 0, 1/3, 2/3 .. 255."""
    grey = np.arange(3 * 255 + 1) / 3
    if header.mode == 'raw':
        value = np.rint(grey)
        return np.where(value <= 100, value, UNKNOWN).astype(np.int8)
    occ = grey / 255 if header.negate else 1 - grey / 255
    free, occupied = header.free_thresh, header.occupied_thresh
    meaning = np.full(occ.shape, UNKNOWN, np.int8)
    if header.mode == 'scale':
        between = (occ > free) & (occ < occupied)
        meaning[between] = np.rint(100 * (occ[between] - free) / (occupied - free))
    meaning[occ >= occupied] = OCCUPIED
    meaning[occ <= free] = FREE
    return meaning


def read_header(path: Path) -> MapHeader:
    """Read and check the YAML part of a map."""
    fields = _Fields(path, _read_mapping(path))
    for key in REQUIRED:
        fields.get(key)
    return MapHeader(
        image=path.parent / fields.text('image'),  # an absolute name wins over the folder
        mode=fields.mode(),
        resolution=fields.resolution(),
        origin=fields.origin(),
        negate=fields.flag('negate'),
        occupied_thresh=fields.share('occupied_thresh'),
        free_thresh=fields.share('free_thresh'),
    )


def _read_mapping(path: Path) -> dict[Any, Any]:
    try:
        mapping = yaml.safe_load(path.read_bytes())
    except OSError as error:
        raise MapFileError.about(path, f'cannot be opened ({error.strerror or error})') from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise MapFileError.about(path, f'is not YAML: {error}') from error
    if not isinstance(mapping, dict):
        raise MapFileError.about(
            path, f'must be a YAML mapping (key: value), but holds {_shown(mapping)}'
        )
    return mapping


class _Fields:
    """The keys of one YAML file, each read with the rule that it has to obey."""

    def __init__(self, path: Path, mapping: dict[Any, Any]) -> None:
        self._path = path
        self._mapping = mapping

    def get(self, key: str) -> Any:
        if key not in self._mapping:
            raise MapFileError.about(self._path, f'the key {key} is missing')
        return self._mapping[key]

    def text(self, key: str) -> str:
        value = self.get(key)
        if not isinstance(value, str) or not value.strip() or '\0' in value:
            raise self._broken(key, "must be a file's name")
        return value

    def mode(self) -> str:
        mode = self._mapping.get('mode', 'trinary')
        if not isinstance(mode, str) or mode.lower() not in MODES:
            raise self._broken('mode', f'must be one of {", ".join(MODES)}')
        return mode.lower()

    def resolution(self) -> float:
        value = _number(self.get('resolution'))
        if not 0 < value < math.inf:
            raise self._broken('resolution', 'must be a finite number > 0')
        return value

    def share(self, key: str) -> float:
        value = _number(self.get(key))
        if not 0 <= value <= 1:
            raise self._broken(key, 'must be a number in 0..1')
        return value

    def flag(self, key: str) -> bool:
        value = self.get(key)
        if not isinstance(value, int) or value not in (0, 1):
            raise self._broken(key, 'must be 0, 1, true or false')
        return bool(value)

    def origin(self) -> tuple[float, float, float]:
        value = self.get('origin')
        numbers = [_number(item) for item in value] if isinstance(value, list) else []
        if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
            raise self._broken('origin', 'must be three finite numbers [x, y, yaw]')
        x, y, yaw = numbers
        return x, y, yaw

    def _broken(self, key: str, rule: str) -> MapFileError:
        return MapFileError.about(self._path, f'{key}: {rule}, not {_shown(self._mapping[key])}')


def _number(value: Any) -> float:
    """
    Return a YAML scalar as a float, NaN for what is no number.

    PyYAML takes 1e-05 (no dot) for a string, map files do contain it, and yaml-cpp reads it as
    the number that it is.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return math.nan
    try:
        return float(value)
    except (ValueError, OverflowError):
        return math.nan


def _shown(value: Any) -> str:
    """Return a value as it fits in a one-line message."""
    text = repr(value)
    return text if len(text) <= 60 else f'{text[:57]}...'
