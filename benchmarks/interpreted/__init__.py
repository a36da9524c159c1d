"""
Section: while nothing is compiled; how late interpreted work ends, and how long others wait.

What runs interpreted does so in processes of its own, in which nothing is ever compiled: this one
has machine code for everything.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
import subprocess
import sys

from benchmarks.interpreted.work import Lateness, MAPS
from benchmarks.progress import show
from benchmarks.sections import Bench, milliseconds, Section, table, Verdict
from hnr_planner.core.kernels.modes import VARIABLE
import numpy as np
from numpy.typing import ArrayLike

ROOT = Path(__file__).resolve().parents[2]
#: Runs of each kind of work on each map, and calls of each service.
RUNS, RUNS_QUICK = 60, 10
CALLS, CALLS_QUICK = 400, 100
#: What is asked of all of them at the 99th percentile [s].
LATE = 0.05

EXPLAINED = """\
Nothing is compiled here: every kernel runs as Python. Each kind of work is given up to 0.3 s, or
is cancelled after as long; the table has the time from then to its return, in milliseconds, for
those runs that were not done by themselves. Other services are called while searches run in the
same node, from another process."""


def interpreted(bench: Bench) -> Section:
    """Measure time limits, cancellations, and other services of a node."""
    rows, verdicts = [], []
    late = _lateness(RUNS_QUICK if bench.quick else RUNS)
    for what, name in (('limit', 'time limit overrun'), ('cancel', 'from cancellation to return')):
        rows += [
            _row(f'{name}: {entry.group}, {entry.place}', getattr(entry, what)) for entry in late
        ]
        seconds = np.concatenate([getattr(entry, what) for entry in late])
        verdicts.append(_verdict(f'interpreted: {name}, p99', seconds))
    missing = ''
    try:
        from benchmarks.interpreted.node import latencies
    except ImportError as reason:
        missing = f'\n\n**Missing.** No node without ROS: {reason}'
    else:
        show('services of a node that runs interpreted')
        waits = latencies(CALLS_QUICK if bench.quick else CALLS)
        rows += [_row(f'call of another service, {what}', wait) for what, wait in waits.items()]
        verdicts += [
            _verdict(f'interpreted: call of another service, {what}, p99', wait)
            for what, wait in waits.items()
            if what.endswith('1 search')
        ]
    words = table('what | runs | p50 | p99 | longest', rows)
    return Section('While nothing is compiled', f'{EXPLAINED}\n\n{words}{missing}', verdicts)


def _lateness(n_runs: int) -> list[Lateness]:
    """Run the work on each map in a process of its own."""
    found = []
    for name in MAPS:
        show(f'interpreted work on {name}')
        done = subprocess.run(
            [sys.executable, '-m', 'benchmarks.interpreted', name, str(n_runs)],
            env={**os.environ, VARIABLE: 'interpreted'},
            cwd=ROOT,
            stdout=subprocess.PIPE,
            check=True,
        )
        found += [Lateness(*entry) for entry in json.loads(done.stdout)]
    return found


def _row(name: str, seconds: list[float]) -> list[str]:
    """Return a row of the table."""
    if not len(seconds):
        return [name, '0', '-', '-', '-']
    levels = *np.quantile(seconds, (0.5, 0.99)), max(seconds)
    return [name, f'{len(seconds)}', *map(milliseconds, levels)]


def _verdict(what: str, seconds: ArrayLike) -> Verdict:
    late = float(np.quantile(np.asarray(seconds), 0.99))
    return Verdict(what, f'{1e3 * LATE:.0f} ms', f'{milliseconds(late)} ms', late <= LATE)
