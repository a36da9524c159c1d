"""Chains whose autocorrelation is known."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

BEFORE = 2_000


def autoregressive(
    phi: float, n_chains: int, n_draws: int, dim: int, seed: int
) -> NDArray[np.float64]:
    """Return draws (n_chains, n_draws, dim): x' = phi x + noise, all of them stationary."""
    noise = np.random.default_rng(seed).normal(size=(n_chains, BEFORE + n_draws, dim))
    return lfilter([1.0], [1.0, -phi], noise, axis=1)[:, BEFORE:]
