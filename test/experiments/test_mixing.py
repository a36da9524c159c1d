"""Mixing: exact shares of cells, estimates on both sides of the truth, and known times."""

from collections.abc import Callable, Iterator
import dataclasses
import math
from test.sweeps import sweep

from hnr_planner.core import begin_chains, HitAndRunWalk, total_variation, walk_on
from hnr_planner.core.theory import cell_flow
from hnr_planner.experiments import mixing
from hnr_planner.experiments.mixing import curves, dimension, relaxation
from hnr_planner.experiments.mixing.sets import MixingSet, planar_sets
from hnr_planner.experiments.mixing.solids import solid, SOLIDS, WIDE
from hnr_planner.experiments.mixing.variation import (
    CHECKPOINTS,
    columns,
    MIXED,
    run_until_mixed,
    steps_to_mix,
)
from hnr_planner.experiments.results import Results
import numpy as np
from numpy.typing import NDArray
import pytest

Floats = NDArray[np.float64]
N_POINTS = 200_000


def in_bounds(mixing_set: MixingSet, rng: np.random.Generator) -> Floats:
    points = rng.uniform(*mixing_set.space.bounds, size=(N_POINTS, mixing_set.space.dim))
    return points[mixing_set.space.contains(points)]


def in_ball(n: int, rng: np.random.Generator) -> Floats:
    points = rng.normal(size=(N_POINTS, n))
    radii = rng.uniform(size=(N_POINTS, 1)) ** (1 / n)
    return points / np.linalg.norm(points, axis=1, keepdims=True) * radii


def in_joined_boxes(n: int, rng: np.random.Generator) -> Floats:
    points = rng.uniform(size=(N_POINTS, n))
    points[::2, 0] += 1.0
    points[::2, 1] += 0.5
    return points


def in_crossed_beams(n: int, rng: np.random.Generator) -> Floats:
    """Draw uniform points of each beam in turn, and of their common cube only for the first."""
    points = rng.uniform(-WIDE, WIDE, size=(N_POINTS, n))
    axis = np.arange(N_POINTS) % n
    points[np.arange(N_POINTS), axis] = rng.uniform(-1.0, 1.0, N_POINTS)
    return points[(np.abs(points).max(axis=1) > WIDE) | (axis == 0)]


DRAWN: dict[str, Callable[[int, np.random.Generator], Floats]] = {
    'cube': lambda n, rng: rng.uniform(size=(N_POINTS, n)),
    'cube, from a half': lambda n, rng: rng.uniform(size=(N_POINTS, n)),
    'ball': in_ball,
    'simplex': lambda n, rng: rng.dirichlet(np.ones(n + 1), N_POINTS)[:, :n],
    'joined boxes': in_joined_boxes,
    'crossed beams': in_crossed_beams,
}


def surprise(mixing_set: MixingSet, points: Floats, shares: Floats) -> float:
    """Return the excess of uniform points' distance from the shares, in standard deviations."""
    distance = total_variation(mixing_set.cells(points), shares)
    return (distance.plug_in - distance.floor) * math.sqrt(len(points)) / 0.30


def sets_with_points(dim: int | None) -> Iterator[tuple[str, MixingSet, Floats]]:
    rng = np.random.default_rng(0)
    if dim is None:
        for name, mixing_set in planar_sets().items():
            yield name, mixing_set, in_bounds(mixing_set, rng)
    else:
        for name in SOLIDS:
            yield name, solid(name, dim), DRAWN[name](dim, rng)


@pytest.mark.parametrize('dim', [None, sweep(2), 5, sweep(30)])
def test_shares_are_those_of_uniform_points(dim: int | None):
    """
    27 sets, each with 50 000 points or more, at 6 standard deviations: 3e-8 false alarms.

    The mutants have 1.5 % of the volume in the wrong cell.
    """
    for name, mixing_set, points in sets_with_points(dim):
        shares = mixing_set.shares
        assert shares.sum() == pytest.approx(1.0)
        assert mixing_set.space.contains(points).all()
        assert surprise(mixing_set, points, shares) < 6.0, name
        wrong = shares.copy()
        order = np.argsort(shares)
        wrong[order[[-1, 0]]] += -0.015, 0.015
        assert surprise(mixing_set, points, wrong) > 8.0, name


def test_shares_of_sums_are_exact():
    """Two coordinates: the share below t <= 1 is t^2 / 2; and 30 are as symmetric as 2."""
    edge = 1.0 + math.sqrt(2.0 / 12.0) * -1.2815515655446004
    assert solid('cube', 2).shares[0] == pytest.approx(edge**2 / 2.0, abs=1e-15)
    for dim in (2, 3, 30):
        shares = solid('cube', dim).shares
        assert shares == pytest.approx(shares[::-1], abs=1e-12)


@pytest.mark.parametrize('name', [*planar_sets(), *SOLIDS])
def test_walks_begin_far_inside_a_set_and_far_from_mixed(name):
    mixing_set = solid(name, 5) if name in SOLIDS else planar_sets()[name]
    starts = np.atleast_2d(mixing_set.starts(400, np.random.default_rng(0)))
    assert mixing_set.space.contains(starts).all()
    points = np.resize(starts, (400, starts.shape[1]))
    distance = total_variation(mixing_set.cells(points), mixing_set.shares)
    assert distance.lower_bound > (0.4 if name == 'cube, from a half' else 0.75)


def test_a_warm_start_is_uniform_on_its_half():
    """Its density is at most 2: 200 000 points, at 6 standard deviations."""
    mixing_set = solid('cube, from a half', 3)
    points = mixing_set.starts(N_POINTS, np.random.default_rng(1))
    assert points.sum(axis=1).max() <= 1.5
    half = np.where(np.arange(10) < 5, 2.0 * mixing_set.shares, 0.0)
    assert surprise(mixing_set, points, half) < 6.0


# -- total variation along a run


def test_steps_until_a_curve_falls_below_the_mark():
    for time in (10.0, 300.0, 9000.0):
        curve = 0.9 * np.exp(-np.array(CHECKPOINTS) / time)
        assert steps_to_mix(curve) == pytest.approx(time * math.log(0.9 / MIXED), rel=0.01)
    assert math.isnan(steps_to_mix([0.9, 0.5, 0.2]))
    assert steps_to_mix([0.05]) == 1.0
    assert CHECKPOINTS[:12] == (*range(1, 9), 10, 12, 14, 16)


def test_the_law_lies_between_both_estimates_and_follows_the_flow():
    """
    Chains that start in one square are compared with powers of the flow between squares.

    1800 chains have a standard deviation of .007; the tolerance is 6 of them.
    """
    rooms = planar_sets()['door 0.2']
    flow = cell_flow(rooms.space, (6, 12), 1 << 17)
    coarse = rooms.cells(flow.centre)

    def starts(n_chains: int, rng: np.random.Generator) -> Floats:
        return rng.uniform(0.0, 1.0 / 6.0, size=(n_chains, 2))

    distances, chains = run_until_mixed(
        dataclasses.replace(rooms, starts=starts), HitAndRunWalk(), 1
    )
    assert len(chains.points) == 1800
    exact = []
    for steps, distance in zip(CHECKPOINTS, distances, strict=False):
        law = np.linalg.matrix_power(flow.kernel, steps)[0]
        exact.append(0.5 * np.abs(np.bincount(coarse, law) - rooms.shares).sum())
        assert distance.lower_bound - 0.042 < exact[-1] < distance.plug_in + 0.042
    assert exact[0] > 0.5 > 0.1 > exact[-1]


def test_chains_walk_on_until_they_are_mixed_and_no_longer():
    distances, chains = run_until_mixed(planar_sets()['L'], HitAndRunWalk(), 3)
    assert distances[-1].plug_in < MIXED
    assert chains.steps.tolist() == [CHECKPOINTS[len(distances) - 1]] * len(chains.points)
    row = columns(distances)
    assert row['first'] <= row['last'] <= CHECKPOINTS[len(distances) - 1]
    assert row[f'above_{CHECKPOINTS[0]}'] == distances[0].plug_in
    assert row[f'below_{CHECKPOINTS[len(distances) - 1]}'] == distances[-1].lower_bound
    assert math.isnan(row[f'above_{CHECKPOINTS[-1]}'])


# -- the relaxation time


@pytest.mark.parametrize(('door', 'half', 'known'), [sweep(0.05, 36.3, 38.2), (0.2, 9.15, 10.4)])
def test_rooms_relax_as_is_known(door, half, known):
    """1800 chains of 1000 draws: 1 % and 2 % of the time is one standard deviation."""
    name = f'door {door}'
    conductance, time = relaxation.computed(name)
    assert 0.5 / conductance == pytest.approx(half, rel=0.005)
    assert 0.5 / conductance < time < 2.0 / conductance**2
    assert time == pytest.approx(known, rel=0.02)
    measured = mixing.run(mixing.Case(name, 2, 'hit_and_run', 0.0), 0)['relaxation']
    assert measured == pytest.approx(known, rel=0.1)


# -- the dimension


def test_exponents_are_those_of_the_powers_that_steps_grow_with():
    dims = np.repeat(dimension.DIMENSIONS, 3).astype(float)
    steps = np.tile([1.0, 1.1, 1.3], len(dimension.DIMENSIONS)) * dims**2.5
    results = Results({'dim': dims, 'first': 0.9 * steps, 'last': 1.1 * steps})
    for dimensions in (dimension.LOW, dimension.HIGH):
        fitted = dimension.exponents(results, dimensions)
        assert fitted.value == pytest.approx(2.5)
        assert fitted.half == pytest.approx(0.0, abs=1e-12)


def test_the_bound_is_that_of_the_lemmas():
    """At n = 2 the conductance is 7.9e-10, as docs/theory.md states."""
    steps = math.log(math.sqrt(2.0) / 0.1) * 2.0 / 7.9e-10**2
    assert dimension.bound(2) == pytest.approx(steps, rel=0.02)
    assert dimension.bound(30) > 1e6 * dimension.bound(2)


# -- the walks


def test_best_is_the_radius_with_which_all_runs_mix_first():
    radii = np.array([1.0, 1.0, 2.0, 2.0, 4.0, 4.0])
    last = np.array([10.0, math.nan, 40.0, 50.0, 30.0, 70.0])
    chosen = curves.best(Results({'radius': radii, 'first': last, 'last': last}))
    assert chosen.distinct('radius') == [2.0]


def test_only_the_end_point_walks_through_walls():
    """From the left room, with a door of .05: 1800 chains of 8 steps of radius 1.2 at most."""
    rooms = planar_sets()['door 0.05']
    crossed = {}
    for name in curves.BALL_WALKS:
        chains = begin_chains(rooms.space, (0.5, 0.01), n_chains=1800, seed=0)
        draws, _ = walk_on(rooms.space, chains, 1, walk=curves.make_walk(name, 1.2), thin=8)
        crossed[name] = np.mean(draws[:, 0, 0] > 1.0)
    assert crossed['ball_walk'] < 0.15 < 0.3 < crossed['end_point']
