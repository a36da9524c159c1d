"""Convergence verdict on draws, with the statistics that it rests on."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.sampling.diagnostics.confinement import count_missed_cells
from hnr_planner.core.sampling.diagnostics.effective import (
    ess_bulk,
    ess_mean,
    ess_tail,
    r_hat,
    time_within,
)
from hnr_planner.core.sampling.diagnostics.holding import frozen, longest_holding_time, repeats
from hnr_planner.core.sampling.diagnostics.separation import compare_pairs, Separation
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Least number of draws of each chain, and of chains for a verdict of convergence.
DRAWS_MIN = 4
CHAINS_MIN = 2
#: Thresholds of Vehtari et al. (2021), Section 4.
R_HAT_MAX = 1.01
ESS_MIN = 400
#: A chain is stuck that holds one point for more than this fraction of its draws, and at least for
#: more than this number of draws.
HOLDING_MAX = 0.05
HOLDING_MIN = 10


@dataclass(frozen=True)
class Diagnosis:
    """
    Convergence statistics of draws, and the reasons against convergence.

    Attributes
    ----------
    r_hat : (dim,)
        R-hat of each coordinate: 1 where the chains agree, inf where none moves.
    ess_bulk, ess_tail : (dim,)
        Effective sample sizes of all draws together, for the middle and for the tails of the
        distribution of each coordinate.
    mcse_mean : (dim,)
        Standard error of the mean of each coordinate, in the units of the draws; inf for a
        coordinate that never varies.
    autocorrelation_time : (dim,)
        Number of draws that estimate the mean of a coordinate as well as one independent draw.
    repeats : (n_chains,) int
        Number of draws equal to the draw before, as zero chords and rejected moves leave them.
    longest_holding_time : (n_chains,) int
        Largest number of consecutive draws on one point.
    cells_missed : (n_chains,) int
        Number of cells that each chain never entered although it made enough draws. All draws
        together are divided into up to 16 cells with equal numbers of draws.
    separated : (n_chains, n_chains) bool
        Whether the draws of two chains can be distinguished by their positions, so that the
        chains are in different regions, however finely interleaved.
    reasons : tuple of str
        Reasons why the chains have not converged; empty where none was found.

    """

    r_hat: Floats
    ess_bulk: Floats
    ess_tail: Floats
    mcse_mean: Floats
    autocorrelation_time: Floats
    repeats: NDArray[np.int64]
    longest_holding_time: NDArray[np.int64]
    cells_missed: NDArray[np.int64]
    separated: NDArray[np.bool_]
    reasons: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether no reason against convergence was found."""
        return not self.reasons

    @property
    def message(self) -> str:
        """The verdict in one sentence: converged, or not converged with all reasons."""
        if self.reasons:
            return 'not converged: ' + '; '.join(self.reasons)
        ess = min(self.ess_bulk.min(), self.ess_tail.min())
        return (
            f'converged: R-hat at most {self.r_hat.max():.4f}, {ess:.0f} effective draws or more'
        )


def diagnose(draws: ArrayLike) -> Diagnosis:
    """
    Compute convergence statistics of draws, and judge whether their chains have converged.

    A stuck chain is never called converged, whatever its R-hat (chains that do not move agree
    perfectly), nor are chains that keep to different regions. No diagnostic detects a region that
    no chain has entered: chains that all start at one point show how fast they leave it, and no
    more. Module ``separation`` states what a comparison of two chains cannot detect.

    Parameters
    ----------
    draws : (n_chains, n_draws, dim)
        Draws as ``sample`` returns them, 4 or more of each chain.

    Raises
    ------
    RequestError
        When the draws have another shape, are too few or are not finite.

    """
    draws = check_draws(draws)
    coordinates = np.ascontiguousarray(np.moveaxis(draws, 2, 0))
    sizes = np.array([ess_mean(chains) for chains in coordinates])
    spread = draws.std(axis=(0, 1), ddof=1)
    time = max(map(time_within, coordinates))
    missed, n_cells = count_missed_cells(draws, time)
    pairs = compare_pairs(draws, time)
    statistics = Diagnosis(
        r_hat=np.array([r_hat(chains) for chains in coordinates]),
        ess_bulk=np.array([ess_bulk(chains) for chains in coordinates]),
        ess_tail=np.array([ess_tail(chains) for chains in coordinates]),
        mcse_mean=np.where(spread > 0.0, spread / np.sqrt(sizes), np.inf),
        autocorrelation_time=coordinates[0].size / sizes,
        repeats=repeats(draws),
        longest_holding_time=longest_holding_time(draws),
        cells_missed=missed,
        separated=pairs.separated,
        reasons=(),
    )
    reasons = (
        *_signs_of_sticking(draws, statistics, n_cells),
        *_signs_of_separation(pairs),
        *_signs_of_disagreement(statistics),
    )
    return replace(statistics, reasons=reasons)


def check_draws(draws: ArrayLike) -> Floats:
    """
    Return draws as a float64 array (n_chains, n_draws, dim).

    Raises
    ------
    RequestError
        When the draws have another shape, are not finite, or are fewer than ``DRAWS_MIN`` of each
        chain.

    """
    try:
        array = np.asarray(draws, dtype=np.float64)
    except (TypeError, ValueError):
        raise RequestError('draws must be numbers (n_chains, n_draws, dim)') from None
    if array.ndim != 3 or 0 in array.shape or array.shape[1] < DRAWS_MIN:
        raise RequestError(
            f'draws must have shape (n_chains, n_draws, dim) with n_draws at least {DRAWS_MIN}, '
            f'got {array.shape}'
        )
    not_finite = np.argwhere(~np.isfinite(array))
    if len(not_finite):
        chain, draw, _ = not_finite[0]
        raise RequestError(
            f'draws must be finite, got {array[chain, draw].tolist()} '
            f'as draw {draw} of chain {chain}'
        )
    return array


def _signs_of_sticking(draws: Floats, statistics: Diagnosis, n_cells: int) -> Iterator[str]:
    """Yield the reasons that concern single chains: frozen, stuck or confined."""
    still = frozen(draws)
    for chain in np.flatnonzero(still.all(axis=1)):
        yield f'chain {chain} never moved'
    for chain, coordinate in np.argwhere(still & ~still.all(axis=1, keepdims=True)):
        yield f'chain {chain} never moved in coordinate {coordinate}'
    n_draws = draws.shape[1]
    moving = ~still.all(axis=1)
    held = statistics.longest_holding_time
    for chain in np.flatnonzero((held > max(HOLDING_MAX * n_draws, HOLDING_MIN)) & moving):
        yield f'chain {chain} stayed on one point for {held[chain]} draws'
    missed = statistics.cells_missed
    for chain in np.flatnonzero((missed > 0) & moving):
        yield f'chain {chain} never entered {missed[chain]} of {n_cells} cells of equal weight'


def _signs_of_separation(pairs: Separation) -> Iterator[str]:
    """Yield one reason, naming the pair of chains that differs most, if any pair is separated."""
    n_separated = int(np.triu(pairs.separated).sum())
    if n_separated == 0:
        return
    accuracy = np.where(pairs.separated, pairs.accuracy, 0.0)
    first, second = np.unravel_index(accuracy.argmax(), accuracy.shape)
    yield (
        f'chains {first} and {second} keep to different regions: {accuracy.max():.0%} of their '
        f'draws lie nearer to draws of their own chain ({n_separated} of '
        f'{math.comb(len(accuracy), 2)} pairs of chains differ)'
    )


def _signs_of_disagreement(statistics: Diagnosis) -> Iterator[str]:
    """Yield the reasons that concern all chains: they disagree, or are too few or too short."""
    if len(statistics.repeats) < CHAINS_MIN:
        yield 'one chain cannot show whether another would agree'
    worst = int(statistics.r_hat.argmax())
    if statistics.r_hat[worst] > R_HAT_MAX:
        yield f'R-hat of coordinate {worst} is {statistics.r_hat[worst]:.3f}, above {R_HAT_MAX}'
    for where, sizes in (('the middle', statistics.ess_bulk), ('the tails', statistics.ess_tail)):
        least = int(sizes.argmin())
        if sizes[least] < ESS_MIN:
            yield (
                f'coordinate {least} has {sizes[least]:.1f} effective draws in {where}, '
                f'below {ESS_MIN}'
            )
