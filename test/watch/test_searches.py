"""Messages about a request come by topics of their own, in any order between these."""

from itertools import permutations

from hnr_planner.watch import searches as module
from hnr_planner.watch.searches import Search, Searches
import numpy as np
import pytest

PATHS = [np.full((2, 2), value, dtype=np.float32) for value in range(3)]


def add(searches: Searches, message: tuple) -> Search | None:
    kind, stamp, value = message
    if kind == 'path':
        return searches.add_path(stamp, PATHS[value])
    status = 'SAMPLED' if value == 0 else 'SOLVED'
    return searches.add_outcome(stamp, 'plan', status, {'alternatives': str(value)})


def test_a_request_is_shown_once_it_is_complete() -> None:
    stamp = (7, 1)
    messages = [('outcome', stamp, 3), *(('path', stamp, k) for k in range(3))]
    for order in permutations(messages):
        searches = Searches()
        *early, last = [add(searches, message) for message in order]
        assert early == [None] * 3
        assert last is not None and last.is_complete
        numbers = [k for kind, _, k in order if kind == 'path']
        assert [path[0, 0] for path in last.paths] == numbers


def test_an_outcome_without_a_plan_waits_for_one_path_and_that_of_draws_for_none() -> None:
    searches = Searches()
    assert searches.add_outcome((1, 0), 'plan', 'NO_MAP', {}) is None
    refused = searches.add_path((1, 0), np.empty((0, 2), dtype=np.float32))
    assert refused is not None and refused.status == 'NO_MAP'
    drawn = add(searches, ('outcome', (2, 0), 0))
    assert drawn is not None and drawn.paths == []


def test_an_older_request_is_not_shown_after_a_newer_one() -> None:
    searches = Searches()
    one, other = (1, 0), (2, 0)
    assert add(searches, ('outcome', one, 1)) is None
    assert add(searches, ('outcome', other, 1)) is None
    assert add(searches, ('path', other, 0)) is not None
    assert add(searches, ('path', one, 0)) is None


def test_what_never_becomes_complete_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, 'MOST_WAITING', 3)
    searches = Searches()
    for second in range(4):
        assert add(searches, ('outcome', (second, 0), 1)) is None
    assert len(searches._waiting) == 3
    assert add(searches, ('path', (0, 0), 0)) is None
    assert add(searches, ('path', (3, 0), 0)) is not None
    assert len(searches._waiting) == 1  # the path without an outcome
