"""
Read an image as the occupancy of its pixels.

Every storage format (one bit, a palette, colour, 16 bits, an alpha channel, a transparent colour)
becomes the same two arrays, grey values and a mask of transparent pixels, a few rows at a time:
the formulas of a map never see a format, and a large map costs little more than its decoded image.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, NamedTuple, TypeAlias

from hnr_planner.maps.file_kinds import HEAD, kind_of, with_article
from hnr_planner.maps.memory import available_memory, in_words
import numpy as np
from numpy.typing import NDArray
from PIL.BmpImagePlugin import BmpImageFile
from PIL.Image import Image, new
from PIL.PngImagePlugin import PngImageFile
from PIL.PpmImagePlugin import PpmImageFile

#: The decoder of each kind of image. Pillow's own ``open`` would refuse large maps as attacks.
DECODERS: dict[str | None, Callable[[BinaryIO], Image]] = {
    'PNG image': PngImageFile,
    'BMP image': BmpImageFile,
    **dict.fromkeys(('PBM image', 'PGM image', 'PPM image'), PpmImageFile),
}
#: Bytes of a decoded pixel in Pillow's memory, by its mode; 4 for the others.
_PIXEL_BYTES = {'1': 1, 'L': 1, 'P': 1, 'I;16': 2, 'I;16B': 2, 'I;16L': 2, 'I;16N': 2}
#: About how many pixels are converted at a time.
_STRIP = 2**20
#: Memory for the file's bytes and a strip on its way [bytes].
_BESIDES = 2**26

Bytes: TypeAlias = NDArray[np.int8]


class Pixels(NamedTuple):
    """
    Consecutive rows of an image, the uppermost first.

    ``thirds`` (rows, cols) uint16 in 0..765 is the sum of the three colour channels, so the grey
    value in thirds: the mean of the channels need not be whole, and is exact like this.
    ``transparent`` (rows, cols) bool is True where alpha is below its maximum.
    """

    thirds: NDArray[np.uint16]
    transparent: NDArray[np.bool_]


def read_cells(path: Path, meaning: Callable[[Pixels], Bytes]) -> Bytes:
    """
    Read a PGM, PNG or BMP image (also PBM and PPM) as cells.

    Parameters
    ----------
    path : Path
        The image file.
    meaning : callable
        Returns the values (rows, cols) of ``Pixels``; each may depend on its own pixel only.

    Returns
    -------
    (rows, cols) int8
        The values, with the image's last row first.

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        The file is not an image in one of these formats, is truncated, holds no pixel, or needs
        more memory than is available.

    """
    with path.open('rb') as file:
        kind = kind_of(file.read(HEAD))
        file.seek(0)
        if kind not in DECODERS:
            what = 'not an image' if kind is None else with_article(kind)
            raise ValueError(f'is {what}: a map has a whole PGM, PNG or BMP image')
        try:
            image = DECODERS[kind](file)
        except Exception:  # Pillow's decoders have errors of their own
            raise ValueError(f'is not a whole {kind}, or is empty') from None
        _require_memory(image)
        try:
            image.load()
            return _cells(image, meaning)
        except MemoryError:
            raise ValueError(_too_large(image)) from None
        except Exception as error:
            raise ValueError(f'cannot be decoded: {error}') from error
        finally:
            image.close()


def _require_memory(image: Image) -> None:
    """Raise ValueError where decoding an image would need more memory than is available."""
    if memory_needed(image) > available_memory():
        raise ValueError(_too_large(image))


def memory_needed(image: Image) -> int:
    """Return how many bytes reading an image takes: the decoded image, its cells and buffers."""
    width, height = image.size
    return width * height * (_PIXEL_BYTES.get(image.mode, 4) + 1) + _BESIDES


def _too_large(image: Image) -> str:
    width, height = image.size
    return (
        f'has {width:,} x {height:,} pixels: reading it takes {in_words(memory_needed(image))} of '
        f'memory, and {in_words(available_memory())} are available'
    )


def _cells(image: Image, meaning: Callable[[Pixels], Bytes]) -> Bytes:
    """Return the value of each pixel (rows, cols) of a decoded image, its last row first."""
    has_table = image.mode in ('L', 'P') or (
        image.mode == '1' and 'transparency' not in image.info
    )
    convert = _by_table(image, meaning) if has_table else None
    width, height = image.size
    cells = np.empty((height, width), np.int8)
    rows = max(_STRIP // width, 1)
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        strip = image.crop((0, top, width, bottom))
        values = convert(strip) if convert else meaning(_pixels(strip))
        low, high = height - bottom, height - top
        cells[low:high] = values[::-1]
    return cells


def _by_table(image: Image, meaning: Callable[[Pixels], Bytes]) -> Callable[[Image], Bytes]:
    """
    Return a fast function from a strip of an image to its values (rows, cols).

    It looks up the value of each of the 256 bytes that a pixel may have; the image has to be of
    mode L, P or 1.
    """
    every = image.crop((0, 0, 256, 1)) if image.mode != '1' else new('L', (256, 1))
    every.putdata(range(256))
    table = meaning(_pixels(every))[0]
    return lambda strip: table[np.asarray(strip.convert('L') if strip.mode == '1' else strip)]


def _pixels(image: Image) -> Pixels:
    return _deep_grey(image) if _is_deep(image) else _colour(image)


def _is_deep(image: Image) -> bool:
    return image.mode == 'I' or image.mode.startswith('I;16')


def _deep_grey(image: Image) -> Pixels:
    """
    Return the pixels of a grey image of 16 bits, with values scaled from 0..65535 to 0..255.

    Pillow's own conversion would clip the values, and lose which of them is transparent.
    """
    values = np.asarray(image).astype(np.int64)
    transparent = values == image.info.get('transparency', -1)
    return Pixels((3 * ((values + 128) // 257)).astype(np.uint16), transparent)


def _colour(image: Image) -> Pixels:
    """Return the pixels of an image of 8 bits a channel, with or without alpha."""
    channels = np.asarray(image.convert('RGBA'))
    red, green, blue, alpha = np.moveaxis(channels, -1, 0)
    return Pixels(red.astype(np.uint16) + green + blue, alpha < 255)
