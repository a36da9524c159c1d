"""The README and the pages of docs/: commands run, Python runs, links lead somewhere."""

from collections.abc import Iterator
from pathlib import Path
import re
import subprocess
import sys
from test.cli.conftest import ROOT
from test.cli.pictures import check_picture
from test.sweeps import sweep

from hnr_planner.core.kernels import modes
from hnr_planner.core.kernels.cache_folder import cache_folder, cache_home
from hnr_planner.core.planning.registry import PLANNERS
from PIL import Image
import pytest

pytestmark = pytest.mark.usefixtures('compiled')

README = (ROOT / 'README.md').read_text()
DOCS = ROOT / 'docs'


def blocks(language: str, page: str) -> list[str]:
    """Return the fenced blocks in a language on a page of docs/."""
    text = (DOCS / f'{page}.md').read_text()
    return re.findall(rf'^```{language}\n(.*?)^```', text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def clone(tmp_path: Path) -> Iterator[Path]:
    """Return a folder with the maps in their place, where files may be written."""
    (tmp_path / 'config').symlink_to(ROOT / 'config')
    yield tmp_path


def run(command: list[str], folder: Path, mode: modes.Mode | None = None) -> str:
    """Run a command in a folder, in the mode of this process by default; return what it said."""
    done = subprocess.run(
        command,
        cwd=folder,
        env={
            'PYTHONPATH': str(ROOT),
            'NUMBA_CACHE_DIR': str(cache_home(cache_folder())),
            'PATH': f'{Path(sys.executable).parent}:/usr/bin:/bin',
            modes.VARIABLE: (mode or modes.mode()).value,
        },
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


# What an experiment is made of, test/experiments/ runs, and how the command shows one,
# test_experiment.py.
@pytest.mark.parametrize('page', [sweep('map_files'), 'sampling', sweep('measured')])
def test_commands_run_and_write_their_files(page: str, clone: Path) -> None:
    (block,) = blocks('bash', page)
    out = run(['bash', '-ec', block], clone)
    assert 'SOLVED' in out or 'points' in out or 'figure ' in out
    for name in re.findall(r'--plot (\S+)', block):
        check_picture(clone / name)
    for name in re.findall(r'--html (\S+)', block):
        assert (clone / name).read_text().startswith('<!DOCTYPE html>')
    for folder in re.findall(r'--out (\S+)', block):
        assert {file.suffix for file in (clone / folder).iterdir()} >= {'.csv', '.svg', '.md'}
    for name in re.findall(r'--csv (\S+)', block):
        assert len((clone / name).read_text().splitlines()) == 5001


# What has no mark is of grids, whose machine code is there.
@pytest.mark.parametrize(
    ('page', 'begins'),
    [
        ('map_files', 'SOLVED path of'),
        ('trajectories', 'SOLVED trajectory of'),
        pytest.param(
            'sampling',
            '(4, 1000, 6)\nconverged: R-hat at most 1.0',
            marks=[pytest.mark.interpreted, pytest.mark.sweep],
        ),
    ],
)
def test_first_python_of_a_page_runs(page: str, begins: str, clone: Path) -> None:
    assert run([sys.executable, '-c', blocks('python', page)[0]], clone).startswith(begins)


# Interpreted: each is of another kind of space. What they show is tested elsewhere with less.
@pytest.mark.sweep
def test_python_of_many_jobs_and_steps_prints_what_the_pages_say(clone: Path) -> None:
    program = '\n'.join([*blocks('python', 'parallel'), blocks('python', 'sampling')[1]])
    out = run([sys.executable, '-c', program], clone, modes.Mode.INTERPRETED)
    threads, dask, cluster, moves = out.splitlines()
    assert threads == "['SOLVED', 'SOLVED', 'SOLVED']"
    assert dask == '(3, 5, 2)'
    assert cluster.startswith('(6, 500, 4) converged')
    assert moves.startswith('[')


def test_python_of_a_failure_prints_what_the_page_says(clone: Path) -> None:
    (wall,) = blocks('python', 'failures')
    out = run([sys.executable, '-c', wall], clone, modes.Mode.INTERPRETED)
    assert out.startswith('UNREACHABLE ')


#: Pages of the site that are made when it is built.
BUILT = {'gallery/index', 'reference/index'}


def leads_somewhere(page: Path, link: str) -> bool:
    """Return whether a link on a page leads to a file, or to a heading of it."""
    name, _, heading = link.partition('#')
    target = page.parent / name if name else page
    return target.exists() and (not heading or heading in headings(target.read_text()))


def headings(page: str) -> set[str]:
    """Return the anchors of the headings of a page."""
    titles = re.findall(r'^#+ (.*)$', page, re.MULTILINE)
    return {re.sub(r'[^\w -]', '', title.lower()).replace(' ', '-') for title in titles}


@pytest.mark.parametrize(
    'page', [ROOT / 'README.md', *sorted(DOCS.glob('*.md'))], ids=lambda page: page.stem
)
def test_links_lead_somewhere(page: Path) -> None:
    page = page.resolve()  # some belong to another folder
    links = re.findall(r'\]\(([^)]+)\)', page.read_text())
    links = [link for link in links if link not in BUILT]
    here = [link for link in links if not link.startswith('https://')]
    assert [link for link in here if not leads_somewhere(page, link)] == []


def test_the_table_of_algorithms_is_the_registry() -> None:
    page = (DOCS / 'algorithms.md').read_text()
    table = page.partition('| `algorithm` | how it searches |')[2].partition('\n\n')[0]
    rows = [line for line in table.splitlines() if line.startswith('| `')]
    assert rows == [f'| `{entry.name}` | {entry.summary} |' for entry in PLANNERS]


def test_make_targets_exist() -> None:
    makefile = (ROOT / 'Makefile').read_text()
    targets = set(re.findall(r'make ([a-z]+)', README))
    assert {'install', 'demo', 'test', 'check'} <= targets
    for target in targets:
        assert re.search(rf'^{target}:', makefile, re.MULTILINE), target


def test_names_of_ros_are_those_of_the_node() -> None:
    node = pytest.importorskip(
        'hnr_planner.ros.node.planner', reason='needs ROS 2', exc_type=ImportError
    )
    services = set(re.findall(r'`~/(plan\w*)`', (DOCS / 'robot.md').read_text()))
    assert services == set(node.SERVICES)


def test_the_readme_is_one_screen() -> None:
    assert len(README.splitlines()) <= 60


def test_picture_is_small_enough_to_load_at_once() -> None:
    file = ROOT / 'docs' / 'demo.png'
    assert file.stat().st_size < 300_000
    with Image.open(file) as image:
        assert image.width >= 1400
