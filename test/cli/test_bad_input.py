"""Bad input: exit code 2, nothing on stdout, one line on stderr that names fault and place."""

from collections.abc import Callable
from pathlib import Path
import resource
from test.cli.conftest import Ran, run_process

import pytest

Run = Callable[..., Ran]
PLAN = ['plan', 'MAP', '--start', '1', '3', '--goal', '2', '3']

CASES = {
    'no command': ([], ['COMMAND']),
    'unknown command': (['plam'], ['plam', 'plan']),
    'no map': (['plan', '--start', '1', '1', '--goal', '2', '2'], ['required: ']),
    'no goal': (['plan', 'MAP', '--start', '1', '3'], ['--goal']),
    'one coordinate': (
        ['plan', 'MAP', '--start', '1', '--goal', '2', '3'],
        ['--start 1 0.5', 'not 1 '],
    ),
    'three coordinates': (
        ['plan', 'MAP', '--start', '1', '2', '3', '--goal', '2', '3'],
        ['--start 1 2;', 'not 1 2 3'],
    ),
    'three coordinates before the map': (
        ['plan', '--goal', '2', '3', '4', '--start', '1', '2', 'MAP'],
        ['--goal 2 3;', 'not 2 3 4'],
    ),
    'comma': (
        ['plan', 'MAP', '--start', '.5,.5', '--goal', '2', '3'],
        ['--start .5 .5;', 'not .5,.5'],
    ),
    'comma after an equals sign': (
        ['plan', 'MAP', '--goal=2,-3', '--start', '1', '2'],
        ['--goal 2 -3;', 'not 2,-3'],
    ),
    'comma and blank': (
        ['plan', 'MAP', '--start', '1,', '2', '--goal', '2', '3'],
        ['--start 1 2;', 'not 1, 2'],
    ),
    'brackets': (['sample', 'MAP', '--n', '5', '--start', '(1, 2)'], ['--start 1 2;', '(1, 2)']),
    'word for a number': ([*PLAN[:2], '--start', 'x', '3', *PLAN[5:]], ['--start', "'x'"]),
    'nan': ([*PLAN[:2], '--start', 'nan', '3', *PLAN[5:]], ['--start', 'nan', 'finite']),
    'infinite goal': ([*PLAN[:5], '--goal', '-inf', '3'], ['--goal', '-inf', 'finite']),
    'unknown option': ([*PLAN, '--sed', '1'], ['--sed']),
    'unknown algorithm': ([*PLAN, '--algorithm', 'dijkstra'], ['dijkstra', 'hit_and_run']),
    'negative radius': ([*PLAN, '--robot-radius', '-1'], ['--robot-radius', '-1']),
    'endless radius': ([*PLAN, '--robot-radius', 'inf'], ['--robot-radius', 'inf']),
    'unknown kind': ([*PLAN, '--unknown', 'maybe'], ['--unknown', 'maybe', 'blocked']),
    'no time': ([*PLAN, '--time-limit', '0'], ['--time-limit', '0']),
    'negative goal radius': ([*PLAN, '--goal-radius', '-.1'], ['--goal-radius', '-.1']),
    'negative seed': ([*PLAN, '--seed', '-3'], ['--seed', '-3']),
    'half a seed': ([*PLAN, '--seed', '1.5'], ['--seed', '1.5']),
    'plot in no folder': ([*PLAN, '--plot', 'no/such/a.png'], ['--plot', 'no/such']),
    'plot of no kind': ([*PLAN, '--plot', 'a.txt'], ['--plot', 'a.txt', '.png']),
    'no file': (['plan', 'no_such.yaml', *PLAN[2:]], ['no_such.yaml']),
    'a folder': (['plan', 'FOLDER', *PLAN[2:]], ['FOLDER']),
    'broken yaml': (['plan', 'BROKEN', *PLAN[2:]], ['BROKEN', 'resolution']),
    'no image': (['plan', 'IMAGELESS', *PLAN[2:]], ['nowhere.pgm']),
    'no points': (['sample', 'MAP', '--n', '0'], ['--n', '0']),
    'too many points': (['sample', 'MAP', '--n', '100000000000'], ['--n', '100000000000']),
    'thinned to nothing': (['sample', 'MAP', '--n', '5', '--thin', '0'], ['--thin', '0']),
    'points by halves': (['sample', 'MAP', '--n', '2.5'], ['--n', '2.5']),
    'no number': (['sample', 'MAP'], ['--n']),
    'unknown walk': (['sample', 'MAP', '--n', '5', '--walk', 'moon'], ['moon', 'hit_and_run']),
    'radius of another walk': (['sample', 'MAP', '--n', '5', '--radius', '1'], ['--radius']),
    'walk from outside': (
        ['sample', 'MAP', '--n', '5', '--start', '99', '1'],
        ['99', 'outside the map'],
    ),
    'no free cell': (['sample', 'SOLID', '--n', '5'], ['SOLID', 'free']),
    'two outputs in one file': (
        ['sample', 'MAP', '--n', '5', '--csv', 'x.png', '--plot', './x.png'],
        ['--csv', '--plot', 'x.png'],
    ),
    'csv is a folder': (['sample', 'MAP', '--n', '5', '--csv', 'FOLDER'], ['--csv', 'FOLDER']),
    'demo without its map': (['demo', '--map', 'no_such.yaml'], ['no_such.yaml']),
    'demo on a solid map': (['demo', '--map', 'SOLID'], ['SOLID', 'free']),
    'demo draws nowhere': (['demo', '--out', 'no/such/a.png'], ['--out', 'no/such']),
}


@pytest.fixture
def places(rooms_file: Path, solid_file: Path, tmp_path: Path) -> dict[str, str]:
    """Return the files that replace the words in capitals of a command."""
    broken, imageless = tmp_path / 'broken.yaml', tmp_path / 'imageless.yaml'
    text = rooms_file.read_text()
    broken.write_text(text.replace('resolution: 0.1', 'resolution: minus one'))
    image = next(line for line in text.splitlines() if line.startswith('image:'))
    imageless.write_text(text.replace(image, 'image: nowhere.pgm'))
    files = {
        'MAP': rooms_file,
        'SOLID': solid_file,
        'BROKEN': broken,
        'IMAGELESS': imageless,
        'FOLDER': tmp_path,
    }
    return {name: str(file) for name, file in files.items()}


@pytest.mark.parametrize('case', CASES)
def test_bad_input_is_one_line_and_code_2(run: Run, places: dict[str, str], case: str) -> None:
    arguments, words = CASES[case]
    ran = run(*(places.get(word, word) for word in arguments))
    assert ran.code == 2
    assert ran.out == '' or arguments[0] == 'demo'  # which tells what it does
    assert ran.err.startswith('error: ')
    assert ran.err.count('\n') == 1 and ran.err.endswith('\n')
    for word in words:
        assert places.get(word, word) in ran.err


def test_more_points_than_memory_are_one_line(run: Run, places: dict[str, str]) -> None:
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (8 * 10**9, before[1]))
    try:
        ran = run('sample', places['MAP'], '--n', 10**9)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
    assert (ran.code, ran.out) == (2, '')
    assert ran.err.startswith('error: too large for this machine: ')
    assert ran.err.count('\n') == 1


def test_in_a_process_there_is_no_traceback_either() -> None:
    ran = run_process('plan', 'no_such.yaml', '--start', 0, 0, '--goal', 1, 1)
    assert (ran.code, ran.out) == (2, '')
    assert ran.err.startswith('error: no_such.yaml')
    assert ran.err.count('\n') == 1


@pytest.mark.parametrize('command', ['plan', 'sample', 'demo'])
def test_no_file_of_the_map_is_written_over(
    run: Run, places: dict[str, str], command: str
) -> None:
    image = next(file for file in Path(places['MAP']).parent.iterdir() if file.suffix == '.png')
    before = image.read_bytes()
    arguments = {
        'plan': [*PLAN, '--plot', image],
        'sample': ['sample', 'MAP', '--n', '3', '--plot', image],
        'demo': ['demo', '--map', 'MAP', '--out', image],
    }
    ran = run(*(places.get(str(word), word) for word in arguments[command]))
    assert (ran.code, ran.out) == (2, '')
    assert str(image) in ran.err and 'belongs to the map' in ran.err
    assert image.read_bytes() == before


def test_a_file_that_cannot_be_written_is_named(run: Run, places: dict[str, str]) -> None:
    ran = run('sample', places['MAP'], '--n', 3, '--csv', '/proc/points.csv')
    assert ran.code == 2
    assert '/proc/points.csv' in ran.err and ran.err.count('\n') == 1


def test_a_repeated_key_is_a_warning_of_one_line(run: Run, places: dict[str, str]) -> None:
    file = Path(places['BROKEN'])
    file.write_text(Path(places['MAP']).read_text() + 'resolution: 7\n')
    (file.parent / 'rooms.png').write_bytes(
        (Path(places['MAP']).parent / 'rooms.png').read_bytes()
    )
    ran = run('sample', file, '--n', 1, '--seed', 1)
    text = f'warning: {file}: the key resolution occurs repeatedly; the first value counts\n'
    assert (ran.code, ran.err) == (0, text)
    assert ran.out == run('sample', places['MAP'], '--n', 1, '--seed', 1).out
