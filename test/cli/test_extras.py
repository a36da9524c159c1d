"""A command whose libraries are missing names the extra that provides them."""

from pathlib import Path
import subprocess
import sys
from test.cli.conftest import OFFICE, ROOT

import pytest

#: Program that runs the command line without access to some libraries.
WITHOUT = """
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
sys.exit(main({arguments!r}))
"""
PLAN = ['plan', str(OFFICE), '--start', '3', '22', '--goal', '34', '5']
EVERYTHING = ('joblib', 'matplotlib', 'tornado', 'tqdm')
CLUSTER = ('dask', 'distributed')


def run_without(missing: tuple[str, ...], *arguments: str) -> tuple[int, str]:
    program = WITHOUT.format(missing=missing, arguments=arguments)
    done = subprocess.run(
        [sys.executable, '-c', program], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    ('arguments', 'what', 'extra'),
    [
        ([*PLAN, '--plot', 'PLOT'], '--plot needs matplotlib', 'plot'),
        ([*PLAN, '--html', 'PAGE'], '--html needs matplotlib', 'plot'),
        (['sample', str(OFFICE), '--n', '3', '--plot', 'PLOT'], '--plot needs', 'plot'),
        (['demo', '--out', 'PLOT'], 'the demo needs', 'plot'),
        (
            ['experiment', 'clouds', '--out', 'OUT'],
            'needs joblib, matplotlib, tqdm',
            'experiments',
        ),
        (['watch'], 'watch needs matplotlib, tornado', 'watch'),
        (['experiment', '--out', 'OUT', '--dask', 'tcp://x:1'], '--dask needs dask', 'cluster'),
    ],
    ids=[
        'plan --plot',
        'plan --html',
        'sample --plot',
        'demo',
        'experiment',
        'watch',
        'experiment --dask',
    ],
)
def test_a_command_names_the_extra_that_it_needs(
    arguments: list[str], what: str, extra: str, tmp_path: Path
) -> None:
    if arguments[0] in ('demo', 'watch'):
        pytest.importorskip('rclpy', reason='it asks for ROS 2 first')
    outputs = {'PLOT': 'plan.png', 'PAGE': 'plan.html', 'OUT': 'out'}
    words = [str(tmp_path / outputs[word]) if word in outputs else word for word in arguments]
    code, error = run_without(CLUSTER if extra == 'cluster' else EVERYTHING, *words)
    assert code == 2 and error.count('\n') == 1
    assert what in error and f"pip install 'hnr_planner[{extra}]'" in error
    assert list(tmp_path.iterdir()) == []


def test_planning_and_sampling_need_no_extra() -> None:
    for command in ([*PLAN, '--json', '--time-limit', '600'], ['sample', str(OFFICE), '--n', '3']):
        code, error = run_without(EVERYTHING, *command)
        assert code == 0, error
