"""A subclass of Space written in Python: kernels call its methods."""

import pickle

from hnr_planner.core import (
    BoxSpace,
    Chord,
    DifferenceSpace,
    OracleError,
    plan,
    PlannerStatus,
    sample,
    Space,
    SpaceError,
)
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.spaces.primitives import chord_or_empty
import numpy as np
import pytest


class Ring(Space):
    """The points whose distance from the origin is between 1 and 2."""

    dim = 2

    @property
    def bounds(self):
        return np.full(2, -2.0), np.full(2, 2.0)

    def contains(self, points):
        distance = np.linalg.norm(np.asarray(points), axis=-1)
        return (distance > 1.0) & (distance < 2.0)

    def chord(self, point, direction):
        if not self.contains(point):
            return Chord(0.0, 0.0)
        x, u = np.asarray(point), np.asarray(direction)
        a, b = u @ u, x @ u
        ends = [(-1, 2.0), (1, 2.0)]
        if b * b > a * (x @ x - 1.0):
            ends += [(-1, 1.0), (1, 1.0)]
        roots = [(-b + side * np.sqrt(b * b - a * (x @ x - r * r))) / a for side, r in ends]
        return Chord(max(s for s in roots if s < 0.0), min(s for s in roots if s > 0.0))


class SlowRing(Ring):
    """The ring, in which no motion may be longer than half."""

    def is_motion_valid(self, start, end):
        way = np.asarray(end) - start
        return bool(
            self.contains(start)
            and (not way.any() or self.chord(start, way).upper > 1.0)
            and np.linalg.norm(way) <= 0.5
        )


@pytest.mark.interpreted
@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run', 'ball_walk'])
def test_walks_stay_in_it_and_go_round(walk):
    space = Ring()
    draws = sample(space, (1.5, 0.1), 400, walk=walk, n_chains=2, thin=5, seed=1)
    assert space.contains(draws).all()
    assert len(np.unique(np.sign(draws).reshape(-1, 2), axis=0)) == 4


def test_chords_of_kernels_are_its_own():
    space, rng = Ring(), np.random.default_rng(2)
    for x in rng.uniform(-2.0, 2.0, (50, 2)):
        u = rng.standard_normal(2)
        expected = space.chord(x, u)
        assert chord_or_empty(space.data, x, u) == pytest.approx(expected, abs=1e-12)
        assert interpreted(chord_or_empty)(space.data, x, u) == chord_or_empty(space.data, x, u)


@pytest.mark.interpreted
def test_paths_are_planned_in_it():
    found = plan(Ring(), (-1.5, 0.0), (1.5, 0.0), seed=1, time_limit=np.inf, max_iterations=10**5)
    assert found.status is PlannerStatus.SOLVED
    ts = np.linspace(0.0, 1.0, 200)[:, np.newaxis]
    for a, b in zip(found.path[:-1], found.path[1:], strict=True):
        assert Ring().contains(a + ts * (b - a)).all()


def test_paths_are_judged_by_its_own_verdict_on_motions():
    long, short = np.array([(-1.5, 0.5), (-1.5, -0.5)]), np.array([(-1.5, 0.2), (-1.5, -0.2)])
    assert Ring().is_path_free(long)
    assert SlowRing().is_path_free(short) and not SlowRing().is_path_free(long)
    assert SlowRing().first_blocked_segment([*short, *long]) == 1


@pytest.mark.interpreted
def test_it_can_be_taken_away_and_pickled():
    rest = DifferenceSpace(BoxSpace((-2.5, -2.5), (2.5, 2.5)), pickle.loads(pickle.dumps(Ring())))
    assert rest.contains([(0.0, 0.0), (1.5, 0.0), (2.2, 2.2)]).tolist() == [True, False, True]
    assert rest.chord((0.0, 0.0), (1.0, 0.0)) == pytest.approx((-1.0, 1.0), abs=1e-9)


def test_what_a_method_raises_is_the_cause_of_an_error():
    class Broken(Ring):
        def chord(self, point, direction):
            raise KeyError('no chord here')

    with pytest.raises(OracleError, match='no chord here'):
        sample(Broken(), (1.5, 0.0), 3, seed=0)


def test_a_space_that_defines_too_little_is_refused_with_what_it_lacks():
    class Membership(Space):
        dim = 2
        bounds = Ring.bounds
        contains = Ring.contains

    with pytest.raises(SpaceError, match='must define contains and chord, which Membership does'):
        sample(Membership(), (1.5, 0.0), 3, seed=0)
