"""
Section: uniform sampling against hopsy; steps and effective draws a second, import time.

Both get the same facets, start and number of steps in one call, and take turns; times are of the
processor, not of the clock, and a rate is the median of its turns. hopsy samples convex polytopes
alone: where ours walks on another set, hopsy walks on the cube of the same dimension.

The cross-polytope of 100 dimensions is left out: it has 2^100 facets, and neither can hold them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
import time
from typing import Any, NamedTuple
import warnings

from benchmarks.imports import imports
from benchmarks.pinned import on_one_core
from benchmarks.problems import Floats
from benchmarks.progress import show
from benchmarks.sections import Bench, Section, table, Verdict
from hnr_planner.core import (
    BallSpace,
    begin_chains,
    BoxSpace,
    diagnose,
    DifferenceSpace,
    GridSpace,
    PolytopeSpace,
    Space,
    walk_on,
)
import numpy as np

#: About the time of a turn [s], and numbers of turns.
TURN = 0.05
TURNS, TURNS_QUICK = 7, 3
#: Number of steps by which the length of a turn is found.
FIRST_TRY = 1000
#: Our walks, and what hopsy calls them.
HIT_AND_RUN, COORDINATE = 'hit_and_run', 'coordinate_hit_and_run'
PROPOSALS = {
    HIT_AND_RUN: 'UniformHitAndRunProposal',
    COORDINATE: 'UniformCoordinateHitAndRunProposal',
}
#: Targets: our steps a second over those of hopsy, by walk and dimension.
AT_LEAST = {
    HIT_AND_RUN: {2: 4.0, 10: 2.0, 100: 1.8},
    COORDINATE: {2: 2.0, 10: 2.0, 100: 2.0},
}
GRID_AT_LEAST, BALLS_AT_LEAST = 0.45, 0.8
#: Effective draws: dimension, chains, draws of each, and steps between two draws, by walk. Of
#: hopsy's uniform walks these are the fast ones; its ball and Dikin walks come to less.
ESS_DIM, ESS_CHAINS, ESS_DRAWS = 50, 2, 2000
ESS_THIN = {HIT_AND_RUN: (100, 400), COORDINATE: (50, 100, 200)}
BILLIARD, BILLIARD_THIN = 'BilliardWalkProposal', (1, 4)
#: Function that makes ``n_draws`` draws, ``thin`` steps apart: (chains, n_draws, dim).
Runner = Callable[[int, int], Floats]


class Polytope(NamedTuple):
    """A polytope ``a x < b``, and a point in it."""

    name: str
    a: Floats
    b: Floats
    start: Floats


def cube(dim: int) -> Polytope:
    """Return the cube [-1, 1]^dim."""
    a = np.vstack([np.eye(dim), -np.eye(dim)])
    return Polytope('cube', a, np.ones(2 * dim), np.full(dim, 0.1))


def simplex(dim: int) -> Polytope:
    """Return the simplex x > 0, sum x < 1."""
    a = np.vstack([-np.eye(dim), np.ones((1, dim))])
    return Polytope('simplex', a, np.append(np.zeros(dim), 1.0), np.full(dim, 0.5 / dim))


def cross_polytope(dim: int) -> Polytope:
    """Return the cross-polytope, sum |x| < 1, by its 2^dim facets."""
    a = np.stack(np.meshgrid(*[[-1.0, 1.0]] * dim), axis=-1).reshape(-1, dim)
    return Polytope('cross-polytope', a, np.ones(len(a)), np.full(dim, 0.1 / dim))


POLYTOPES = [make(dim) for dim in (2, 10, 100) for make in (cube, simplex)]
POLYTOPES += [cross_polytope(dim) for dim in (2, 10)]


def ours(space: Space, start: Floats, walk: str, n_chains: int = 1) -> Runner:
    """Return a function that continues chains of ours."""
    chains = [begin_chains(space, start, n_chains=n_chains, seed=1)]

    def run(n_draws: int, thin: int) -> Floats:
        draws, chains[0] = walk_on(space, chains[0], n_draws, walk=walk, thin=thin)
        return draws

    return run


def hopsys(hopsy: Any, polytope: Polytope, proposal: str, n_chains: int = 1) -> Runner:
    """Return a function that continues chains of hopsy."""
    problem = hopsy.Problem(polytope.a, polytope.b)
    kind = getattr(hopsy, proposal)
    chains = [
        hopsy.MarkovChain(problem, proposal=kind, starting_point=polytope.start)
        for _ in range(n_chains)
    ]
    streams = [hopsy.RandomNumberGenerator(seed=1, stream=k) for k in range(n_chains)]

    def run(n_draws: int, thin: int) -> Floats:
        _, draws = hopsy.sample(chains, streams, n_samples=n_draws, thinning=thin)
        return np.asarray(draws)

    return run


@dataclass(frozen=True)
class Duel:
    """Processor time of a step, ours and of hopsy [s], with the target for their ratio."""

    what: str
    ours: float
    hopsys: float
    at_least: float

    @property
    def ratio(self) -> float:
        """How many steps ours takes in the time of one of hopsy's."""
        return self.hopsys / self.ours

    @property
    def verdict(self) -> Verdict:
        """Return target and measurement."""
        measured = f'{1e-6 / self.ours:.3g} M against {1e-6 / self.hopsys:.3g} M: {self.ratio:.2f}'
        what = f'steps a second, {self.what}'
        return Verdict(what, f'{self.at_least} x', measured, self.ratio >= self.at_least)


def duel(what: str, at_least: float, both: tuple[Runner, Runner], n_turns: int) -> Duel:
    """Measure the time of a step of both, in turns."""
    show(what)
    steps = [_fitting(run) for run in both]
    times: tuple[list[float], list[float]] = [], []
    for _ in range(n_turns):
        for run, n_steps, seconds in zip(both, steps, times, strict=True):
            seconds.append(_timed(lambda: run(1, n_steps))[0] / n_steps)  # noqa: B023
    return Duel(what, median(times[0]), median(times[1]), at_least)


def _fitting(run: Runner) -> int:
    """Return the number of steps that take about one turn."""
    run(1, 1)
    n_steps = FIRST_TRY
    while (seconds := _timed(lambda: run(1, n_steps))[0]) < 0.2 * TURN:  # noqa: B023
        n_steps *= 4
    return max(1, int(n_steps * TURN / seconds))


def _timed(call: Callable[[], Floats]) -> tuple[float, Floats]:
    """Return the processor time [s] of a call, and what it returns."""
    began = time.process_time()
    result = call()
    return time.process_time() - began, result


def step_duels(hopsy: Any, n_turns: int) -> Iterator[Duel]:
    """Compare steps on the same polytopes, then on sets that hopsy has not."""
    for walk, proposal in PROPOSALS.items():
        for polytope in POLYTOPES:
            dim = len(polytope.start)
            space = PolytopeSpace(polytope.a, polytope.b)
            both = ours(space, polytope.start, walk), hopsys(hopsy, polytope, proposal)
            what = f'{walk}, {polytope.name}, n = {dim}'
            yield duel(what, AT_LEAST[walk][dim], both, n_turns)
    for name, space, start, at_least in (
        ('grid of 1000 x 1000, rooms', *_rooms(), GRID_AT_LEAST),
        ('box without 10 balls', *_box_without_balls(), BALLS_AT_LEAST),
    ):
        on_cube = hopsys(hopsy, cube(space.dim), PROPOSALS[HIT_AND_RUN])
        what = f'{HIT_AND_RUN}, {name}, n = {space.dim}, against the cube'
        yield duel(what, at_least, (ours(space, start, HIT_AND_RUN), on_cube), n_turns)


def _rooms() -> tuple[Space, Floats]:
    """Return rooms of 49 x 49 cells with doors of one cell, and a point in a corner."""
    blocked = np.zeros((1000, 1000), dtype=bool)
    blocked[50::50] = blocked[:, 50::50] = True
    blocked[25::50, 50::50] = blocked[50::50, 25::50] = False
    space = GridSpace.from_blocked(blocked)
    return space, space.cell_centres(5, 5)


def _box_without_balls() -> tuple[Space, Floats]:
    """Return the unit cube less ten balls with centres in it, and a point in a corner."""
    dim, radius = 10, 0.5
    centres = np.random.default_rng(0).uniform(size=(10, dim))
    balls = [BallSpace(centre, radius) for centre in centres]
    return DifferenceSpace(BoxSpace(np.zeros(dim), np.ones(dim)), *balls), np.full(dim, 0.01)


class Rate(NamedTuple):
    """Effective draws a second of processor time, with the walk and its thinning."""

    per_second: float
    walk: str
    thin: int


def effective_draws(hopsy: Any, polytope: Polytope) -> tuple[list[Rate], list[Rate]]:
    """Return the rates of our walks and of hopsy's, the best of each first."""
    space = PolytopeSpace(polytope.a, polytope.b)
    our_rates, their_rates = [], []
    for walk, thins in ESS_THIN.items():
        for thin in thins:
            run = ours(space, polytope.start, walk, ESS_CHAINS)
            our_rates.append(_rate(run, walk, thin))
            run = hopsys(hopsy, polytope, PROPOSALS[walk], ESS_CHAINS)
            their_rates.append(_rate(run, PROPOSALS[walk], thin))
    for thin in BILLIARD_THIN:
        run = hopsys(hopsy, polytope, BILLIARD, ESS_CHAINS)
        their_rates.append(_rate(run, BILLIARD, thin))
    return sorted(our_rates, reverse=True), sorted(their_rates, reverse=True)


def _rate(run: Runner, walk: str, thin: int) -> Rate:
    """Return the rate of effective draws, measured after a tenth as many for a start."""
    show(f'effective draws, {walk}, every {thin} steps')
    run(ESS_DRAWS // 10, thin)
    seconds, draws = _timed(lambda: run(ESS_DRAWS, thin))
    return Rate(float(diagnose(draws).ess_bulk.min()) / seconds, walk, thin)


def sampling(bench: Bench) -> Section:
    """Measure steps, effective draws and the import; without hopsy the import alone."""
    n_turns = TURNS_QUICK if bench.quick else TURNS
    verdicts: list[Verdict] = []
    rows: list[list[str]] = []
    with on_one_core():
        hopsy = import_hopsy(bench)
        if hopsy:
            verdicts += [each.verdict for each in step_duels(hopsy, n_turns)]
            for polytope in (cube(ESS_DIM), simplex(ESS_DIM)):
                both = effective_draws(hopsy, polytope)
                rows += [
                    [polytope.name, whose, rate.walk, str(rate.thin), f'{rate.per_second:.3g}']
                    for whose, rates in zip(('ours', 'hopsy'), both, strict=True)
                    for rate in rates
                ]
                verdicts.append(_ess_verdict(polytope, *both))
        verdicts += imports(n_turns)
    head = (
        f'set, n = {ESS_DIM} | whose | walk | steps from draw to draw | effective draws a second'
    )
    body = [__doc__.partition('\n\n')[2], table(head, rows) if rows else '']
    return Section('Uniform sampling', '\n\n'.join(part.strip() for part in body), verdicts)


def _ess_verdict(polytope: Polytope, ours: list[Rate], hopsys: list[Rate]) -> Verdict:
    ratio = ours[0].per_second / hopsys[0].per_second
    measured = f'{ours[0].per_second:.3g} against {hopsys[0].per_second:.3g}: {ratio:.2f}'
    what = f'effective draws a second, {polytope.name}, n = {ESS_DIM}, best walk of each'
    return Verdict(what, '1 x', measured, ratio >= 1.0)


def import_hopsy(bench: Bench) -> Any:
    """Import hopsy, or return None where it is missing."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            import hopsy
    except ImportError as error:
        bench.missing.append(f'hopsy, for uniform sampling: {error}')
        return None
    return hopsy
