"""Spaces known by a function only: what the search promises, and what a function may do."""

from pathlib import Path
import pickle
import subprocess
import sys
import threading

from hnr_planner.core import (
    BoxSpace,
    DifferenceSpace,
    OracleError,
    OracleSpace,
    RequestError,
    sample,
    SpaceError,
    UnionSpace,
)
from numba import njit
import numpy as np
import pytest

SQUARE = (-1.0, -1.0), (1.0, 1.0)


def is_in_ring(x):
    return bool(0.3 < np.hypot(x[0], x[1]) < 1.0)


def is_left_or_right(wall):
    """Return the membership of a box with a wall so thick in its middle."""
    return lambda x: bool(abs(x[0] - 0.105) > wall / 2.0)


@pytest.mark.parametrize('function', [is_in_ring, njit(is_in_ring)], ids=['Python', 'compiled'])
def test_chords_are_those_of_the_set(function):
    space = OracleSpace(function, *SQUARE, resolution=0.01)
    rng, n = np.random.default_rng(1), 0
    for x in rng.uniform(-1.0, 1.0, (60, 2)):
        assert space.contains(x) == is_in_ring(x)
        if space.contains(x):
            u = rng.standard_normal(2)
            ends = [
                root
                for radius in (0.3, 1.0)
                for root in np.roots([u @ u, 2.0 * (x @ u), x @ x - radius**2])
                if np.isreal(root)
            ]
            upper = min(s.real for s in ends if s.real > 0.0)
            lower = max(s.real for s in ends if s.real < 0.0)
            assert space.chord(x, u) == pytest.approx((lower, upper), abs=1e-11)
            n += 1
    assert n > 20


def test_a_function_in_python_and_the_same_compiled_give_the_same_walk():
    draws = [
        sample(OracleSpace(function, *SQUARE, resolution=0.05), (0.5, 0.0), 50, seed=3)
        for function in (is_in_ring, njit(is_in_ring))
    ]
    np.testing.assert_array_equal(*draws)


@pytest.mark.interpreted
def test_a_wall_is_seen_when_it_is_thicker_than_the_resolution():
    """One that is thinner may be missed: here it is, between two points that are asked for."""
    for wall, is_seen in ((0.0101, True), (0.005, False)):
        space = OracleSpace(is_left_or_right(wall), *SQUARE, resolution=0.01)
        assert space.is_motion_valid((-0.5, 0.0), (0.5, 0.0)) != is_seen
        assert not space.contains((0.105, 0.0))


def test_the_resolution_stands_in_the_representation():
    space = OracleSpace(is_in_ring, *SQUARE, resolution=0.0125)
    assert repr(space) == 'OracleSpace(dim=2, resolution=0.0125)'
    assert space.resolution == 0.0125


def test_the_function_gets_points_that_it_cannot_change_and_may_keep():
    kept = []

    def keep(x):
        kept.append(x)
        return bool(x[0] < 0.9)

    space = OracleSpace(keep, *SQUARE, resolution=0.5)
    kept.clear()
    points = np.array([[0.1, 0.2], [0.3, 0.4], [0.95, 0.0]])
    assert space.contains(points).tolist() == [True, True, False]
    np.testing.assert_array_equal(kept, points)
    with pytest.raises(ValueError, match='read-only'):
        kept[0][0] = 1.0


def test_nothing_outside_the_bounds_is_asked_for():
    def is_free(x):
        assert (np.abs(x) < 1.0).all()
        return True

    space = OracleSpace(is_free, *SQUARE, resolution=0.3)
    assert space.chord((0.5, 0.0), (1.0, 0.0)) == pytest.approx((-1.5, 0.5), abs=1e-11)
    assert not space.contains((1.0, 0.0)) and not space.contains((7.0, 0.0))


@pytest.mark.interpreted
def test_it_can_be_taken_away():
    hole = OracleSpace(lambda x: bool(np.hypot(*x) < 0.5), *SQUARE, resolution=0.01)
    space = DifferenceSpace(BoxSpace((-2.0, -2.0), (2.0, 2.0)), hole)
    assert space.chord((-1.5, 0.0), (1.0, 0.0)) == pytest.approx((-0.5, 1.0), abs=1e-11)
    assert not space.contains((0.1, 0.1))


def test_what_a_function_raises_is_the_cause_of_an_error():
    calls = []

    def is_free(x):
        calls.append(x)
        if len(calls) > 100:
            raise KeyError('no map here')
        return True

    space = OracleSpace(is_free, *SQUARE, resolution=0.1)
    with pytest.raises(OracleError, match='no map here') as caught:
        sample(space, (0.0, 0.0), 1000, n_chains=4, seed=0)
    assert isinstance(caught.value.__cause__, KeyError)
    # It goes on as if nothing had been, once the function does.
    calls[:] = []
    assert space.contains((0.5, 0.5))


def test_chains_in_threads_ask_one_function():
    threads = set()

    def is_free(x):
        threads.add(threading.get_ident())
        return is_in_ring(x)

    space = OracleSpace(is_free, *SQUARE, resolution=0.1)
    draws = sample(space, (0.5, 0.0), 30, n_chains=4, seed=1)
    radii = np.hypot(*np.moveaxis(draws, -1, 0))
    assert ((radii > 0.3) & (radii < 1.0)).all()
    assert len(threads) > 1


def test_a_start_that_the_function_refuses_is_refused():
    space = OracleSpace(is_in_ring, *SQUARE, resolution=0.1)
    with pytest.raises(
        RequestError, match=r'start \[0.0, 0.1\] is outside the bounds, or the fun'
    ):
        sample(space, (0.0, 0.1), 1)


@pytest.mark.parametrize(
    ('function', 'lower', 'upper', 'resolution', 'reason'),
    [
        ('x < 1', *SQUARE, 0.1, "contains must be a function, got 'x < 1'"),
        (lambda x: x < 1, *SQUARE, 0.1, r'must return True or False, got array\(\[ True'),
        (lambda x: None, *SQUARE, 0.1, 'must return True or False, got None'),
        (is_in_ring, (0.0,), (1.0, 1.0), 0.1, 'of one dimension, got 1 and 2'),
        (is_in_ring, (0.0, 0.0), (1.0, np.inf), 0.1, 'upper must be finite'),
        (is_in_ring, (0.0, 0.0), (1.0, 0.0), 0.1, 'must have an inside'),
        (is_in_ring, *SQUARE, 0.0, 'resolution must be above 2.8.*e-12 and finite, got 0.0'),
        (is_in_ring, *SQUARE, np.inf, 'and finite, got inf'),
        (is_in_ring, *SQUARE, np.nan, 'and finite, got nan'),
        (is_in_ring, *SQUARE, 'fine', "resolution must be a number, got 'fine'"),
    ],
)
def test_what_is_no_oracle_is_refused_with_the_reason(function, lower, upper, resolution, reason):
    with pytest.raises(SpaceError, match=reason):
        OracleSpace(function, lower, upper, resolution=resolution)


def test_a_chord_that_is_no_function_is_refused():
    with pytest.raises(SpaceError, match='chord must be a function, got 3'):
        OracleSpace.from_chord(3, *SQUARE, resolution=0.1)


def test_a_pickled_space_calls_its_function_in_another_process(tmp_path):
    """A compiled space has addresses of functions in its own process: they must not be pickled."""
    space = UnionSpace(
        OracleSpace(is_in_ring, *SQUARE, resolution=0.05), BoxSpace((2.0, 0.0), (3.0, 1.0))
    )
    points = np.random.default_rng(4).uniform(-1.0, 3.0, (200, 2))
    (tmp_path / 'space.pickle').write_bytes(pickle.dumps((space, points)))
    code = (
        'import pickle, sys; space, points = pickle.load(open(sys.argv[1], "rb")); '
        'print(space.contains(points).tolist())'
    )
    done = subprocess.run(
        [sys.executable, '-c', code, tmp_path / 'space.pickle'],
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert done.stdout.strip() == str(space.contains(points).tolist())
