"""Rows and draws from a Dask cluster are those of this process, also after an interruption."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from test.experiments.test_conduct import Case, CASES, experiment, measure, written
import time
from typing import Any

from hnr_planner.cli.main import main
from hnr_planner.core import sample
from hnr_planner.core.kernels import modes
from hnr_planner.experiments.cluster import on_cluster
from hnr_planner.experiments.conduct import conduct, measured_with
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.results import made_with, ResultsError
from joblib import delayed, Parallel
import numpy as np
import pytest

pytest.importorskip('distributed', reason='the extra cluster is not installed')

ROOT = Path(__file__).resolve().parents[2]
#: Program that conducts an experiment on a cluster, with more runs than can end. It takes SIGINT
#: also where whatever started the tests ignores it.
TO_BE_INTERRUPTED = """
from pathlib import Path
import signal
from test.experiments.test_cluster import gated
from hnr_planner.experiments.cluster import on_cluster
from hnr_planner.experiments.conduct import conduct
signal.signal(signal.SIGINT, signal.default_int_handler)
with on_cluster({address!r}):
    conduct(gated({gate!r}), 4, Path({folder!r}))
"""


@pytest.fixture(scope='module')
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Start a scheduler and two workers, whose processes set no mode; yield its address."""
    folder = tmp_path_factory.mktemp('cluster')
    file = folder / 'scheduler.json'
    environment = {name: value for name, value in os.environ.items() if name != modes.VARIABLE}
    environment |= {'PYTHONPATH': str(ROOT), 'DASK_DISTRIBUTED__LOGGING__DISTRIBUTED': 'error'}
    scheduler = 'dask_scheduler', '--host', '127.0.0.1', '--port', '0'
    worker = 'dask_worker', '--no-nanny', '--nthreads', '1', '--local-directory', str(folder)
    with ExitStack() as processes:
        for module, *options in (worker, worker, scheduler):
            command = [sys.executable, '-m', f'distributed.cli.{module}', *options]
            command += ['--no-dashboard', '--scheduler-file', str(file)]
            process = subprocess.Popen(command, env=environment, cwd=folder)
            processes.callback(process.wait, 60)
            processes.callback(process.kill)
        yield address_in(file)


def address_in(file: Path) -> str:
    """Return the address in a scheduler's file, once two workers have joined it."""
    from distributed import Client

    wait_for(file.exists)
    with Client(scheduler_file=str(file)) as client:
        client.wait_for_workers(2, timeout=120)
        return client.scheduler.address


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def gated(gate: str) -> Experiment:
    """Return the experiment of products, which waits before seed 2 until a file exists."""
    return experiment([Case(gate, case.factor) for case in CASES], measure_behind_a_gate)


def measure_behind_a_gate(case: Case, seed: int) -> Mapping[str, float]:
    while seed == 2 and not Path(case.name).exists():
        time.sleep(0.05)
    return measure(case, seed)


def test_command_writes_the_files_of_a_serial_run(cluster: str, tmp_path: Path) -> None:
    command = ['experiment', 'clouds', '--runs', '1', '--out']
    assert main([*command, str(tmp_path / 'serial'), '--jobs', '1']) == 0
    assert main([*command, str(tmp_path / 'cluster'), '--dask', cluster]) == 0
    assert written(tmp_path / 'cluster') == written(tmp_path / 'serial')


@pytest.mark.sweep
def test_interrupted_run_is_resumed(cluster: str, tmp_path: Path) -> None:
    gate, folder, serial = tmp_path / 'gate', tmp_path / 'cluster', tmp_path / 'serial'
    program = TO_BE_INTERRUPTED.format(address=cluster, gate=str(gate), folder=str(folder))
    rows = folder / 'arithmetic.csv'
    with subprocess.Popen(
        [sys.executable, '-c', program], cwd=ROOT, stderr=subprocess.PIPE
    ) as run:
        try:
            wait_for(lambda: rows.exists() and rows.read_text().count('\n') == 7)
            run.send_signal(signal.SIGINT)
            assert b'KeyboardInterrupt' in run.communicate(timeout=120)[1]
        finally:
            run.kill()
    before = rows.read_text()
    gate.touch()
    with on_cluster(cluster):
        conduct(gated(str(gate)), 4, folder)
    conduct(gated(str(gate)), 4, serial, n_jobs=1)
    assert written(folder) == written(serial)
    assert rows.read_text().startswith(before)


@pytest.mark.sweep
@pytest.mark.interpreted
def test_example_of_the_page_draws_the_same_in_a_set_of_a_lambda(cluster: str) -> None:
    page = (ROOT / 'docs' / 'parallel.md').read_text()
    names: dict[str, Any] = {}
    exec(re.findall(r'```python\n(.*?)```', page, re.DOTALL)[1], names)
    expected = sample(names['ring'], (0.7, 0.0), 5, n_chains=3, seed=1)
    np.testing.assert_array_equal(names['draws_from'](cluster), expected)


@pytest.mark.parametrize('mode', [modes.Mode.COMPILED, modes.Mode.INTERPRETED])
def test_workers_run_kernels_in_the_mode_of_the_caller(cluster: str, mode: modes.Mode) -> None:
    with modes.mode_of_thread(mode):
        there = modes.in_this_mode(modes.mode)
    with on_cluster(cluster):
        assert Parallel()([delayed(modes.mode)()]) == [modes.Mode.AUTO]
        assert Parallel()([delayed(there)()]) == [mode]


def test_worker_with_other_versions_is_refused() -> None:
    versions = made_with()
    assert measured_with(versions, measure, CASES[0], 1) == measure(CASES[0], 1)
    with pytest.raises(ResultsError, match=r'would compute with numba .* \(expected 0\.1\)$'):
        measured_with(versions | {'numba': '0.1'}, measure, CASES[0], 1)


def test_address_without_a_scheduler_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(['experiment', 'clouds', '--dask', 'nowhere://127.0.0.1']) == 2
    assert 'no Dask scheduler answers at nowhere://127.0.0.1' in capsys.readouterr().err


def test_jobs_of_this_machine_and_a_cluster_exclude_each_other() -> None:
    assert main(['experiment', 'clouds', '--jobs', '2', '--dask', 'tcp://127.0.0.1:1']) == 2
