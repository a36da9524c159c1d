"""A broken map file gives one line that names the file, the key and the value."""

import io
from pathlib import Path

from hnr_planner.core.errors import HnrError
from hnr_planner.maps import load_map, MapFileError
import numpy as np
from PIL import Image
import pytest

from .conftest import MapWriter


def message(path: Path) -> str:
    """Return the error of loading a file: one line that starts with its name."""
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


@pytest.mark.parametrize('text', [b'image: [', b'a: b: c', b'\xff\xfe\x00', b'[' * 9999])
def test_not_yaml(tmp_path: Path, text: bytes) -> None:
    (tmp_path / 'map.yaml').write_bytes(text)
    assert message(tmp_path / 'map.yaml').startswith('is not YAML: ')


def test_a_tag_runs_no_code(write_map: MapWriter) -> None:
    path = write_map()
    code = '!!python/object/apply:os.getcwd []'
    path.write_text(path.read_text().replace('image: map.png', f'image: {code}'))
    assert message(path) == f'image: {NAME}, not []'


def test_aliases_without_end_are_no_danger(write_map: MapWriter) -> None:
    path = write_map()
    laughs = 'a0: &a0 [ha, ha]\n'
    laughs += ''.join(f'a{k}: &a{k} [{", ".join([f"*a{k - 1}"] * 9)}]\n' for k in range(1, 30))
    path.write_text(laughs + path.read_text().replace('mode: trinary', '') + 'mode: *a29\n')
    assert message(path).startswith('mode: must be one of trinary, scale, raw, not [...')
    path.write_text('image: &a [*a]\n' + path.read_text().replace('image', 'other'))
    assert message(path).startswith(f'image: {NAME}, not [...]')


@pytest.mark.parametrize(
    ('text', 'shown'),
    [('', 'nothing'), ('- image', '[image]'), ('map', 'map'), ('---\n---\na: 1', 'nothing')],
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
FLAG = 'must be an integer or a boolean, such as 0 or false'
NAME = "must be a file's name"
MODE = 'must be one of trinary, scale, raw'


@pytest.mark.parametrize(
    ('key', 'written', 'rule'),
    [
        *[
            ('resolution', written, RESOLUTION)
            for written in ('0', '-0.05', '.nan', '.inf', '1e999', 'fine', 'true', '[0.05]', '0x1')
        ],
        *[('resolution', written, RESOLUTION) for written in ('0,05', '1_0', '0.05m', '5.e', '.')],
        *[
            ('origin', written, ORIGIN)
            for written in (
                '[0.0, 0.0]',
                '[0.0, 0.0, 0.0, 0.0]',
                '[0.0, .nan, 0.0]',
                '[0.0, 0.0, .inf]',
                '[0.0, 0.0, north]',
                '[0.0, 0.0, false]',
                '0.0',
                '{x: 0.0}',
            )
        ],
        *[('occupied_thresh', written, SHARE) for written in ('65', 'high', '.nan')],
        *[('free_thresh', written, SHARE) for written in ('-0.1', '[]', 'true')],
        *[
            ('negate', written, FLAG)
            for written in ('maybe', '0.5', '[]', 'nO', '08', '1e0', '0x')
        ],
        *[('mode', written, MODE) for written in ('binary', '3')],
    ],
)
def test_value_against_its_rule(write_map: MapWriter, key: str, written: str, rule: str) -> None:
    path = write_map(**{key: None})
    path.write_text(f'{path.read_text()}{key}: {written}\n')
    assert message(path) == f'{key}: {rule}, not {written}'


@pytest.mark.parametrize('key', ['resolution', 'origin', 'negate', 'mode', 'image'])
@pytest.mark.parametrize('written', ['', '~', 'null'])
def test_a_key_without_a_value(write_map: MapWriter, key: str, written: str) -> None:
    path = write_map(**{key: None})
    path.write_text(f'{path.read_text()}{key}: {written}\n')
    assert message(path).endswith(', not nothing')


@pytest.mark.parametrize(
    ('written', 'shown'), [("''", "''"), ('[]', '[]'), (r'"a\0b"', r"'a\x00b'"), ('" "', "' '")]
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


@pytest.mark.parametrize(
    ('name', 'meant'),
    [
        ('/home/robot/maps/map.png', 'map.png'),
        ('maps/map.png', 'map.png'),
        (r'C:\maps\map.png', 'map.png'),
        ('MAP.PNG', 'map.png'),
        ('map.pgm', 'map.png'),
    ],
)
def test_a_hint_for_an_image_that_lies_beside(write_map: MapWriter, name: str, meant: str) -> None:
    path = write_map()
    path.write_text(path.read_text().replace('image: map.png', f'image: {name}'))
    text = message(path)
    assert 'cannot be opened (No such file or directory)' in text
    assert text.endswith(f'; beside the YAML file lies {meant}: write image: {meant}')


def test_the_image_in_the_place_of_the_yaml_is_named(write_map: MapWriter, tmp_path: Path) -> None:
    write_map(image='other.png')
    (tmp_path / 'map.png').write_bytes((tmp_path / 'other.png').read_bytes())
    reason = 'is a PNG image, not the YAML file of a map: give the YAML file that names it'
    assert message(tmp_path / 'other.png') == reason
    assert message(tmp_path / 'map.png') == f'{reason}, perhaps {tmp_path / "map.yaml"}'


@pytest.mark.parametrize(
    ('content', 'kind'),
    [
        (b'P5\n1 1\n255\n\0', 'a PGM image'),
        (b'\xff\xd8\xff\xe0', 'a JPEG image'),
        (b'<?xml version="1.0"?>\n<svg xmlns="x">', 'an SVG drawing'),
        (b'\x1f\x8b\x08', 'a gzip archive'),
        (b'type octile\nheight 1\n', 'a map of the Moving AI benchmarks'),
    ],
)
def test_what_else_is_no_yaml_is_named(tmp_path: Path, content: bytes, kind: str) -> None:
    (tmp_path / 'map.yaml').write_bytes(content)
    assert message(tmp_path / 'map.yaml').startswith(f'is {kind}, not the YAML file of a map')


def encoded(kind: str) -> bytes:
    """Return the bytes of an image of noise, which no format compresses."""
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
    assert ' a whole ' in text or 'cannot be decoded' in text


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


@pytest.mark.parametrize(
    ('suffix', 'kind'),
    [
        ('JPEG', 'a JPEG image'),
        ('GIF', 'a GIF image'),
        ('TIFF', 'a TIFF image'),
        ('WEBP', 'a WebP image'),
        ('JPEG2000', 'a JPEG 2000 image'),
        ('TGA', 'a TGA image'),
        ('ICO', 'an icon'),
        ('PDF', 'a PDF document'),
    ],
)
def test_an_unsupported_format_is_named(
    write_map: MapWriter, tmp_path: Path, suffix: str, kind: str
) -> None:
    try:
        content = encoded(suffix)
    except (KeyError, OSError):
        pytest.skip(f'this Pillow cannot write {suffix}')
    assert message(write_map(content)) == (
        f'image: {tmp_path / "map.png"} is {kind}: a map has a whole PGM, PNG or BMP image'
    )


@pytest.mark.parametrize('mark', [b'Pf', b'PF'])
def test_pfm_is_refused(write_map: MapWriter, mark: bytes) -> None:
    floats = np.zeros((2, 2, 3 if mark == b'PF' else 1), '<f4').tobytes()
    assert 'is a PFM image' in message(write_map(mark + b'\n2 2\n-1.0\n' + floats))


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
