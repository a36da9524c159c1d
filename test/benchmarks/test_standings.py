"""Statistics of runs, from records written by hand."""

from benchmarks.competitors import Competitor
from benchmarks.judge import Judge, Record
from benchmarks.problems import Problem
from benchmarks.race import Entry, Standing
from benchmarks.standings import course, summary
from hnr_planner.core import GridSpace
import numpy as np
import pytest

PROBLEM = Problem(
    'empty', GridSpace.from_blocked(np.zeros((9, 9), dtype=bool)), np.zeros((2, 2, 2))
)


def record(request: int, seconds: float, length: float) -> Record:
    return Record(request, seconds, length, 0.5, np.isfinite(length))


def standing(**runs) -> Standing:
    entry = Entry(Competitor('one', 'ours', 'short', None), Judge(PROBLEM), **runs)
    return Standing(PROBLEM, [entry], np.array([10.0, 20.0]))


def test_one_that_begins_again_pays_for_all_its_runs():
    """Request 0 is short in its second run of three, request 1 in no run."""
    races = standing(
        records=[
            *(record(0, 1.0, length) for length in (12.0, 10.05, 11.0)),
            *(record(1, 4.0, length) for length in (30.0, 25.0)),
        ]
    )
    found = summary(races.entries[0], races)
    # From its runs on, request 0 takes 2, 1 and 3 s; request 1 never gets there.
    assert found.soon == 3.0
    assert found.soon_p95 == np.inf
    times, ratios = course(*races.entries, races)
    np.testing.assert_allclose(times, [1.0, 2.0])
    np.testing.assert_allclose(ratios, [1.2, 1.1])


def test_one_that_can_use_a_given_time_pays_for_one_run():
    in_time = {
        seconds: [record(0, seconds, first), record(1, seconds, second)]
        for seconds, first, second in ((1.0, 11.0, np.inf), (4.0, 10.0, 22.0), (9.0, 10.0, 20.1))
    }
    races = standing(records=in_time[9.0], in_time=in_time)
    found = summary(races.entries[0], races)
    assert (found.soon, found.soon_p95) == (4.0, 9.0)
    times, ratios = course(*races.entries, races)
    np.testing.assert_allclose(times, [1.0, 4.0, 9.0])
    np.testing.assert_allclose(ratios, [1.1, 1.0, 1.0])


def test_a_run_without_a_path_is_endless_and_has_no_length():
    races = standing(records=[record(0, 1.0, np.inf), record(0, 2.0, 15.0), record(1, 3.0, 30.0)])
    found = summary(races.entries[0], races)
    assert found.success == pytest.approx(2 / 3)
    assert (found.seconds, found.seconds_p95) == (3.0, np.inf)
    assert (found.ratio, found.ratio_p95) == (1.5, 1.5)
