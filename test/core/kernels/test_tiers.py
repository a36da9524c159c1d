"""
Two tiers: calls are answered interpreted until a child process has compiled, then by machine code.

Each test runs processes of its own with an empty cache. What they wait for are events; a test
fails when one does not come within ``PATIENCE``, and never because a machine is slow.
"""

import os
from pathlib import Path
import signal
from test.sweeps import sweep
import time

import pytest

from .conftest import next_line, output, PATIENCE, ROOT, Start

SWITCH = """
import numpy as np
a, b = np.array([1.0, -1.0, 0.0, 7.0]), np.array([0.0, 3.0, 0.0, 3.0])
def answer():
    return (
        samples.halved(7.0), samples.collatz(27), samples.mean_of_ratios(a[3:], b[3:]),
        str(samples.mean_of_ratios(a, b)), samples.total(samples.Pair(1.5, 2.5), 0.1),
    )
answers = [answer()]
say('INTERPRETED', interpreted_calls())
while True:
    before = interpreted_calls()
    answers.append(answer())
    if interpreted_calls() == before:
        break
    time.sleep(0.01)
assert len(set(answers)) == 1, set(answers)
say('ANSWER', answers[0])
say('STATUS', compilation.status().tier, compilation.status().compiled)
wait(lambda: not compilation.status().running)
"""


def test_a_stream_of_calls_goes_over_to_machine_code_with_the_same_answers(start: Start):
    lines = output(start(SWITCH))
    assert 'INTERPRETED 5' in lines
    assert "ANSWER (3.5, 111, 2.3333333333333335, 'nan', 0.4)" in lines
    assert 'STATUS compiled 4' in lines
    logged = [line for line in lines if line.startswith('LOG')]
    assert len(logged) == 2
    assert 'runs in the background' in logged[0]
    assert 'compilation is done: 4 kernels in' in logged[1]


@pytest.mark.sweep
def test_the_next_process_finds_what_this_one_compiled(start: Start):
    output(start(SWITCH))
    lines = output(
        start("""
        say(samples.halved(7.0), samples.collatz(27), interpreted_calls())
        say(compilation.status())
        """)
    )
    assert lines == ['3.5 111 0', 'all kernels asked for are compiled']


@pytest.mark.sweep
def test_what_is_asked_for_while_the_child_works_comes_as_well(start: Start, tmp_path: Path):
    (tmp_path / 'open').touch()
    lines = output(
        start("""
        samples.gated(1.0)
        wait(lambda: compilation.status().running)
        samples.halved(1.0)
        samples.gated(1)
        wait(lambda: compilation.status().compiled == 3)
        say(interpreted_calls())
        samples.gated(1), samples.gated(1.0), samples.halved(1.0)
        say(interpreted_calls())
        """)
    )
    assert [line for line in lines if not line.startswith('LOG')] == ['3', '3']


PREPARE = """
from hnr_planner.core.kernels.needs import Workload
compilation.prepare(Workload(samples.__name__, 'use'))
"""


def test_what_a_use_needs_is_compiled_before_anybody_calls_it(start: Start):
    lines = output(
        start(
            PREPARE
            + """
wait(lambda: compilation.status().compiled == 2)
samples.use()
say(interpreted_calls(), compilation.status())
"""
        )
    )
    assert lines[-1] == '0 all kernels asked for are compiled'
    lines = output(
        start(
            PREPARE
            + """
wait(lambda: samples.halved.overloads and samples.collatz.overloads)
samples.use()
say(interpreted_calls(), compilation.status().running)
"""
        )
    )
    assert lines == ['0 False']


def test_what_a_call_waits_for_comes_before_what_uses_need(start: Start, tmp_path: Path):
    process = start(
        """
names = []
take = compilation._background.take
def note(notice):
    take(notice)
    names.append('workload' if isinstance(notice.about, list) else notice.about.name)
compilation._background.take = note  # before there is a thread that may hold the old one
samples.gated(1.0)
"""
        + PREPARE
        + """
wait(samples.someone_compiles_gated)
samples.total(samples.Pair(1.0, 2.0), 1.0)
wait(lambda: compilation._background.workloads and compilation._background.messages.empty())
say('ASKED')
wait(lambda: compilation.status().compiled >= 4 and not compilation.status().pending)
say(*names)
"""
    )
    next_line(process, 'ASKED')
    (tmp_path / 'open').touch()
    names = output(process)[-1].split()
    assert names[:3] == ['gated', '_total_of_pair', 'workload']
    assert names[-2:] == ['halved', 'collatz']


def test_work_that_waits_for_the_compiler_says_so_once(start: Start):
    lines = output(
        start("""
        from hnr_planner.core.kernels.modes import waiting_for_machine_code
        for _ in range(2):
            with waiting_for_machine_code('the work'):
                samples.halved(1.0), samples.collatz(27)
        say(interpreted_calls())
        """)
    )
    assert lines == ['LOG WARNING the work waits for the compiler, once on this machine', '0']


# -- the child ends with its parent ---------------------------------------------------------------


def is_running(pid: int) -> bool:
    """Return whether there is such a process, and it is not a dead one that nobody waited for."""
    try:
        state = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()[0]
    except FileNotFoundError:
        return False
    return state != 'Z'


def wait_for_gate(folder: Path, n: int = 1) -> set[int]:
    """Return the processes that compile ``samples.gated``, once there are ``n``."""
    end = time.monotonic() + PATIENCE
    while True:
        marks = {int(mark.name.split()[-1]) for mark in folder.glob('compiled by *')}
        if len(marks) >= n:
            return marks
        assert time.monotonic() < end, 'nobody compiles'
        time.sleep(0.01)


def test_a_child_that_compiles_ends_when_its_parent_is_killed(start: Start, tmp_path: Path):
    parent = start('samples.gated(1.0)\nsay("ASKED")\nsys.stdin.read()')
    (child,) = wait_for_gate(tmp_path)
    assert is_running(child)
    parent.send_signal(signal.SIGKILL)
    end = time.monotonic() + PATIENCE
    while is_running(child):
        assert time.monotonic() < end, 'the child outlives its parent'
        time.sleep(0.01)


@pytest.mark.sweep
def test_a_child_ends_when_its_parent_ends(start: Start, tmp_path: Path):
    parent = start('samples.gated(1.0)\nsay("ASKED")\nsys.stdin.read()')
    (child,) = wait_for_gate(tmp_path)
    output(parent)
    assert not is_running(child)


# -- several processes ----------------------------------------------------------------------------


def test_processes_that_start_together_compile_once(start: Start, tmp_path: Path):
    script = """
    samples.gated(1.0)
    wait(lambda: compilation.status().running)
    say('CHILD', compilation._background.process.pid)
    wait(lambda: compilation.status().compiled == 1)
    before = interpreted_calls()
    samples.gated(1.0)
    say('INTERPRETED', interpreted_calls() - before)
    """
    processes = [start(script), start(script)]
    children = {int(next_line(process, 'CHILD')) for process in processes}
    (compiling,) = wait_for_gate(tmp_path)
    (other,) = children - {compiling}
    end = time.monotonic() + PATIENCE
    while f'-> FLOCK  ADVISORY  WRITE {other} ' not in Path('/proc/locks').read_text():
        assert time.monotonic() < end, 'the other child does not wait for the lock'
        time.sleep(0.01)
    (tmp_path / 'open').touch()
    for process in processes:
        assert 'INTERPRETED 0' in output(process)
    assert wait_for_gate(tmp_path) == {compiling}


def test_a_killed_child_leaves_no_lock_behind_and_costs_one_line_of_log(
    start: Start, tmp_path: Path
):
    first = start("""
    samples.gated(1.0)
    wait(lambda: compilation.status().running)
    say('ASKED')
    wait(lambda: not compilation.status().running and compilation.status().failed == 1)
    say('ANSWER', samples.gated(2.0), samples.halved(3.0), samples.halved(3.0))
    say('STATUS', compilation.status().tier, compilation.status())
    """)
    next_line(first, 'ASKED')
    (child,) = wait_for_gate(tmp_path)
    os.kill(child, signal.SIGKILL)
    second = start("""
    samples.gated(1.0)
    wait(lambda: compilation.status().compiled == 1)
    """)
    wait_for_gate(tmp_path, 2)
    (tmp_path / 'open').touch()
    output(second)
    lines = output(first)
    assert 'ANSWER 2.0 1.5 1.5' in lines
    assert 'STATUS interpreted 1 kernels could not be compiled and run interpreted' in lines
    assert [line for line in lines if 'WARNING' in line] == [
        'LOG WARNING the process that compiles kernels ended (-9): '
        'what has no machine code yet runs interpreted'
    ]


# -- what can go wrong ----------------------------------------------------------------------------


def test_a_kernel_that_numba_refuses_stays_interpreted(start: Start):
    lines = output(
        start("""
        say(samples.uncompilable(3))
        samples.halved(1.0)
        wait(lambda: compilation.status().pending == 0)
        say(samples.uncompilable(3), samples.halved(1.0))
        say(compilation.status().failed, compilation.status().compiled)
        """)
    )
    assert [line for line in lines if not line.startswith('LOG')] == ['3', '3 0.5', '1 1']
    (warning,) = [line for line in lines if 'WARNING' in line]
    assert 'uncompilable stays interpreted: ' in warning


@pytest.mark.sweep
def test_without_a_folder_to_write_kernels_are_compiled_for_this_process(
    start: Start, tmp_path: Path
):
    occupied = tmp_path / 'a file'
    occupied.touch()
    lines = output(
        start(
            """
            samples.halved(1.0)
            wait(lambda: compilation.status().compiled == 1)
            before = interpreted_calls()
            say(samples.halved(1.0), interpreted_calls() - before)
            """,
            NUMBA_CACHE_DIR=str(occupied),
        )
    )
    assert '0.5 0' in lines
    assert (
        sum('set NUMBA_CACHE_DIR to a folder that can be written' in line for line in lines) == 1
    )


def test_without_numbas_compiler_everything_runs_interpreted(start: Start):
    lines = output(
        start(
            """
            say(samples.halved(7.0), samples.total(samples.Pair(1.0, 2.0), 2.0))
            say(interpreted_calls(), compilation.status().running, compilation.status().pending)
            """,
            NUMBA_DISABLE_JIT='1',
        )
    )
    assert lines == ['3.5 6.0', '2 False 0']


def test_interpreted_mode_never_asks_for_a_compiler(start: Start):
    lines = output(
        start(
            'say(samples.halved(7.0), interpreted_calls(), compilation.status().pending)',
            HNR_PLANNER_KERNELS='interpreted',
        )
    )
    assert lines == ['3.5 1 0']


def test_compiled_mode_waits_for_the_compiler(start: Start):
    lines = output(
        start(
            """
            from hnr_planner.core.kernels.clock import working_time
            before = working_time(), time.perf_counter()
            say(samples.halved(7.0), interpreted_calls(), compilation.status().running)
            worked, passed = working_time() - before[0], time.perf_counter() - before[1]
            say('WORKED', worked < passed)
            """,
            HNR_PLANNER_KERNELS='compiled',
        )
    )
    assert lines == ['3.5 0 False', 'WORKED True']


def test_a_mode_that_there_is_not_is_refused(start: Start):
    process = start('', HNR_PLANNER_KERNELS='fast')
    text, _ = process.communicate(timeout=PATIENCE)
    assert "HNR_PLANNER_KERNELS must be one of auto, compiled, interpreted, got 'fast'" in text


FULL_DISK = """
import numba.core.caching
def fail(*_):
    raise OSError(28, 'No space left on device')
numba.core.caching.IndexDataCacheFile._save_data = fail
"""


def test_a_full_disk_costs_a_line_of_log_where_calls_wait_for_the_compiler(start: Start):
    script = 'say(samples.halved(7.0), samples.halved(7.0), interpreted_calls())'
    lines = output(start(FULL_DISK + script, HNR_PLANNER_KERNELS='compiled'))
    warning, answers = lines
    assert 'halved' in warning
    assert 'cannot be kept: [Errno 28] No space left on device' in warning
    assert answers == '3.5 3.5 0'


def test_a_child_whose_disk_is_full_says_so(start: Start, tmp_path: Path):
    (tmp_path / 'sitecustomize.py').write_text(FULL_DISK)
    lines = output(
        start(
            """
            samples.halved(7.0)
            wait(lambda: compilation.status().failed == 1)
            say(samples.halved(7.0), interpreted_calls())
            """,
            PYTHONPATH=f'{tmp_path}:{ROOT}',
        )
    )
    assert '3.5 2' in lines
    (warning,) = [line for line in lines if 'WARNING' in line]
    assert warning.endswith(
        'halved stays interpreted: OSError: [Errno 28] No space left on device'
    )


# The one of most parts; the others are sweeps.
@pytest.mark.parametrize(
    ('mode', 'damage'),
    [
        ('auto', 'a type that is gone'),
        sweep('compiled', 'no index at all'),
        sweep('auto', 'no index at all'),
        sweep('compiled', 'a type that is gone'),
    ],
)
def test_a_cache_that_cannot_be_read_is_made_anew(
    start: Start, tmp_path: Path, mode: str, damage: str
):
    module = tmp_path / 'mine.py'
    module.write_text('from typing import NamedTuple\nclass Mine(NamedTuple):\n    one: float\n')
    script = 'import mine\nsay(samples.first_of(mine.Mine(2.0)))'
    assert output(start(script, HNR_PLANNER_KERNELS='compiled'))[-1] == '2.0'
    (index,) = (tmp_path / 'cache').rglob('*first_of*.nbi')
    module.unlink()
    if damage == 'no index at all':
        index.write_bytes(index.read_bytes()[:-20])
    lines = output(
        start(
            """
            samples.first_of((3.0, 1.0))
            wait(lambda: not compilation.status().pending)
            before = interpreted_calls()
            say(samples.first_of((3.0, 1.0)), interpreted_calls() - before)
            """,
            HNR_PLANNER_KERNELS=mode,
        )
    )
    assert any('first_of' in line and 'cannot be used' in line for line in lines)
    assert '3.0 0' in lines
    assert output(start('say(samples.first_of((3.0, 1.0)), interpreted_calls())')) == ['3.0 0']
