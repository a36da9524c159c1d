"""
Read an image as 8-bit grey values and a mask of its transparent pixels.

Whatever the file stores (one bit, a palette, colour, 16 bits, an alpha channel, a colour that
counts as transparent) is brought to the same two arrays, so that the formulas of a map never
see a format.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

FORMATS = ('PNG', 'PPM', 'BMP')  # Pillow's PPM is the whole family: PBM, PGM, PPM


class Pixels(NamedTuple):
    """
    What a map is made of, rows from the top of the picture.

    ``thirds`` (rows, cols) uint16 in 0..765 is the sum of the three colour channels, so the grey
    value in thirds: the mean of the channels need not be whole, and is exact like this.
    ``transparent`` (rows, cols) bool tells where alpha is below its maximum.
    """

    thirds: NDArray[np.uint16]
    transparent: NDArray[np.bool_]


def read_pixels(path: Path) -> Pixels:
    """
    Read a PGM, PNG or BMP file.

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        It is no image in one of these formats, is truncated, or holds no pixel.

    """
    with path.open('rb') as file:
        try:
            with Image.open(file, formats=FORMATS) as image:
                image.load()
                return _deep_grey(image) if _is_deep(image) else _colour(image)
        except Image.UnidentifiedImageError:  # also what Pillow says of a side of 0
            raise ValueError('is not a whole PGM, PNG or BMP image, or is empty') from None
        except Exception as error:  # each of Pillow's decoders has errors of its own
            raise ValueError(f'cannot be decoded: {error}') from error


def _is_deep(image: Image.Image) -> bool:
    return image.mode == 'I' or image.mode.startswith('I;16')


def _deep_grey(image: Image.Image) -> Pixels:
    """Bring 16 bits to 8; Pillow itself would clip them, and forget what is transparent."""
    values = np.asarray(image).astype(np.int64)
    transparent = values == image.info.get('transparency', -1)
    return Pixels((3 * ((values + 128) // 257)).astype(np.uint16), transparent)


def _colour(image: Image.Image) -> Pixels:
    channels = np.asarray(image.convert('RGBA'))
    red, green, blue, alpha = np.moveaxis(channels, -1, 0)
    return Pixels(red.astype(np.uint16) + green + blue, alpha < 255)
