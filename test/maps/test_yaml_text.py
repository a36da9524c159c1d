"""Map files that map_server reads, written in every odd way, are read alike."""

import codecs
from pathlib import Path
import warnings

from hnr_planner.maps import load_map, MapFileWarning
import numpy as np
from PIL import Image
import pytest

PLAIN = """\
image: map.png
resolution: 0.05
origin: [-1.5, -2.0, 0.5]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def read(tmp_path: Path, text: str | bytes) -> tuple[object, ...]:
    """Return resolution, origin and cells of a map of one black and one white pixel."""
    Image.fromarray(np.array([[0, 255]], np.uint8)).save(tmp_path / 'map.png')
    path = tmp_path / 'map.yaml'
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    loaded = load_map(path)
    return loaded.resolution, loaded.origin, loaded.data.tolist()


EXPECTED = (0.05, (-1.5, -2.0, 0.5), [[100, 0]])
NEGATED = (0.05, (-1.5, -2.0, 0.5), [[0, 100]])

ALIKE = {
    'plain': PLAIN,
    'a tab after the colon': PLAIN.replace(': ', ':\t'),
    'tabs and blanks after the colon': PLAIN.replace(': ', ': \t '),
    'a tab before the colon': PLAIN.replace(':', '\t:'),
    'a tab at the end of a line': PLAIN.replace('\n', '\t\n'),
    'a tab before a comment': PLAIN.replace('\n', '\t# why\n'),
    'tabs in a list': PLAIN.replace(', ', ',\t').replace('[', '[\t').replace(']', '\t]'),
    'a list over lines with tabs': PLAIN.replace(', ', ',\n\t\t'),
    'a value on a line of its own with a tab': PLAIN.replace('origin: ', 'origin:\n\t'),
    'a block list': PLAIN.replace('[-1.5, -2.0, 0.5]', '\n- -1.5\n- -2.0\n- 0.5'),
    'tabs in a block list': PLAIN.replace('[-1.5, -2.0, 0.5]', '\n-\t-1.5\n- \t-2.0\n-\t\t0.5'),
    'lines of tabs': PLAIN.replace('\n', '\n\t\n \t \n'),
    'comments behind tabs': PLAIN.replace('\n', '\n\t# comment\n'),
    'comments': '# a map\n' + PLAIN.replace('\n', ' # comment\n'),
    'CR LF': PLAIN.replace('\n', '\r\n'),
    'CR': PLAIN.replace('\n', '\r'),
    'no line end at the end': PLAIN.rstrip(),
    'Latin-1 in a comment': PLAIN.encode() + '# Größe\n'.encode('latin-1'),
    'Windows-1252 in a comment': PLAIN.encode() + b'# 5 \x80 \x85 \x9f\n',
    'control characters in a comment': PLAIN.encode() + b'# \x00\x01\x0c\x1a\x7f\n',
    'UTF-8 in a comment': PLAIN + '# Größe \u2028 \u0085 à\n',
    'UTF-8 with a mark': codecs.BOM_UTF8 + PLAIN.encode(),
    'UTF-16': PLAIN.encode('utf-16'),
    'UTF-16 of the other order': codecs.BOM_UTF16_BE + PLAIN.encode('utf-16-be'),
    'UTF-32': PLAIN.encode('utf-32'),
    'quoted keys and values': ''.join(
        '"{}": \'{}\'\n'.format(*line.split(': ')) if '[' not in line else f'{line}\n'
        for line in PLAIN.splitlines()
    ),
    'quoted numbers in a list': PLAIN.replace('-1.5', '"-1.5"').replace('-2.0', "'-2'"),
    'a flow mapping': '{' + PLAIN.strip().replace('\n', ', ') + '}',
    'JSON': '{"image":"map.png","resolution":0.05,"origin":[-1.5,-2.0,0.5],"negate":0,'
    '"occupied_thresh":0.65,"free_thresh":0.196}',
    'a directive as of OpenCV': '%YAML:1.0\n' + PLAIN,
    'such a directive and a document mark': '%YAML:1.0\n---\n' + PLAIN,
    'the directive of YAML 1.0': '%YAML 1.0\n---\n' + PLAIN,
    'the directive of YAML 1.2': '# first\n\n%YAML 1.2\n---\n' + PLAIN,
    'a tag directive': '%TAG ! tag:example.com,2000:\n---\n' + PLAIN,
    'a document mark': '---\n' + PLAIN,
    'document marks around': '--- # map\n' + PLAIN + '...\n',
    'a second document': PLAIN + '---\nimage: other.png\n',
    'a second document that is broken': PLAIN + '---\nimage: [\n',
    'an indented mapping': ''.join(f'  {line}\n' for line in PLAIN.splitlines()),
    'anchors and aliases': PLAIN.replace('0.05', '&r 0.05').replace('free', 'same: *r\nfree'),
    'tags': PLAIN.replace('0.05', '!!float 0.05').replace('negate: 0', 'negate: !!int 0'),
    'a tag of another kind': PLAIN.replace('0.05', '!cells 0.05'),
    'a merge key, which counts for nothing': PLAIN + '<<: {mode: raw}\n',
    'other keys': PLAIN + 'cost: {a: [1, {b: c}], 7: 8}\n? [complex, key]\n: value\n',
    'zero-padded': PLAIN.replace('-1.5', '-01.50').replace('0.05', '00.050'),
    'numbers without a digit before the dot': PLAIN.replace(' 0.', ' .').replace('-2.0', '-2.'),
    'numbers with signs and exponents': PLAIN.replace('0.05', '+5.0E-2').replace('-1.5', '-15e-1'),
    **{
        f'negate: {word}': PLAIN.replace('negate: 0', f'negate: {word}')
        for word in (
            '"0"', "'0'", '00', '0x0', '-0', '+0', 'n', 'N', 'no', 'No', 'NO', 'off', 'Off', 'OFF',
            'false', 'False', 'FALSE', '"false"', "'n'", '"off"', '"0 "',
        )
    },
}  # fmt: skip


@pytest.mark.parametrize('case', ALIKE)
def test_read_alike(tmp_path: Path, case: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        assert read(tmp_path, ALIKE[case]) == EXPECTED


@pytest.mark.parametrize(
    'word',
    ['1', '"1"', '01', '0x1', '2', '-1', 'y', 'Y', 'yes', 'Yes', 'on', 'ON', 'true', '"TRUE"'],
)
def test_negated_alike(tmp_path: Path, word: str) -> None:
    assert read(tmp_path, PLAIN.replace('negate: 0', f'negate: {word}')) == NEGATED


def test_padded_numbers_are_decimal(tmp_path: Path) -> None:
    text = PLAIN.replace('[-1.5, -2.0, 0.5]', '[-010, -020, 000]')
    assert read(tmp_path, text)[1] == (-10.0, -20.0, 0.0)


@pytest.mark.parametrize(
    ('repeated', 'key'),
    [
        ('resolution: 0.1\n', 'resolution'),
        ('"resolution": 0.1\n', 'resolution'),
        ('negate: 1\n', 'negate'),
        ('origin: [0, 0, 0]\norigin: [1, 1, 1]\n', 'origin'),
    ],
)
def test_of_equal_keys_the_first_counts_and_a_warning_names_it(
    tmp_path: Path, repeated: str, key: str
) -> None:
    rule = f'map.yaml: the key {key} occurs repeatedly; the first value counts'
    with pytest.warns(MapFileWarning, match=rule) as caught:
        assert read(tmp_path, PLAIN + repeated) == EXPECTED
    assert len(caught) == 1


@pytest.mark.parametrize('encoding', ['utf-8', 'latin-1'])
def test_a_name_of_any_encoding_is_found_by_its_bytes(tmp_path: Path, encoding: str) -> None:
    name = 'größe 1.png'.encode(encoding)
    Image.fromarray(np.array([[255, 0]], np.uint8)).save(tmp_path / 'map.png')
    (tmp_path / 'map.png').rename(Path(str(tmp_path).encode().decode()) / _decoded(name))
    text = PLAIN.encode().replace(b'map.png', name)
    assert read(tmp_path, text)[2] == [[0, 100]]


def _decoded(name: bytes) -> str:
    return name.decode('utf-8', 'surrogateescape')


def test_a_name_of_digits_is_a_name(tmp_path: Path) -> None:
    Image.fromarray(np.array([[255, 0]], np.uint8)).save(tmp_path / 'map.png')
    (tmp_path / 'map.png').rename(tmp_path / '007')
    assert read(tmp_path, PLAIN.replace('map.png', '007'))[2] == [[0, 100]]
