"""Section: the time to the first path against OMPL's, problem by problem."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.competitors.ompl_planners import NATIVE, WHEEL
from benchmarks.race import Standing
from benchmarks.sections import (
    Bench,
    milliseconds,
    on_all,
    ratio,
    Section,
    shortfalls,
    table,
    Verdict,
)
from benchmarks.standings import Summary, summary

#: Time that a call from Python may take in addition [s].
CALL = 30e-6
#: Where RRTConnect takes less than this [s], the two are not compared.
NO_MATCH = 0.1e-3
#: Target: ours over RRTConnect.
HALF = 0.5
#: The targets and their bounds, as text.
ASKED = (
    (
        'first path, `auto`, median against RRTConnect',
        'half of it + 30 us, where it takes over .1 ms',
    ),
    ("first path, `auto`, median against the fastest of OMPL's planners there", '1 x + 30 us'),
    ("first path, `auto`, p95 against RRTConnect's", '1 x, where that is over .1 ms'),
)


class Duel(NamedTuple):
    """Times of ours and of OMPL's; ``fastest`` is the best of its planners on that problem."""

    problem: str
    auto: Summary
    rival: Summary
    fastest: str
    fastest_seconds: float

    @property
    def slower(self) -> bool:
        """Return whether ours takes longer than the fastest and a call."""
        return self.auto.seconds > self.fastest_seconds + CALL

    @property
    def above_half(self) -> bool:
        """Return whether ours takes more than half of RRTConnect's time and a call."""
        limit = HALF * self.rival.seconds + CALL
        return self.rival.seconds > NO_MATCH and self.auto.seconds > limit

    @property
    def p95_above(self) -> bool:
        """Return whether the 95th percentile of ours is above that of RRTConnect."""
        p95 = self.rival.seconds_p95
        return p95 > NO_MATCH and self.auto.seconds_p95 > p95


def first_path(bench: Bench) -> Section:
    """Compare the time to the first path."""
    title = 'Time to the first path'
    duels = [_duel(standing) for standing in bench.standings if _has_ompl(standing)]
    if not duels:
        words = 'not measured: OMPL in C++ is missing'
        asked = [Verdict(what, to_reach, words, False) for what, to_reach in ASKED]
        return Section(title, 'OMPL in C++ is missing: nothing to compare with.', asked)
    falls_short = (
        {d.problem: f'{d.auto.seconds / d.rival.seconds:.2f} x' for d in duels if d.above_half},
        {d.problem: f'{d.auto.seconds / d.fastest_seconds:.2f} x' for d in duels if d.slower},
        {
            d.problem: f'{d.auto.seconds_p95 / d.rival.seconds_p95:.2f} x'
            for d in duels
            if d.p95_above
        },
    )
    verdicts = [
        on_all(*asked, short, len(duels)) for asked, short in zip(ASKED, falls_short, strict=True)
    ]
    head = (
        'problem | auto | p95 | RRTConnect | p95 | auto / it | fastest of OMPL | its time | '
        'auto / it | falls short'
    )
    return Section(title, table(head, map(_row, duels)), verdicts)


def _has_ompl(standing: Standing) -> bool:
    return any(entry.competitor.group == NATIVE for entry in standing.entries)


def _duel(standing: Standing) -> Duel:
    of = {entry.competitor.label: summary(entry, standing) for entry in standing.entries}
    times = {
        label: of[label].seconds
        for label in (
            entry.competitor.label
            for entry in standing.entries
            if entry.competitor.group in (NATIVE, WHEEL) and entry.competitor.aim == 'first'
        )
    }
    fastest = min(times, key=times.__getitem__)
    auto, rival = of['auto (ours)'], of[f'RRTConnect ({NATIVE})']
    return Duel(standing.problem.name, auto, rival, fastest, times[fastest])


def _row(duel: Duel) -> list[str]:
    short = {
        'slower than the fastest': duel.slower,
        'more than half of RRTConnect': duel.above_half,
        "p95 above RRTConnect's": duel.p95_above,
    }
    return [
        duel.problem,
        milliseconds(duel.auto.seconds),
        milliseconds(duel.auto.seconds_p95),
        milliseconds(duel.rival.seconds),
        milliseconds(duel.rival.seconds_p95),
        ratio(duel.auto.seconds / duel.rival.seconds),
        duel.fastest,
        milliseconds(duel.fastest_seconds),
        ratio(duel.auto.seconds / duel.fastest_seconds),
        shortfalls(short),
    ]
