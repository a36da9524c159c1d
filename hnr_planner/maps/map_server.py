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
first. ``map_header`` reads and checks the YAML file.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
import re
import warnings

from hnr_planner.maps.errors import MapFileError, MapFileWarning
from hnr_planner.maps.map_header import MapHeader, read_header
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
from hnr_planner.maps.pixels import Pixels, read_cells
import numpy as np
from numpy.typing import NDArray
from PIL import Image
import yaml

#: What ``save_map`` writes: map_server's customary greys, and thresholds that tell them apart
#: (grey 205 is occ = .19608, so that a free_thresh of .25 would call the unknown free).
_GREY_OF = {FREE: 254, UNKNOWN: 205, OCCUPIED: 0}
_OCCUPIED_THRESH, _FREE_THRESH = 0.65, 0.196


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
