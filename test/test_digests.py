"""Digests tell results apart by their last bit, and never by the clock."""

from dataclasses import replace
from test.digests import differing, digest, results

from hnr_planner.core import GridSpace, plan
import numpy as np
import pytest


@pytest.mark.interpreted
def test_a_digest_changes_with_the_last_bit_and_not_with_the_clock() -> None:
    space = GridSpace.from_blocked(np.zeros((3, 4), dtype=bool))
    result = plan(space, (0.5, 0.5), (3.5, 2.5), seed=1, max_iterations=20, time_limit=np.inf)
    assert result.first_solution is not None
    later = result.first_solution._replace(elapsed=9.0)
    assert digest(replace(result, elapsed=8.0, first_solution=later)) == digest(result)
    other = replace(result, path=np.nextafter(result.path, 9.0))
    assert digest(other) != digest(result)
    assert digest((1.0, 2.0)) != digest((2.0, 1.0)) != digest(np.array((2.0, 1.0)))


def test_results_that_differ_for_one_seed_are_named() -> None:
    one = {'a': ['1', '2'], 'b': ['3', '4'], 'c': ['5']}
    assert differing(one, {'a': ['1', '2', '9'], 'b': ['3', '5'], 'd': ['6']}) == ['b']


def test_every_planner_and_walk_has_results() -> None:
    names = ' '.join(results())
    for word in ('plan rrt_connect: office', 'plan poses: car', 'trajectory', 'sample ball_walk'):
        assert word in names
