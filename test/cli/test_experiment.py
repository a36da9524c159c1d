"""The command ``experiment``."""

from collections.abc import Callable
from pathlib import Path
import sys
from test.cli.conftest import Ran, run_process

from hnr_planner.experiments import EXPERIMENTS, NAMES
import pytest


def test_help_lists_every_experiment(run: Callable[..., Ran]) -> None:
    text = run('experiment', '--help').out
    for entry in EXPERIMENTS.values():
        assert f'  {entry.name} ' in text and entry.summary in text


@pytest.fixture(scope='module')
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a new folder for the measurements of all tests here."""
    return tmp_path_factory.mktemp('experiment') / 'new' / 'folder'


def test_it_writes_prints_and_shows(
    run: Callable[..., Ran], measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = tmp_path / 'shown'
    browser = tmp_path / 'browser'
    browser.write_text(
        f'#!{sys.executable}\nimport sys\nopen({str(shown)!r}, "w").write(sys.argv[1])\n'
    )
    browser.chmod(0o755)
    monkeypatch.setenv('BROWSER', f'{browser} %s')
    ran = run('experiment', 'clouds', '--runs', 1, '--out', measured, '--jobs', 1, '--show')
    assert ran.code == 0
    assert '| 1.2, RRT |' in ran.out
    assert (measured / 'clouds.csv').read_text().startswith('width,algorithm,seed,transitions,')
    assert shown.read_text() == (measured / 'clouds.svg').as_uri()


def test_without_a_browser_it_says_so(measured: Path) -> None:
    command = ['experiment', 'clouds', '--runs', 1, '--out', measured, '--jobs', 1, '--show']
    ran = run_process(*command, BROWSER='/nonexistent', PATH='', DISPLAY='')
    assert ran.code == 0
    assert ran.err.endswith('no browser was found to show it\n')


def test_an_unknown_name_is_refused(run: Callable[..., Ran], tmp_path: Path) -> None:
    ran = run('experiment', 'sprial', '--out', tmp_path / 'out')
    assert ran.code == 2
    assert ran.err == f"error: experiment must be one of {', '.join(NAMES)}, got 'sprial'\n"
    assert not (tmp_path / 'out').exists()


@pytest.mark.parametrize('runs', ['0', '-1', 'many'])
def test_a_number_of_runs_that_makes_no_sense_is_refused(
    run: Callable[..., Ran], runs: str
) -> None:
    ran = run('experiment', 'clouds', '--runs', runs)
    assert ran.code == 2 and '--runs' in ran.err


def test_results_of_something_else_are_refused(run: Callable[..., Ran], tmp_path: Path) -> None:
    (tmp_path / 'clouds.csv').write_text('a\n1\n')
    (tmp_path / 'clouds.json').write_text('{"core": "of another day"}')
    ran = run('experiment', 'clouds', '--out', tmp_path)
    assert ran.code == 2
    assert 'other sources of the core' in ran.err
    assert (tmp_path / 'clouds.csv').read_text() == 'a\n1\n'
