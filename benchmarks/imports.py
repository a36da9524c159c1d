"""What the import of the package costs: time and compilations, in a fresh Python."""

from collections.abc import Iterator
import os
import resource
from statistics import median
import subprocess
import sys

from benchmarks.progress import show
from benchmarks.sections import Verdict

#: Target: time of the import over that of its two largest libraries.
IMPORT_AT_MOST = 1.5
IMPORTS, LIBRARIES = 'from hnr_planner import GridSpace, plan, sample', 'import numba, scipy'
COUNT_COMPILATIONS = f"""
from numba.core import event
with event.install_recorder('numba:compile') as recorder:
    {IMPORTS}
print(len(recorder.buffer))
"""


def import_time(statement: str, n_times: int) -> float:
    """
    Return the median processor time [s] of a statement in a fresh Python.

    Byte code is kept, as that of an installed package is.
    """
    environment = {k: v for k, v in os.environ.items() if k != 'PYTHONDONTWRITEBYTECODE'}
    times = []
    for _ in range(n_times + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, '-c', statement], check=True, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return median(times[1:])  # the first finds files that nobody has read yet


def imports(n_times: int) -> Iterator[Verdict]:
    """Yield the verdicts on the import of the package."""
    show(IMPORTS)
    ours, libraries = import_time(IMPORTS, n_times), import_time(LIBRARIES, n_times)
    measured = f'{ours:.2f} s against {libraries:.2f} s: {ours / libraries:.2f}'
    what = f'`{IMPORTS}` against `{LIBRARIES}`'
    yield Verdict(what, f'{IMPORT_AT_MOST} x', measured, ours <= IMPORT_AT_MOST * libraries)
    done = subprocess.run(
        [sys.executable, '-c', COUNT_COMPILATIONS], check=True, capture_output=True, text=True
    )
    yield Verdict(
        f'compilations at `{IMPORTS}`', 'none', done.stdout.strip(), done.stdout == '0\n'
    )
