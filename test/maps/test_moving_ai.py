"""Grid maps of the Moving AI benchmarks are read by the rules of their format."""

from pathlib import Path

from hnr_planner.maps import load_map, MapFileError
import pytest

WHOLE = 'type octile\nheight 2\nwidth 5\nmap\n.G@OT\n.....\n'


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / 'city.map'
    path.write_bytes(text.encode('latin-1'))
    return path


def test_row_of_the_file_is_row_of_the_grid(tmp_path: Path) -> None:
    loaded = load_map(written(tmp_path, WHOLE))
    assert loaded.data.tolist() == [[0, 0, 100, 100, 100], [0, 0, 0, 0, 0]]
    assert (loaded.resolution, loaded.origin) == (1.0, (0.0, 0.0, 0.0))


def test_ground_and_swamp_are_free_and_all_else_is_occupied(tmp_path: Path) -> None:
    row = '.GS@OTW#gs,1'
    text = f'type octile\nheight 1\nwidth {len(row)}\nmap\n{row}\n'
    assert load_map(written(tmp_path, text)).data.tolist() == [[0, 0, 0] + [100] * 9]


@pytest.mark.parametrize(
    'head',
    [
        'type\toctile\nheight\t2\nwidth\t5\nmap\n',
        'type octile \nheight   2\t\nwidth 5  \nmap \n',
        '  type octile\n\theight 2\n width 5\n\tmap\n',
        'type octile\n\nheight 2\nwidth 5\n\nmap\n',
        'width 5\nheight 2\ntype octile\nmap\n',
        'type octile\rheight 2\rwidth 5\rmap\r',
    ],
    ids=['tabs', 'blanks behind', 'blanks before', 'empty lines', 'another order', 'old Mac'],
)
def test_whitespace_and_order_of_the_header_do_not_matter(tmp_path: Path, head: str) -> None:
    assert load_map(written(tmp_path, head + '.G@OT\n..... \n')).data.shape == (2, 5)


@pytest.mark.parametrize('text', [WHOLE.replace('\n', '\r\n'), WHOLE.rstrip('\n'), WHOLE + '\n\n'])
def test_line_ends_do_not_matter(tmp_path: Path, text: str) -> None:
    assert load_map(written(tmp_path, text)).data.shape == (2, 5)


def test_suffix_may_be_in_capitals(tmp_path: Path) -> None:
    path = written(tmp_path, WHOLE).rename(tmp_path / 'CITY.MAP')
    assert load_map(str(path)).data.shape == (2, 5)


@pytest.mark.parametrize(
    ('old', 'new', 'reason'),
    [
        ('octile', 'hex', "type: must be octile, not 'hex'"),
        ('type octile\n', '', 'type: must be octile, not missing'),
        ('height 2\n', '', 'the key height is missing'),
        ('width 5', 'width five', "width: must be a whole number > 0, not 'five'"),
        ('width 5', 'width 0', "width: must be a whole number > 0, not '0'"),
        ('height 2', 'height -2', "height: must be a whole number > 0, not '-2'"),
        ('height 2', 'height ' + '9' * 30, 'height: must be a whole number > 0'),
        ('height 2', 'height 3', 'height: is 3, but 2 rows follow'),
        ('height 2', 'height 1', 'height: is 1, but 2 rows follow'),
        ('.....\n', '....\n', 'width: is 5, but row 1 has 4 cells'),
        ('map\n', '', 'the line "map", which starts the cells, is missing'),
    ],
)
def test_broken_file(tmp_path: Path, old: str, new: str, reason: str) -> None:
    path = written(tmp_path, WHOLE.replace(old, new))
    with pytest.raises(MapFileError) as caught:
        load_map(path)
    assert str(caught.value).startswith(f'{path}: {reason}')


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match=r'none.map: cannot be opened \(No such file'):
        load_map(tmp_path / 'none.map')
