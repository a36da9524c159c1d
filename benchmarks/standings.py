"""Numbers from runs: how often, how fast, how short, and what is asked of ours."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.race import Entry, Standing
import numpy as np

#: What a call from Python may cost above the best of the others [s].
CALL = 30e-6
#: Below this time of RRTConnect [s] it is no match on speed.
NO_MATCH = 0.1e-3
HALF, MEDIAN_LENGTH, P95_LENGTH = 0.5, 1.01, 1.05


class Summary(NamedTuple):
    """
    A competitor on one problem.

    Times in seconds, lengths as ratios over the best known; a run without a valid path counts as
    endless in the times, and is left out of the lengths.
    """

    runs: int
    success: float
    invalid: int
    seconds: float
    seconds_p95: float
    ratio: float
    ratio_p95: float
    clearance: float


def summary(entry: Entry, standing: Standing) -> Summary:
    """Sum up the runs of a competitor."""
    records = entry.records
    valid = np.array([np.isfinite(record.length) for record in records])
    seconds = np.where(valid, [record.seconds for record in records], np.inf)
    ratios = np.array([record.length / standing.best[record.request] for record in records])[valid]
    clearances = [record.clearance for record in records if not np.isnan(record.clearance)]
    return Summary(
        runs=len(records),
        success=float(valid.mean()),
        invalid=sum(record.found for record in records) - int(valid.sum()),
        seconds=_quantile(seconds, 0.5),
        seconds_p95=_quantile(seconds, 0.95),
        ratio=_quantile(ratios, 0.5),
        ratio_p95=_quantile(ratios, 0.95),
        clearance=min(clearances, default=np.nan),
    )


def _quantile(values: np.ndarray, part: float) -> float:
    """Smallest of the values that ``part`` of them do not exceed; nan for none."""
    if len(values) == 0:
        return np.nan
    return float(np.quantile(values, part, method='inverted_cdf'))


class Duel(NamedTuple):
    """
    Ours against OMPL's on one problem: what is asked, and whether it is so.

    ``rival`` is RRTConnect, ``fastest`` the best of OMPL's planners there, picked after the fact.
    """

    problem: str
    auto: Summary
    rival: Summary
    fastest: str
    fastest_seconds: float
    failures: list[str]


def duel(standing: Standing) -> Duel:
    """Compare the time to the first path."""
    of = {entry.competitor.name: summary(entry, standing) for entry in standing.entries}
    times = {
        entry.competitor.name: of[entry.competitor.name].seconds
        for entry in standing.entries
        if (entry.competitor.group, entry.competitor.aim) == ('OMPL', 'first')
    }
    auto, rival = of['auto'], of['RRTConnect']
    fastest = min(times, key=times.__getitem__)
    failures = []
    if auto.seconds > times[fastest] + CALL:
        failures.append('slower than the fastest')
    if rival.seconds > NO_MATCH and auto.seconds > HALF * rival.seconds + CALL:
        failures.append('more than half of RRTConnect')
    if rival.seconds_p95 > NO_MATCH and auto.seconds_p95 > rival.seconds_p95:
        failures.append("p95 above RRTConnect's")
    if auto.success < 1.0:
        failures.append(f'success {100 * auto.success:.1f} %')
    return Duel(standing.problem.name, auto, rival, fastest, times[fastest], failures)


class Lengths(NamedTuple):
    """Ours, optimized in the time of a wavefront, on one problem."""

    problem: str
    optimized: Summary
    wavefront: Summary
    failures: list[str]


def lengths(standing: Standing) -> Lengths:
    """Compare the lengths with what is asked."""
    of = {entry.competitor.name: summary(entry, standing) for entry in standing.entries}
    ours, waves = of['auto, optimized'], of['wavefront']
    failures = []
    if not ours.ratio <= MEDIAN_LENGTH:
        failures.append(f'median above {MEDIAN_LENGTH:g}')
    if not ours.ratio_p95 <= P95_LENGTH:
        failures.append(f'p95 above {P95_LENGTH:g}')
    if ours.seconds > max(waves.seconds, 1e-3) * 1.1:
        failures.append('longer than the wavefront')
    return Lengths(standing.problem.name, ours, waves, failures)
