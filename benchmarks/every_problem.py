"""Section: every competitor on every problem."""

from __future__ import annotations

from benchmarks.race import Standing
from benchmarks.sections import Bench, milliseconds, ratio, Section, table
from benchmarks.standings import summary
import numpy as np

HEAD = (
    'competitor | runs | success | invalid | time | p95 | length | p95 | within 1 % | p95 | '
    'clearance'
)


def every_problem(bench: Bench) -> Section:
    """Tabulate every competitor on every problem."""
    parts = []
    for standing in bench.standings:
        parts += [f'### {standing.problem.name}', _words(standing), table(HEAD, _rows(standing))]
    return Section('Every problem', '\n\n'.join(parts))


def _words(standing: Standing) -> str:
    problem = standing.problem
    rows, columns = problem.space.shape
    n_requests = len(problem.requests)
    return (
        f'{rows} x {columns} cells of {problem.space.resolution:g} m, robot radius '
        f'{problem.space.robot_radius:g} m, {n_requests} request{"s" * (n_requests > 1)}, best '
        f'known length {np.median(standing.best):.6g} m (median).'
    )


def _rows(standing: Standing) -> list[list[str]]:
    rows = []
    for entry in standing.entries:
        row = summary(entry, standing)
        rows.append(
            [
                entry.competitor.label,
                str(row.runs),
                f'{100 * row.success:.1f} %',
                str(row.invalid),
                milliseconds(row.seconds),
                milliseconds(row.seconds_p95),
                ratio(row.ratio),
                ratio(row.ratio_p95),
                milliseconds(row.soon),
                milliseconds(row.soon_p95),
                ratio(row.clearance),
            ]
        )
    return rows
