"""A command whose libraries are missing names the extra that provides them."""

import json
from pathlib import Path
import subprocess
import sys
from test.cli.conftest import OFFICE, ROOT

import pytest

#: Program that runs commands without access to some libraries, and prints the exit code and the
#: errors of each.
WITHOUT = """
from contextlib import redirect_stderr, redirect_stdout
import io
import json
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {missing!r}:
            raise ModuleNotFoundError(f'there is no {{name}} here', name=name)

sys.meta_path.insert(0, Missing())
from importlib import util
found = util.find_spec
def find_spec(name, package=None):
    return None if name in {missing!r} else found(name, package)
util.find_spec = find_spec
from hnr_planner.cli.main import main

answers = []
for command in {commands!r}:
    errors = io.StringIO()
    with redirect_stderr(errors), redirect_stdout(io.StringIO()):
        answers.append((main(command), errors.getvalue()))
print(json.dumps(answers))
"""
PLAN = ['plan', str(OFFICE), '--start', '3', '22', '--goal', '34', '5']
EVERYTHING = ('joblib', 'matplotlib', 'tornado', 'tqdm')
CLUSTER = ('dask', 'distributed')
#: Commands, with PLOT, PAGE and OUT for what they would write; what each says, and the extra.
COMMANDS = {
    'plan --plot': ([*PLAN, '--plot', 'PLOT'], '--plot needs matplotlib', 'plot'),
    'plan --html': ([*PLAN, '--html', 'PAGE'], '--html needs matplotlib', 'plot'),
    'sample --plot': (
        ['sample', str(OFFICE), '--n', '3', '--plot', 'PLOT'],
        '--plot needs',
        'plot',
    ),
    'demo': (['demo', '--out', 'PLOT'], 'the demo needs', 'plot'),
    'experiment': (
        ['experiment', 'clouds', '--out', 'OUT'],
        'needs joblib, matplotlib, tqdm',
        'experiments',
    ),
    'watch': (['watch'], 'watch needs matplotlib, tornado', 'watch'),
    'experiment --dask': (
        ['experiment', '--out', 'OUT', '--dask', 'tcp://x:1'],
        '--dask needs dask',
        'cluster',
    ),
}


def run_without(missing: tuple[str, ...], commands: list[list[str]]) -> list[tuple[int, str]]:
    """Run commands in one process; return the exit code and the errors of each."""
    program = WITHOUT.format(missing=missing, commands=commands)
    done = subprocess.run(
        [sys.executable, '-c', program], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0 and done.stderr == '', done.stderr
    return [(code, errors) for code, errors in json.loads(done.stdout)]


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder in which the commands would write."""
    return tmp_path_factory.mktemp('outputs')


@pytest.fixture(scope='module')
def answers(folder: Path) -> dict[str, tuple[int, str]]:
    """Return what each of the commands answers where libraries are missing."""
    outputs = {'PLOT': 'plan.png', 'PAGE': 'plan.html', 'OUT': 'out'}
    found = {}
    for missing in (EVERYTHING, CLUSTER):
        chosen = {
            name: [str(folder / outputs[word]) if word in outputs else word for word in words]
            for name, (words, _, extra) in COMMANDS.items()
            if (extra == 'cluster') == (missing == CLUSTER)
        }
        said = run_without(missing, list(chosen.values()))
        found |= dict(zip(chosen, said, strict=True))
    return found


@pytest.mark.parametrize('name', COMMANDS)
def test_a_command_names_the_extra_that_it_needs(
    answers: dict[str, tuple[int, str]], folder: Path, name: str
) -> None:
    if name in ('demo', 'watch'):
        pytest.importorskip('rclpy', reason='it asks for ROS 2 first')
    _, what, extra = COMMANDS[name]
    code, error = answers[name]
    assert code == 2 and error.count('\n') == 1
    assert what in error and f"pip install 'hnr_planner[{extra}]'" in error
    assert list(folder.iterdir()) == []


def test_planning_and_sampling_need_no_extra() -> None:
    commands = [*PLAN, '--json', '--time-limit', '600'], ['sample', str(OFFICE), '--n', '3']
    assert run_without(EVERYTHING, list(commands)) == [(0, ''), (0, '')]
