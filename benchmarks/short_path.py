"""Section: length over the best known in a wavefront's time, and the time to within 1 %."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.race import Standing
from benchmarks.sections import Bench, milliseconds, on_all, ratio, Section, shortfalls, table
from benchmarks.standings import Summary, summary

#: Least time to optimize in [s], where a wavefront is faster than that.
LEAST_TIME = 1e-3
#: Targets: length over the best known, median and 95th percentile.
MEDIAN, P95 = 1.01, 1.05


class Lengths(NamedTuple):
    """Summaries on one problem: ours, optimized in a wavefront's time, and the wavefront."""

    problem: str
    ours: Summary
    waves: Summary

    @property
    def later(self) -> bool:
        """Return whether ours took longer."""
        return self.ours.seconds > max(self.waves.seconds, LEAST_TIME)


def short_path(bench: Bench) -> Section:
    """Compare the optimized lengths, and the times, with a wavefront's."""
    rows = [_lengths(standing) for standing in bench.standings]
    verdicts = [
        on_all(
            'length over the best known, median',
            f'{MEDIAN:g}',
            {row.problem: ratio(row.ours.ratio) for row in rows if not row.ours.ratio <= MEDIAN},
            len(rows),
        ),
        on_all(
            'length over the best known, p95',
            f'{P95:g}',
            {
                row.problem: ratio(row.ours.ratio_p95)
                for row in rows
                if not row.ours.ratio_p95 <= P95
            },
            len(rows),
        ),
        on_all(
            'time for that, median',
            "a wavefront's, or 1 ms",
            {
                row.problem: f'{row.ours.seconds / max(row.waves.seconds, LEAST_TIME):.2f} x'
                for row in rows
                if row.later
            },
            len(rows),
        ),
    ]
    head = (
        'problem | auto, optimized | p95 | length | p95 | within 1 % after | wavefront | length | '
        'falls short'
    )
    return Section('Length in the time of a wavefront', table(head, map(_row, rows)), verdicts)


def _lengths(standing: Standing) -> Lengths:
    of = {entry.competitor.label: summary(entry, standing) for entry in standing.entries}
    return Lengths(standing.problem.name, of['auto, optimized (ours)'], of['wavefront (grid)'])


def _row(row: Lengths) -> list[str]:
    short = {
        f'median above {MEDIAN:g}': not row.ours.ratio <= MEDIAN,
        f'p95 above {P95:g}': not row.ours.ratio_p95 <= P95,
        'longer than the wavefront': row.later,
    }
    return [
        row.problem,
        milliseconds(row.ours.seconds),
        milliseconds(row.ours.seconds_p95),
        ratio(row.ours.ratio),
        ratio(row.ours.ratio_p95),
        milliseconds(row.ours.soon),
        milliseconds(row.waves.seconds),
        ratio(row.waves.ratio),
        shortfalls(short),
    ]
