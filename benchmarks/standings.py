"""Compute success, time, length and convergence from runs."""

from __future__ import annotations

from itertools import chain
from typing import NamedTuple

from benchmarks.judge import Record
from benchmarks.race import Entry, Standing
import numpy as np
from numpy.typing import NDArray

#: Within this ratio of the best known length a path counts as short.
SHORT = 1.01

Floats = NDArray[np.float64]


class Summary(NamedTuple):
    """
    Summary of a competitor on one problem.

    Times in seconds, lengths as ratios over the best known; a run without a valid path counts as
    endless in the times, and is left out of the lengths. ``soon`` is the time to a path within
    1 % of the best known.
    """

    runs: int
    success: float
    invalid: int
    seconds: float
    seconds_p95: float
    ratio: float
    ratio_p95: float
    clearance: float
    soon: float
    soon_p95: float


def summary(entry: Entry, standing: Standing) -> Summary:
    """Return the summary of the runs of a competitor."""
    records = entry.records
    valid = np.array([np.isfinite(record.length) for record in records])
    seconds = np.where(valid, [record.seconds for record in records], np.inf)
    ratios = np.array([record.length / standing.best[record.request] for record in records])[valid]
    clearances = [record.clearance for record in records if not np.isnan(record.clearance)]
    soon = np.concatenate(
        [_soon(times, ratios) for times, ratios in improvements(entry, standing)]
    )
    return Summary(
        runs=len(records),
        success=float(valid.mean()),
        invalid=sum(record.found for record in records) - int(valid.sum()),
        seconds=quantile(seconds, 0.5),
        seconds_p95=quantile(seconds, 0.95),
        ratio=quantile(ratios, 0.5),
        ratio_p95=quantile(ratios, 0.95),
        clearance=min(clearances, default=np.nan),
        soon=quantile(soon, 0.5),
        soon_p95=quantile(soon, 0.95),
    )


def quantile(values: Floats, part: float) -> float:
    """Return the least value that a fraction ``part`` of values do not exceed; nan for none."""
    if len(values) == 0:
        return np.nan
    return float(np.quantile(values, part, method='inverted_cdf'))


def improvements(entry: Entry, standing: Standing) -> list[tuple[Floats, Floats]]:
    """
    Return times (k, n) [s] and length ratios (k, n) of each request, as they improve.

    A competitor that can use a given time runs again with more and more of it; k is 1. The others
    run again with another seed and keep the shortest path: the time is that of all runs so far,
    and each of the k runs of the request is the first once.
    """
    found = []
    for request, best in enumerate(standing.best):
        if entry.in_time:
            times, ratios = _of_request(request, best, [*chain(*entry.in_time.values())])
            order = np.argsort(times)[np.newaxis]
            times, ratios = times[order], ratios[order]
        else:
            times, ratios = _of_request(request, best, entry.records)
            around = np.add.outer(np.arange(len(times)), np.arange(len(times))) % len(times)
            times = np.cumsum(times[around], axis=1)
            ratios = np.minimum.accumulate(ratios[around], axis=1)
        if times.size:
            found.append((times, ratios))
    return found


def _of_request(request: int, best: float, records: list[Record]) -> tuple[Floats, Floats]:
    own = [record for record in records if record.request == request]
    times = np.array([record.seconds for record in own])
    return times, np.array([record.length for record in own]) / best


def _soon(times: Floats, ratios: Floats) -> Floats:
    """Return the first times (k,) at which a path is short; inf for never."""
    return np.where(ratios <= SHORT, times, np.inf).min(axis=1)


def course(entry: Entry, standing: Standing) -> tuple[Floats, Floats]:
    """
    Return the medians of times (k,) [s] and length ratios (k,) at each step.

    A step is one more run, or more time for a competitor that can use it. There are as many as
    half of the requests have.
    """
    found = improvements(entry, standing)
    lengths = [times.shape[1] for times, _ in found]
    steps = range(int(np.median(lengths)) if lengths else 0)
    at = [[of for of in found if of[0].shape[1] > k] for k in steps]
    times = [np.concatenate([times[:, k] for times, _ in at[k]]) for k in steps]
    ratios = [np.concatenate([ratios[:, k] for _, ratios in at[k]]) for k in steps]
    medians = [[quantile(values, 0.5) for values in each] for each in (times, ratios)]
    return np.array(medians[0]), np.array(medians[1])
