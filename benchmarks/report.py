"""The report in Markdown."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import date
import os
from pathlib import Path
import platform

from benchmarks import ompl
from benchmarks.properties import Property
from benchmarks.race import Standing
from benchmarks.standings import Duel, duel, lengths, summary
import cv2
import numba
import numpy as np

EXPLAINED = """\
Times are medians and 95th percentiles in milliseconds: for ours the whole call of `plan()` from
Python on a ready space, for OMPL `setup()` and `solve()` inside the C++ program, for grid search
the compiled function. A run without a valid path within 1 s (RRT*: .5 s) counts as endless; a dash
stands where that is the quantile. Lengths are ratios over the shortest path known for the
request, from all runs and from long searches besides. Clearance is the smallest to the occupied
cells [m], where a robot has been inflated too. Every path of everybody is judged by the same exact
check of its segments, some by a second, independent one; `invalid` counts those that failed it.
OMPL gets a lookup in the same grid for states and an exact cell traversal for motions, in C++, and
its own defaults. All share one core and take turns.
"""


def report(
    standings: list[Standing], measured: list[Property], seconds: float, missing: str
) -> str:
    """Write it all down."""
    parts = ['# Benchmark', _machine(seconds), EXPLAINED]
    if missing:
        parts.append(f'OMPL did not take part. {missing}')
    else:
        parts += ['## First path: ours against OMPL', duel_table(standings)]
    parts += ['## Length in the time of a wavefront', length_table(standings)]
    parts += ['## Ours alone', property_table(measured), '## Every problem']
    for standing in standings:
        parts += [f'### {standing.problem.name}', _problem_words(standing), _entries(standing)]
    return '\n\n'.join(part.strip() for part in parts) + '\n'


def _machine(seconds: float) -> str:
    versions = [
        f'Python {platform.python_version()}',
        f'NumPy {np.__version__}',
        f'numba {numba.__version__}',
        f'OpenCV {cv2.__version__}',
    ]
    try:
        versions.append(f'OMPL {ompl.version()}')
    except (ompl.MissingOmpl, OSError):
        pass
    return (
        f'`make bench`, {date.today()}: {_processor()}, {os.cpu_count()} cores, '
        f'{platform.system()}; {", ".join(versions)}; {seconds / 60:.1f} minutes.'
    )


def _processor() -> str:
    info = Path('/proc/cpuinfo')
    for line in info.read_text().splitlines() if info.exists() else ():
        if line.startswith('model name'):
            return line.partition(':')[2].strip()
    return platform.machine()


def duel_table(standings: list[Standing]) -> str:
    """Compare the time to the first path with OMPL's, problem by problem."""
    return _table(
        'problem | auto | p95 | success | RRTConnect | p95 | auto / it | fastest of OMPL | '
        'its time | auto / it | falls short',
        (_duel_row(duel(standing)) for standing in standings),
    )


def _duel_row(row: Duel) -> list[str]:
    return [
        row.problem,
        _ms(row.auto.seconds),
        _ms(row.auto.seconds_p95),
        f'{100 * row.auto.success:.1f} %',
        _ms(row.rival.seconds),
        _ms(row.rival.seconds_p95),
        _ratio(row.auto.seconds / row.rival.seconds),
        row.fastest,
        _ms(row.fastest_seconds),
        _ratio(row.auto.seconds / row.fastest_seconds),
        ', '.join(row.failures) or 'no',
    ]


def length_table(standings: list[Standing]) -> str:
    """Compare the optimized lengths with what is asked, problem by problem."""
    rows = []
    for row in map(lengths, standings):
        ours, waves = row.optimized, row.wavefront
        mine = [_ms(ours.seconds), _ratio(ours.ratio), _ratio(ours.ratio_p95)]
        theirs = [_ms(waves.seconds), _ratio(waves.ratio)]
        rows.append([row.problem, *mine, *theirs, ', '.join(row.failures) or 'no'])
    return _table(
        'problem | auto, optimized | length | p95 | wavefront | length | falls short', rows
    )


def property_table(measured: list[Property]) -> str:
    """List what was measured of ours alone."""
    return _table(
        'what | measured | to reach | falls short',
        ([row.what, row.measured, row.target, 'no' if row.met else 'yes'] for row in measured),
    )


def _problem_words(standing: Standing) -> str:
    problem = standing.problem
    rows, columns = problem.space.shape
    n_requests = len(problem.requests)
    return (
        f'{rows} x {columns} cells of {problem.space.resolution:g} m, robot radius '
        f'{problem.space.robot_radius:g} m, {n_requests} request{"s" * (n_requests > 1)}, best '
        f'known length {np.median(standing.best):.6g} m (median).'
    )


def _entries(standing: Standing) -> str:
    rows = []
    for entry in standing.entries:
        row = summary(entry, standing)
        rows.append(
            [
                f'{entry.competitor.name} ({entry.competitor.group})',
                str(row.runs),
                f'{100 * row.success:.1f} %',
                str(row.invalid),
                _ms(row.seconds),
                _ms(row.seconds_p95),
                _ratio(row.ratio),
                _ratio(row.ratio_p95),
                _ratio(row.clearance),
            ]
        )
    return _table(
        'competitor | runs | success | invalid | time | p95 | length | p95 | clearance', rows
    )


def _table(head: str, rows: Iterable[list[str]]) -> str:
    names = head.split(' | ')
    lines = [names, ['---'] + ['---:'] * (len(names) - 1), *rows]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


def _ms(seconds: float) -> str:
    return f'{1e3 * seconds:.3g}' if np.isfinite(seconds) else '-'


def _ratio(value: float) -> str:
    return f'{value:.3f}' if np.isfinite(value) else '-'
