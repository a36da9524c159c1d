"""
Section: uniform sampling of long and flat polytopes, both libraries with their own rounding.

Both get the same inequalities and equations, and draw in the coordinates of the caller. hopsy's
polytope is rounded by ``hopsy.round``, ours by ``round_space``; the time of this has a column of
its own. Of each the best walk and thinning counts, ours as it is given or rounded. Rates are
effective draws of the least coordinate a second of processor time, medians of turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from statistics import median
import time
from typing import Any, NamedTuple

from benchmarks.pinned import on_one_core
from benchmarks.problems import Floats
from benchmarks.progress import show
from benchmarks.sampling import import_hopsy
from benchmarks.sections import Bench, Section, table, Verdict
from hnr_planner.core import (
    begin_chains,
    CoordinateHitAndRunWalk,
    diagnose,
    PolytopeSpace,
    round_space,
    Space,
    walk_on,
)
import numpy as np
from scipy.linalg import null_space
from scipy.stats import ortho_group

#: Target: our effective draws a second over those of hopsy.
AT_LEAST = 3.0
CHAINS, DRAWS, DRAWS_QUICK = 2, 2000, 500
TURNS, TURNS_QUICK = 5, 1
#: Range of the draws of a coordinate up to which it counts as fixed.
FIXED = 1e-7
#: Steps between two draws, for each dimension, by walk.
FAST = CoordinateHitAndRunWalk(overrelaxed=True)
OUR_THINS = (0.5, 1, 2, 4)
THEIR_THINS = {
    'UniformCoordinateHitAndRunProposal': (1, 2, 4),
    'UniformHitAndRunProposal': (4,),
    'BilliardWalkProposal': (0.2,),
}

#: Function that makes some draws: (chains, n_draws, dim) in the caller's coordinates.
Runner = Callable[[int], Floats]


class FlatPolytope(NamedTuple):
    """A polytope ``a x < b`` with equations ``a_eq x = b_eq``; None where there are none."""

    name: str
    a: Floats
    b: Floats
    a_eq: Floats | None
    b_eq: Floats | None


def simplex(lengths: Floats, turn: Floats | None = None) -> tuple[Floats, Floats, None, None]:
    """Return a simplex with these lengths along axes that may be turned."""
    rows = np.vstack([-np.diag(1.0 / lengths), 1.0 / lengths])
    dim = len(lengths)
    rows = rows if turn is None else rows @ turn
    return rows, np.append(np.zeros(dim), 1.0), None, None


def birkhoff(k: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the doubly stochastic matrices (k, k)."""
    sums = np.vstack([np.kron(np.eye(k), np.ones(k)), np.kron(np.ones(k), np.eye(k))])
    return -np.eye(k * k), np.zeros(k * k), sums, np.ones(2 * k)


def fluxes(
    n_reactions: int, n_metabolites: int, seed: int
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return a network like a metabolic one: bounds of many sizes, a few numbers in each row."""
    rng = np.random.default_rng(seed)
    network = np.zeros((n_metabolites, n_reactions))
    for j in range(n_reactions):
        rows = rng.choice(n_metabolites, rng.integers(2, 5), replace=False)
        network[rows, j] = rng.choice([-2.0, -1.0, 1.0, 2.0], len(rows))
    upper = 10.0 ** rng.uniform(0.0, 3.0, n_reactions)
    kernel = null_space(network)
    steady = kernel @ rng.standard_normal(kernel.shape[1])
    steady /= np.abs(steady).max()
    lower = np.where(rng.random(n_reactions) < 0.5, -upper, np.minimum(0.0, steady - 0.01 * upper))
    both = np.vstack([np.eye(n_reactions), -np.eye(n_reactions)])
    return both, np.append(upper, -lower), network, np.zeros(n_metabolites)


def polytopes() -> Iterator[FlatPolytope]:
    """Yield the polytopes of the comparison."""
    turn = ortho_group.rvs(20, random_state=1)
    decades = 10.0 ** np.linspace(-4, 4, 20)
    yield FlatPolytope('simplex', *simplex(np.ones(20)))
    yield FlatPolytope('simplex, lengths 1e-4 to 1e4', *simplex(decades))
    yield FlatPolytope('simplex, turned', *simplex(np.ones(20), turn))
    yield FlatPolytope('simplex, lengths 1e-4 to 1e4, turned', *simplex(decades, turn))
    for k in (4, 6):
        yield FlatPolytope(f'Birkhoff polytope of {k}', *birkhoff(k))
    yield FlatPolytope('fluxes, 100 x 70', *fluxes(100, 70, seed=3))
    yield FlatPolytope('other fluxes, 100 x 70', *fluxes(100, 70, seed=4))


def ours(space: Space, start: Floats, thin: int) -> Runner:
    """Return a function that continues chains of ours."""
    chains = [begin_chains(space, start, n_chains=CHAINS, seed=1)]

    def run(n_draws: int) -> Floats:
        draws, chains[0] = walk_on(space, chains[0], n_draws, walk=FAST, thin=thin)
        return draws

    return run


def hopsys(hopsy: Any, rounded: Any, proposal: str, thin: int) -> Runner:
    """Return a function that continues chains of hopsy in a rounded polytope."""
    problem = hopsy.Problem(np.asarray(rounded.A), np.asarray(rounded.b))
    start = hopsy.compute_chebyshev_center(problem).ravel()
    kind = getattr(hopsy, proposal)
    chains = [
        hopsy.MarkovChain(problem, proposal=kind, starting_point=start) for _ in range(CHAINS)
    ]
    streams = [hopsy.RandomNumberGenerator(seed=1, stream=k) for k in range(CHAINS)]
    matrix, shift = np.asarray(rounded.transformation), np.asarray(rounded.shift)

    def run(n_draws: int) -> Floats:
        _, draws = hopsy.sample(chains, streams, n_samples=n_draws, thinning=thin)
        return np.asarray(draws) @ matrix.T + shift

    return run


def rounded_by_hopsy(hopsy: Any, polytope: FlatPolytope) -> Any:
    """Return a polytope as hopsy rounds it."""
    problem = hopsy.Problem(polytope.a, polytope.b)
    if polytope.a_eq is not None:
        problem = hopsy.add_equality_constraints(problem, polytope.a_eq, polytope.b_eq)
    return hopsy.round(problem)


class Standing(NamedTuple):
    """Best rate of one library on one polytope, its walk, and the time of its preparation [s]."""

    rate: float
    walk: str
    thin: int
    seconds: float


def compare(hopsy: Any, polytope: FlatPolytope, quick: bool) -> tuple[Standing, Standing]:
    """Return the standings of ours and of hopsy."""
    show(f'rounded, {polytope.name}')
    began = time.process_time()
    space = PolytopeSpace(polytope.a, polytope.b, a_eq=polytope.a_eq, b_eq=polytope.b_eq)
    given = time.process_time() - began
    rounded = round_space(space, seed=1)
    began = time.process_time()
    theirs = rounded_by_hopsy(hopsy, polytope)
    seconds = time.process_time() - began
    dim = space.kernel_dim
    runs: list[dict[tuple[str, int, float], Runner]] = [{}, {}]
    for per_dim in OUR_THINS:
        thin = max(1, int(per_dim * dim))
        runs[0]['rounded', thin, given + rounded.rounding.seconds] = ours(
            rounded, space.centre, thin
        )
        runs[0]['as given', thin, given] = ours(space, space.centre, thin)
    for walk, factors in THEIR_THINS.items():
        for per_dim in factors:
            thin = max(1, int(per_dim * dim))
            runs[1][walk, thin, seconds] = hopsys(hopsy, theirs, walk, thin)
    return _best(runs[0], runs[1], quick)


def _best(ours: dict[Any, Runner], theirs: dict[Any, Runner], quick: bool) -> Any:
    """Return the standings, of the best of each, from turns that all take one after another."""
    n_draws, n_turns = (DRAWS_QUICK, TURNS_QUICK) if quick else (DRAWS, TURNS)
    rates: dict[Any, list[float]] = {}
    for run in (*ours.values(), *theirs.values()):
        run(n_draws // 10)
    for _ in range(n_turns):
        for key, run in (*ours.items(), *theirs.items()):
            began = time.process_time()
            draws = run(n_draws)
            seconds = time.process_time() - began
            # A coordinate that the equations fix varies by rounding at most.
            varies = np.ptp(draws, axis=(0, 1)) > FIXED
            found = diagnose(draws[..., varies])
            rates.setdefault(key, []).append(float(found.ess_bulk.min()) / seconds)
    return tuple(
        max(Standing(median(rates[key]), *key) for key in runs) for runs in (ours, theirs)
    )


def rounded_sampling(bench: Bench) -> Section:
    """Compare effective draws on polytopes that need rounding or have equations."""
    hopsy, verdicts, rows = import_hopsy(bench), [], []
    with on_one_core():
        for polytope in polytopes() if hopsy else ():
            both = compare(hopsy, polytope, bench.quick)
            for whose, standing in zip(('ours', 'hopsy'), both, strict=True):
                rows.append(
                    [
                        polytope.name,
                        whose,
                        standing.walk,
                        str(standing.thin),
                        f'{standing.rate:.3g}',
                        f'{standing.seconds:.2g}',
                    ]
                )
            ratio = both[0].rate / both[1].rate
            measured = f'{both[0].rate:.3g} against {both[1].rate:.3g}: {ratio:.2f}'
            what = f'effective draws a second, {polytope.name}'
            verdicts.append(Verdict(what, f'{AT_LEAST:g} x', measured, ratio >= AT_LEAST))
    head = 'polytope | whose | walk | steps to a draw | effective draws a second | prepared [s]'
    body = [(__doc__ or '').partition('\n\n')[2], table(head, rows) if rows else '']
    return Section('Long and flat polytopes', '\n\n'.join(part.strip() for part in body), verdicts)
