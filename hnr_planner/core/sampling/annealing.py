"""
Simulated annealing by Hit-and-Run: the minimum of a function on a set that need not be convex.

A chain draws from the density ``exp(-objective / temperature)``, and the temperature falls from
one phase to the next by a factor that depends on the dimension only (Kalai and Vempala, "Simulated
annealing for convex optimization", 2006).
"""

from collections.abc import Callable
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_count, check_positive, check_seed, Floats, Seed
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import new_chain, run_chain
from hnr_planner.core.sampling.chains import begin_chains
from hnr_planner.core.sampling.density_steps import CompiledDensity
from hnr_planner.core.sampling.walks import HitAndRunWalk
from hnr_planner.core.spaces.space import Space
from numba import njit
from numba.core.dispatcher import Dispatcher
import numpy as np
from numpy.typing import ArrayLike

#: Steps of the uniform walk that measures how much the objective varies.
SURVEY = 500
#: Last temperature, as a fraction of the first.
COLDEST = 1e-6


class Optimum(NamedTuple):
    """
    The best point that was found.

    Attributes
    ----------
    point : (dim,)
        A free point, caller's frame.
    value : float
        The objective at that point.

    """

    point: Floats
    value: float


def anneal(
    space: Space,
    objective: Callable[[Any], float],
    start: ArrayLike,
    *,
    n_steps: int = 20_000,
    temperature: float | None = None,
    n_chains: int = 1,
    seed: Seed = None,
) -> Optimum:
    """
    Minimize a function on the component of a start, by simulated annealing.

    A global minimum is found with a probability that grows with ``n_steps``; it is not proved.

    Parameters
    ----------
    space : Space
        The set to search.
    objective : callable
        A function of a point (dim,) in the caller's frame, compiled by numba or in Python, that
        returns a finite number at every free point.
    start : (dim,)
        A free point.
    n_steps : int
        Number of steps of each chain, over all temperatures.
    temperature : float, optional
        First temperature, in the units of the objective. When left out, the standard deviation of
        the objective at the points of a uniform walk.
    n_chains : int
        Number of chains, of which the best point counts.
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        Source of the random numbers; fresh when left out.

    Returns
    -------
    Optimum
        The best point of all chains, and its value.

    Raises
    ------
    RequestError
        When an argument is malformed, the start is not free, or the objective is not a finite
        number at a point.
    StuckError
        When a chain has not moved for 1000 consecutive steps.

    """
    n_steps, seed = check_count('n_steps', n_steps, 1), check_seed(seed)
    if not callable(objective):
        raise RequestError(f'objective must be a function, got {objective!r}')
    density = CompiledDensity(_negative(objective))
    chains = begin_chains(space, start, n_chains=n_chains, seed=seed)
    best = Optimum(space.from_kernel(chains.points[0]), math.inf)
    if temperature is None:
        survey = new_chain(space, chains.points[0].copy(), stream(seed, n_chains))
        draws = _draws(space, HitAndRunWalk().compiled(space), survey, SURVEY)
        values = _values(objective, draws)
        best, first = _better(best, draws, values), float(np.std(values)) or 1.0
    else:
        first = check_positive('temperature', temperature)
    falls = max(1, math.ceil(-math.log(COLDEST) * math.sqrt(space.kernel_dim)))
    steps = np.diff(np.linspace(0, n_steps, falls + 1).astype(int))
    for k in range(len(chains.points)):
        for fall, n in enumerate(steps):
            walk = density.step(space, first * COLDEST ** (fall / falls))
            draws = _draws(space, walk, chains.chain(k), int(n))
            best = _better(best, draws, _values(objective, draws))
    return best


def _negative(objective: Callable[[Any], float]) -> Callable[[Any], float]:
    """Return the negative of a function, compiled by numba if the function is."""

    def negative(x):
        return -objective(x)

    return njit(nogil=True)(negative) if isinstance(objective, Dispatcher) else negative


def _draws(space: Space, walk: Any, chain: Any, n_steps: int) -> Floats:
    """Return the points (n_steps, dim), caller's frame, of further steps of a chain."""
    draws = np.empty((n_steps, space.kernel_dim))
    run_chain(space, walk, chain, 1, draws)
    return space.from_kernel(draws)


def _values(objective: Callable[[Any], float], points: Floats) -> Floats:
    """Return the objective (n,) at points (n, dim); raise RequestError unless all are finite."""
    values = np.array([float(objective(x)) for x in points])
    wrong = ~np.isfinite(values)
    if wrong.any():
        k = int(wrong.argmax())
        raise RequestError(
            f'objective must be a finite number at every free point, but is {values[k]} at '
            f'{points[k].tolist()}'
        )
    return values


def _better(best: Optimum, points: Floats, values: Floats) -> Optimum:
    """Return the better of an optimum and the best of some points (n, dim)."""
    if len(values) == 0 or values.min() >= best.value:
        return best
    k = int(values.argmin())
    return Optimum(points[k].copy(), float(values[k]))
