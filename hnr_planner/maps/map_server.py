"""
Map files of map_server: a YAML file that gives an image its meaning.

With v the grey value of a pixel (0..255), n = v / 255 and occ = n if ``negate``, else 1 - n:

=======  ====================================================================================
trinary  occ <= free_thresh: 0; else occ >= occupied_thresh: 100; else -1
scale    the same ends, and round(100 (occ - free_thresh) / (occupied_thresh - free_thresh))
         between them
raw      v where it is 0..100, else -1; ``negate`` has no effect
=======  ====================================================================================

In trinary and scale a pixel that is not fully opaque is -1. The image's last row is the grid's
first. Keys, modes and what counts as a number or a flag are those of Nav2's map_server.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
import re
from typing import NamedTuple
import warnings

from hnr_planner.maps.errors import MapFileError, MapFileWarning
from hnr_planner.maps.file_kinds import HEAD, IMAGES, kind_of, with_article
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
from hnr_planner.maps.pixels import Pixels, read_cells
from hnr_planner.maps.yaml_text import (
    as_file_name,
    as_flag,
    as_number,
    Mapping,
    read_document,
    shown,
    Value,
    YamlError,
)
import numpy as np
from numpy.typing import NDArray
from PIL import Image
import yaml

#: How grey values become occupancies.
MODES = ('trinary', 'scale', 'raw')
#: Keys that a map must have.
REQUIRED = ('image', 'resolution', 'origin', 'negate', 'occupied_thresh', 'free_thresh')

#: What ``save_map`` writes: map_server's customary greys, and thresholds that tell them apart
#: (grey 205 is occ = .19608, so that a free_thresh of .25 would call the unknown free).
_GREY_OF = {FREE: 254, UNKNOWN: 205, OCCUPIED: 0}
_OCCUPIED_THRESH, _FREE_THRESH = 0.65, 0.196


class MapHeader(NamedTuple):
    """
    Checked values of the YAML file of a map.

    ``image`` is the path of the image, ``resolution`` the side of a cell [m], ``origin`` the pose
    (x, y, yaw) of the outer corner of cell [0, 0] in the map frame [m, m, rad]; ``repeated`` has
    the keys that occur more than once. The other fields enter the formulas of this module.
    """

    image: Path
    mode: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    repeated: tuple[str, ...] = ()


def load_map_server(path: Path) -> OccupancyMap:
    """
    Read a map_server YAML file and its image.

    Raises
    ------
    MapFileError
        The YAML file or the image cannot be read, or a key is missing or breaks its rule; the
        message names the file and the reason.

    Warns
    -----
    MapFileWarning
        A key occurs repeatedly: the first value counts, as for Nav2.

    """
    header = read_header(path)
    for key in header.repeated:
        text = f'{path}: the key {key} occurs repeatedly; the first value counts'
        warnings.warn(text, MapFileWarning, stacklevel=3)
    try:
        data = read_cells(header.image, partial(occupancy_of, header=header))
    except OSError as error:
        reason = f'cannot be opened ({error.strerror or error}){_hint(path, header.image)}'
        raise MapFileError.about(path, f'image: {header.image} {reason}') from None
    except ValueError as error:
        raise MapFileError.about(path, f'image: {header.image} {error}') from error
    return OccupancyMap(data, header.resolution, header.origin)


def _hint(path: Path, image: Path) -> str:
    """
    Return a hint, for an error message, at a file that the name of a missing image may mean.

    The file lies beside the YAML file, under the image's name or one that differs in folder, case
    or suffix only. The hint is empty where there is no such file.
    """
    name = re.split(r'[\\/]', str(image))[-1]
    beside = [file.name for file in path.parent.glob('*') if file.is_file()]
    similar = [other for other in beside if other.casefold() == name.casefold()]
    similar += [other for other in beside if _is_image_like(other, Path(name).stem)]
    chosen = name if name in beside else next(iter(similar), None)
    return f'; beside the YAML file lies {chosen}: write image: {chosen}' if chosen else ''


def _is_image_like(name: str, stem: str) -> bool:
    file = Path(name)
    is_image = file.suffix.lower() in ('.pgm', '.png', '.bmp', '.pbm', '.ppm')
    return is_image and file.stem.casefold() == stem.casefold()


def save_map(occupancy: OccupancyMap, path: str | Path) -> None:
    """
    Write a trinary map as the YAML file ``path``, and its image as a PNG file beside that.

    The image has the name of the YAML file with the suffix ``.png``. The map's ``frame`` is not
    written, since the format has no key for it.

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
    """
    Return an image of trinary data (rows, cols), whose row 0 becomes the image's top row.

    Its palette has three greys only: two bits a pixel make a small file.
    """
    index = np.zeros(data.shape, np.uint8)
    for place, value in enumerate(_GREY_OF):
        index[data == value] = place
    image = Image.fromarray(index)
    image.putpalette([grey for grey in _GREY_OF.values() for _ in 'RGB'])
    return image


def occupancy_of(pixels: Pixels, header: MapHeader) -> NDArray[np.int8]:
    """Return the occupancy of each pixel (rows, cols), in the order of the pixels' rows."""
    data = _meanings(header)[pixels.thirds]
    if header.mode != 'raw':
        data[pixels.transparent] = UNKNOWN
    return data


def _meanings(header: MapHeader) -> NDArray[np.int8]:
    """
    Return the occupancy (766,) that each grey value means, by the grey value in thirds.

    Element k is the occupancy of the grey value k / 3, so that the last one is that of 255.
    """
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
    """
    Read the YAML file of a map, and check its keys; the image is not read.

    Raises
    ------
    MapFileError
        The file cannot be read, or a key is missing or breaks its rule.

    """
    mapping = _read_mapping(path)
    fields = _Fields(path, mapping)
    for key in REQUIRED:
        fields.get(key)
    return MapHeader(
        image=path.parent / fields.file_name('image'),  # an absolute name wins over the folder
        mode=fields.mode(),
        resolution=fields.resolution(),
        origin=fields.origin(),
        negate=fields.flag('negate'),
        occupied_thresh=fields.share('occupied_thresh'),
        free_thresh=fields.share('free_thresh'),
        repeated=mapping.repeated,
    )


def _read_mapping(path: Path) -> Mapping:
    """Return the mapping that a YAML file holds; raise MapFileError where it holds none."""
    try:
        with path.open('rb') as file:
            head = file.read(HEAD)
            _refuse_other_files(path, head)
            document = read_document(head + file.read())
    except OSError as error:
        raise MapFileError.about(path, f'cannot be opened ({error.strerror or error})') from None
    except YamlError as error:
        raise MapFileError.about(path, f'is not YAML: {error}') from error
    if not isinstance(document, Mapping):
        raise MapFileError.about(
            path, f'must be a YAML mapping (key: value), but holds {shown(document)}'
        )
    return document


def _refuse_other_files(path: Path, head: bytes) -> None:
    """
    Raise MapFileError where a file's first bytes show that it is no YAML, but an image, say.

    For an image the message names the YAML files of the same name beside it.
    """
    kind = kind_of(head)
    if kind is None:
        return
    reason = f'is {with_article(kind)}, not the YAML file of a map'
    if kind in IMAGES:
        reason += ': give the YAML file that names it'
        beside = [path.with_suffix(suffix) for suffix in ('.yaml', '.yml')]
        reason += ''.join(f', perhaps {file}' for file in beside if file.is_file())
    raise MapFileError.about(path, reason)


class _Fields:
    """
    Values of one YAML file, each checked against its rule.

    Every public method raises MapFileError where the key is missing (a missing mode is trinary),
    or where its value breaks the rule.
    """

    def __init__(self, path: Path, mapping: Mapping) -> None:
        self._path = path
        self._values = mapping.values

    def get(self, key: str) -> Value:
        if key not in self._values:
            raise MapFileError.about(self._path, f'the key {key} is missing')
        return self._values[key]

    def file_name(self, key: str) -> str:
        name = as_file_name(self.get(key))
        if name is None:
            raise self._broken(key, "must be a file's name")
        return name

    def mode(self) -> str:
        mode = self._values.get('mode', 'trinary')
        if not isinstance(mode, str) or mode.lower() not in MODES:
            raise self._broken('mode', f'must be one of {", ".join(MODES)}')
        return mode.lower()

    def resolution(self) -> float:
        value = as_number(self.get('resolution'))
        if value is None or value <= 0:
            raise self._broken('resolution', 'must be a finite number > 0')
        return value

    def share(self, key: str) -> float:
        value = as_number(self.get(key))
        if value is None or not 0 <= value <= 1:
            raise self._broken(key, 'must be a number in 0..1')
        return value

    def flag(self, key: str) -> bool:
        value = as_flag(self.get(key))
        if value is None:
            raise self._broken(key, 'must be an integer or a boolean, such as 0 or false')
        return value

    def origin(self) -> tuple[float, float, float]:
        value = self.get('origin')
        items = value if isinstance(value, list) else []
        numbers = [number for item in items if (number := as_number(item)) is not None]
        if len(items) != 3 or len(numbers) != 3:
            raise self._broken('origin', 'must be three finite numbers [x, y, yaw]')
        x, y, yaw = numbers
        return x, y, yaw

    def _broken(self, key: str, rule: str) -> MapFileError:
        return MapFileError.about(self._path, f'{key}: {rule}, not {shown(self._values[key])}')
