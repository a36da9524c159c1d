"""Every format of image that a map may come in."""

from collections.abc import Callable
from pathlib import Path
from test.sweeps import sweep
from typing import Any

from hnr_planner.maps.pixels import Pixels, read_cells
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
    return values(path)


def values(path: Path) -> np.ndarray:
    """Return the grey value of each pixel, -1 where transparent, the top row first."""

    def part(meaning: Callable[[Pixels], np.ndarray]) -> np.ndarray:
        return read_cells(path, lambda pixels: meaning(pixels).astype(np.int8))[::-1].astype(int)

    # In parts that fit into a cell of 8 bits.
    thirds = part(lambda pixels: pixels.thirds & 127) + 128 * part(lambda p: p.thirds >> 7)
    return np.where(part(lambda pixels: pixels.transparent), -1, thirds / 3)


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
    assert np.array_equal(values(tmp_path / 'a.pgm'), GREYS)


def test_one_bit_with_a_transparent_value(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[0, 255]], np.uint8)).convert('1')
    assert read(tmp_path, 'a.png', image, transparency=0).tolist() == [[-1, 255]]


def test_grey_with_a_transparent_value(tmp_path: Path) -> None:
    image = Image.fromarray(GREYS)
    expected = np.where(GREYS == 205, -1, GREYS.astype(int))
    assert np.array_equal(read(tmp_path, 'a.png', image, transparency=205), expected)


@pytest.mark.parametrize('mode', ['1', 'L', 'P', sweep('LA'), sweep('RGB'), 'RGBA', 'I;16'])
def test_an_image_of_many_strips_is_read_like_its_rows(tmp_path: Path, mode: str) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (1700, 1300)).astype(np.uint8)
    deep = noise.astype(np.uint16) * 257
    image = Image.fromarray(deep if mode == 'I;16' else noise)
    image = image if mode == 'I;16' else image.convert(mode)
    whole = read(tmp_path, 'a.png', image)
    assert whole.shape == (1700, 1300)
    for top, bottom in ((0, 1), (800, 820), (1699, 1700)):
        part = read(tmp_path, 'b.png', image.crop((0, top, 1300, bottom)))
        assert np.array_equal(whole[top:bottom], part)
