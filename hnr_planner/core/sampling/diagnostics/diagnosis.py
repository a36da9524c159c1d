"""A verdict on draws, in numbers and in words."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.sampling.diagnostics.effective import (
    ess_bulk,
    ess_mean,
    ess_tail,
    r_hat,
    time_within,
)
from hnr_planner.core.sampling.diagnostics.parts import parts_missed
from hnr_planner.core.sampling.diagnostics.stays import frozen, longest_stay, repeats
import numpy as np
from numpy.typing import ArrayLike, NDArray

DRAWS_MIN = 4
CHAINS_MIN = 2
#: Vehtari et al. (2021), section 4.
R_HAT_MAX = 1.01
ESS_MIN = 400
#: A chain that spends this part of its draws on one point, and so many at least, is stuck.
STAY_MAX = 0.05
STAY_MIN = 10


@dataclass(frozen=True)
class Diagnosis:
    """
    What draws show about the chains that made them.

    Attributes
    ----------
    r_hat : (dim,)
        How much the chains disagree on each coordinate; 1 when they agree, inf when none moves.
    ess_bulk, ess_tail : (dim,)
        Effective sample sizes of all draws together, for the middle and for the tails.
    mcse_mean : (dim,)
        Standard error of the mean, in the units of the draws.
    autocorrelation_time : (dim,)
        Draws made for each that counts, for the mean.
    repeats : (n_chains,) int
        Draws equal to the one before them: zero chords, and moves that were rejected.
    longest_stay : (n_chains,) int
        The most draws in a row on one point.
    parts_missed : (n_chains,) int
        Parts of the set, each with as many of all draws, that a chain never entered although it
        made draws enough.
    reasons : tuple of str
        Why the draws must not be taken for draws of the uniform law; empty when nothing speaks
        against it.

    """

    r_hat: Floats
    ess_bulk: Floats
    ess_tail: Floats
    mcse_mean: Floats
    autocorrelation_time: Floats
    repeats: NDArray[np.int64]
    longest_stay: NDArray[np.int64]
    parts_missed: NDArray[np.int64]
    reasons: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether nothing speaks against the draws."""
        return not self.reasons

    @property
    def message(self) -> str:
        """The verdict in one sentence."""
        if self.reasons:
            return 'not converged: ' + '; '.join(self.reasons)
        ess = min(self.ess_bulk.min(), self.ess_tail.min())
        return (
            f'converged: R-hat at most {self.r_hat.max():.4f}, {ess:.0f} effective draws or more'
        )


def diagnose(draws: ArrayLike) -> Diagnosis:
    """
    Say how much draws are worth, and whether the chains that made them have converged.

    A chain that is stuck is never called converged, whatever its R-hat: chains that do not move
    agree perfectly. But nothing here sees a part of the set that no chain has entered. Chains
    that all start at one point show how fast they leave it, and no more than that.

    Parameters
    ----------
    draws : (n_chains, n_draws, dim)
        As ``sample`` returns them; 4 draws or more of each chain.

    Raises
    ------
    RequestError
        When the draws have another shape, are too few or are not finite.

    """
    draws = check_draws(draws)
    coordinates = np.ascontiguousarray(np.moveaxis(draws, 2, 0))
    sizes = np.array([ess_mean(chains) for chains in coordinates])
    spread = draws.std(axis=(0, 1), ddof=1)
    missed, n_parts = parts_missed(draws, max(map(time_within, coordinates)))
    numbers = Diagnosis(
        r_hat=np.array([r_hat(chains) for chains in coordinates]),
        ess_bulk=np.array([ess_bulk(chains) for chains in coordinates]),
        ess_tail=np.array([ess_tail(chains) for chains in coordinates]),
        mcse_mean=np.where(spread > 0.0, spread / np.sqrt(sizes), np.inf),
        autocorrelation_time=coordinates[0].size / sizes,
        repeats=repeats(draws),
        longest_stay=longest_stay(draws),
        parts_missed=missed,
        reasons=(),
    )
    return replace(numbers, reasons=(*_stuck(draws, numbers, n_parts), *_apart(draws, numbers)))


def check_draws(draws: ArrayLike) -> Floats:
    """Return draws (n_chains, n_draws, dim), finite and enough of them, or raise RequestError."""
    try:
        array = np.asarray(draws, dtype=np.float64)
    except (TypeError, ValueError):
        raise RequestError('draws must be numbers (n_chains, n_draws, dim)') from None
    if array.ndim != 3 or 0 in array.shape or array.shape[1] < DRAWS_MIN:
        raise RequestError(
            f'draws must have shape (n_chains, n_draws, dim) with n_draws at least {DRAWS_MIN}, '
            f'got {array.shape}'
        )
    strange = np.argwhere(~np.isfinite(array))
    if len(strange):
        chain, draw, _ = strange[0]
        raise RequestError(
            f'draws must be finite, got {array[chain, draw].tolist()} '
            f'as draw {draw} of chain {chain}'
        )
    return array


def _stuck(draws: Floats, seen: Diagnosis, n_parts: int) -> Iterator[str]:
    """Yield what shows that a chain did not get about."""
    still = frozen(draws)
    for chain in np.flatnonzero(still.all(axis=1)):
        yield f'chain {chain} never moved'
    for chain, coordinate in np.argwhere(still & ~still.all(axis=1, keepdims=True)):
        yield f'chain {chain} never moved in coordinate {coordinate}'
    n_draws = draws.shape[1]
    long = (seen.longest_stay > max(STAY_MAX * n_draws, STAY_MIN)) & ~still.all(axis=1)
    for chain in np.flatnonzero(long):
        yield f'chain {chain} stayed on one point for {seen.longest_stay[chain]} draws'
    for chain in np.flatnonzero((seen.parts_missed > 0) & ~still.all(axis=1)):
        yield (
            f'chain {chain} never entered {seen.parts_missed[chain]} of {n_parts} parts with as '
            f'many draws each'
        )


def _apart(draws: Floats, seen: Diagnosis) -> Iterator[str]:
    """Yield what shows that the chains do not agree, or are too short to tell."""
    if len(draws) < CHAINS_MIN:
        yield 'one chain cannot show whether another would agree'
    worst = int(seen.r_hat.argmax())
    if seen.r_hat[worst] > R_HAT_MAX:
        yield f'R-hat of coordinate {worst} is {seen.r_hat[worst]:.3f}, above {R_HAT_MAX}'
    for where, sizes in (('the middle', seen.ess_bulk), ('the tails', seen.ess_tail)):
        least = int(sizes.argmin())
        if sizes[least] < ESS_MIN:
            yield (
                f'coordinate {least} has {sizes[least]:.1f} effective draws in {where}, '
                f'below {ESS_MIN}'
            )
