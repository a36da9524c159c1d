"""Every format of image that a map may come in."""

from pathlib import Path
from typing import Any

from hnr_planner.maps.pixels import read_pixels
import numpy as np
from PIL import Image
import pytest

GREYS = np.array([[0, 51, 100], [205, 254, 255]], np.uint8)


def read(tmp_path: Path, name: str, image: Image.Image | bytes, **options: Any) -> np.ndarray:
    path = tmp_path / name
    if isinstance(image, bytes):
        path.write_bytes(image)
    else:
        image.save(path, **options)
    pixels = read_pixels(path)
    return np.where(pixels.transparent, -1, pixels.thirds / 3)


@pytest.mark.parametrize('name', ['a.png', 'a.pgm', 'a.bmp'])
def test_grey(tmp_path: Path, name: str) -> None:
    assert np.array_equal(read(tmp_path, name, Image.fromarray(GREYS)), GREYS)


@pytest.mark.parametrize('name', ['a.png', 'a.ppm', 'a.bmp'])
def test_colour(tmp_path: Path, name: str) -> None:
    colours = np.array([[[10, 20, 30], [255, 0, 0]]], np.uint8)
    assert read(tmp_path, name, Image.fromarray(colours)).tolist() == [[20, 85]]


def test_mean_of_colours_is_not_rounded(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[[0, 0, 1]]], np.uint8))
    assert read(tmp_path, 'a.png', image).tolist() == [[1 / 3]]


def test_plain_pgm_with_comments(tmp_path: Path) -> None:
    text = b'P2 # plain\n# 3 columns\n3 2\n255\n0 51 100\n205\n254 255\n'
    assert np.array_equal(read(tmp_path, 'a.pgm', text), GREYS)


def test_raw_pgm_with_a_comment(tmp_path: Path) -> None:
    text = b'P5\n# CREATOR: map_saver 0.050 m/pix\n3 2\n255\n' + GREYS.tobytes()
    assert np.array_equal(read(tmp_path, 'a.pgm', text), GREYS)


@pytest.mark.parametrize('largest', [100, 1000])
def test_pgm_is_scaled_from_its_own_maximum(tmp_path: Path, largest: int) -> None:
    kind = np.dtype('>u2') if largest > 255 else np.dtype('u1')
    body = np.array([0, largest // 5, largest], kind).tobytes()
    text = b'P5\n3 1\n%d\n' % largest + body
    assert read(tmp_path, 'a.pgm', text).tolist() == [[0, 51, 255]]


@pytest.mark.parametrize('name', ['a.png', 'a.pgm'])
def test_sixteen_bits_are_scaled_to_eight(tmp_path: Path, name: str) -> None:
    deep = Image.fromarray(GREYS.astype(np.uint16) * 257)
    assert np.array_equal(read(tmp_path, name, deep), GREYS)
    near = Image.fromarray(np.array([[128, 129, 65535 - 128]], np.uint16))
    assert read(tmp_path, name, near).tolist() == [[0, 1, 255]]


def test_sixteen_bits_with_a_transparent_value(tmp_path: Path) -> None:
    deep = Image.fromarray(np.array([[1000, 1001]], np.uint16))
    assert read(tmp_path, 'a.png', deep, transparency=1000).tolist() == [[-1, 4]]


def test_one_bit(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[0, 255]], np.uint8)).convert('1')
    for name in ('a.png', 'a.bmp', 'a.pbm'):
        assert read(tmp_path, name, image).tolist() == [[0, 255]]


def test_grey_with_alpha(tmp_path: Path) -> None:
    image = Image.merge('LA', [Image.fromarray(GREYS), Image.fromarray(GREYS)])
    expected = np.where(GREYS < 255, -1, 255)
    assert np.array_equal(read(tmp_path, 'a.png', image), expected)


def test_palette_with_transparency(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[0, 1, 2]], np.uint8), mode='P')
    image.putpalette([10, 20, 30, 200, 100, 0, 7, 7, 7])
    opaque = read(tmp_path, 'a.png', image)
    assert opaque.tolist() == [[20, 100, 7]]
    partly = read(tmp_path, 'a.png', image, transparency=bytes([255, 254, 0]))
    assert partly.tolist() == [[20, -1, -1]]


def test_the_name_does_not_tell_the_format(tmp_path: Path) -> None:
    Image.fromarray(GREYS).save(tmp_path / 'a.bmp')
    (tmp_path / 'a.bmp').rename(tmp_path / 'a.pgm')
    assert np.array_equal(read_pixels(tmp_path / 'a.pgm').thirds, 3.0 * GREYS)
