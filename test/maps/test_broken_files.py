"""A broken map file gives one line that names the file, the key and the value."""

import io
from pathlib import Path
from typing import Any

from hnr_planner.core.errors import HnrError
from hnr_planner.maps import load_map, MapFileError
import numpy as np
from PIL import Image
import pytest

from .conftest import MapWriter


def message(path: Path) -> str:
    """Return the error that a file gives, which has to be one line that starts with its name."""
    with pytest.raises(MapFileError) as caught:
        load_map(path)
    text = str(caught.value)
    assert text.startswith(f'{path}: ')
    assert '\n' not in text
    assert isinstance(caught.value, HnrError)
    assert isinstance(caught.value, ValueError)
    return text.removeprefix(f'{path}: ')


def test_missing_file(tmp_path: Path) -> None:
    assert message(tmp_path / 'none.yaml') == 'cannot be opened (No such file or directory)'


def test_folder_instead_of_a_file(tmp_path: Path) -> None:
    assert message(tmp_path) == 'cannot be opened (Is a directory)'


@pytest.mark.parametrize(
    'text', [b'image: [', b'a: b: c', b'\xff\xfe\x00', b'\x89PNG\r\n\x1a\n', b'[' * 9999]
)
def test_not_yaml(tmp_path: Path, text: bytes) -> None:
    (tmp_path / 'map.yaml').write_bytes(text)
    assert message(tmp_path / 'map.yaml').startswith('is not YAML: ')


def test_yaml_that_would_run_code_is_refused(tmp_path: Path) -> None:
    (tmp_path / 'map.yaml').write_text('image: !!python/object/apply:os.getcwd []\n')
    assert 'is not YAML: could not determine a constructor' in message(tmp_path / 'map.yaml')


@pytest.mark.parametrize(
    ('text', 'shown'), [('', 'None'), ('- image', "['image']"), ('map', "'map'")]
)
def test_not_a_mapping(tmp_path: Path, text: str, shown: str) -> None:
    (tmp_path / 'map.yaml').write_text(text)
    expected = f'must be a YAML mapping (key: value), but holds {shown}'
    assert message(tmp_path / 'map.yaml') == expected


@pytest.mark.parametrize(
    'key', ['image', 'resolution', 'origin', 'negate', 'occupied_thresh', 'free_thresh']
)
def test_missing_key(write_map: MapWriter, key: str) -> None:
    assert message(write_map(**{key: None})) == f'the key {key} is missing'


RESOLUTION = 'must be a finite number > 0'
ORIGIN = 'must be three finite numbers [x, y, yaw]'
SHARE = 'must be a number in 0..1'
FLAG = 'must be 0, 1, true or false'
NAME = "must be a file's name"


@pytest.mark.parametrize(
    ('key', 'value', 'rule'),
    [
        ('resolution', 0, RESOLUTION),
        ('resolution', -0.05, RESOLUTION),
        ('resolution', float('nan'), RESOLUTION),
        ('resolution', float('inf'), RESOLUTION),
        ('resolution', 10**400, RESOLUTION),
        ('resolution', 'fine', RESOLUTION),
        ('resolution', True, RESOLUTION),
        ('resolution', [0.05], RESOLUTION),
        ('origin', [0.0, 0.0], ORIGIN),
        ('origin', [0.0, 0.0, 0.0, 0.0], ORIGIN),
        ('origin', [0.0, float('nan'), 0.0], ORIGIN),
        ('origin', [0.0, 0.0, float('inf')], ORIGIN),
        ('origin', [0.0, 0.0, 'north'], ORIGIN),
        ('origin', [0.0, 0.0, False], ORIGIN),
        ('origin', 0.0, ORIGIN),
        ('origin', {'x': 0.0}, ORIGIN),
        ('occupied_thresh', 65, SHARE),
        ('occupied_thresh', 'high', SHARE),
        ('occupied_thresh', float('nan'), SHARE),
        ('free_thresh', -0.1, SHARE),
        ('free_thresh', [], SHARE),
        ('free_thresh', True, SHARE),
        ('negate', 2, FLAG),
        ('negate', 'maybe', FLAG),
        ('negate', 0.5, FLAG),
        ('negate', [], FLAG),
        ('mode', 'binary', 'must be one of trinary, scale, raw'),
        ('mode', 3, 'must be one of trinary, scale, raw'),
    ],
)
def test_value_against_its_rule(write_map: MapWriter, key: str, value: Any, rule: str) -> None:
    assert message(write_map(**{key: value})).startswith(f'{key}: {rule}, not {value!r}'[:75])


@pytest.mark.parametrize(
    ('written', 'shown'), [('7', '7'), ("''", "''"), ('[]', '[]'), (r'"a\0b"', r"'a\x00b'")]
)
def test_image_that_is_no_name(write_map: MapWriter, written: str, shown: str) -> None:
    path = write_map()
    path.write_text(path.read_text().replace('image: map.png', f'image: {written}'))
    assert message(path) == f'image: {NAME}, not {shown}'


def test_long_value_is_shortened(write_map: MapWriter) -> None:
    text = message(write_map(mode='x' * 1000))
    assert len(text) < 120
    assert text.endswith('...')


def test_missing_image(write_map: MapWriter, tmp_path: Path) -> None:
    path = write_map()
    (tmp_path / 'map.png').unlink()
    image = tmp_path / 'map.png'
    assert message(path) == f'image: {image} cannot be opened (No such file or directory)'


def encoded(kind: str) -> bytes:
    """Return the file of an image of noise, which no format can make small."""
    noise = np.random.default_rng(3).integers(0, 256, (50, 50)).astype(np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(noise).save(buffer, kind)
    return buffer.getvalue()


@pytest.mark.parametrize('share', [0.0, 0.001, 0.02, 0.5, 0.9])
@pytest.mark.parametrize('kind', ['PNG', 'PPM', 'BMP'])
def test_truncated_image(write_map: MapWriter, tmp_path: Path, kind: str, share: float) -> None:
    whole = encoded(kind)
    text = message(write_map(whole[: int(share * len(whole))]))
    assert text.startswith(f'image: {tmp_path / "map.png"} ')
    assert 'is not a whole PGM' in text or 'cannot be decoded' in text


@pytest.mark.parametrize(
    'content',
    [
        b'no image at all',
        b'P5\n0 4\n255\n',
        b'P5\n-3 4\n255\n',
        b'P5\n4 4\n0\n' + bytes(16),
        b'P5\n4 4\n255\n' + bytes(15),
        b'P2\n2 2\n255\n1 2 3\n',
        b'P2\n2 2\n255\n1 2 3 x\n',
        b'P2\n2 2\n255\n1 2 3 999\n',
    ],
)
def test_image_that_is_none(write_map: MapWriter, tmp_path: Path, content: bytes) -> None:
    assert message(write_map(content)).startswith(f'image: {tmp_path / "map.png"} ')


@pytest.mark.filterwarnings('ignore::PIL.Image.DecompressionBombWarning')
def test_damaged_bytes_never_give_another_error(write_map: MapWriter) -> None:
    rng = np.random.default_rng(4)
    for kind in ('PNG', 'PPM', 'BMP'):
        whole = encoded(kind)
        for _ in range(60):
            damaged = bytearray(whole)
            for place in rng.integers(0, min(len(whole), 120), 3):
                damaged[place] = rng.integers(256)
            path = write_map(bytes(damaged))
            try:
                load_map(path)
            except MapFileError as error:
                assert str(error).startswith(f'{path}: image: ')
