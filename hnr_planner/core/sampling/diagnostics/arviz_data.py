"""Conversion of draws for arviz, for its plots and further diagnostics."""

from typing import Any

from hnr_planner.core.sampling.diagnostics.diagnosis import check_draws
from numpy.typing import ArrayLike


def to_arviz(draws: ArrayLike) -> Any:
    """
    Return draws (n_chains, n_draws, dim) as a dataset with one variable ``x``.

    It is an ``xarray.Dataset`` with the dimensions ``chain`` and ``draw``, which the functions of
    all versions of arviz accept: ``arviz.summary(to_arviz(draws))``.

    Raises
    ------
    ModuleNotFoundError
        When arviz is not installed; it is not a dependency of the package.

    """
    import arviz

    return arviz.convert_to_dataset({'x': check_draws(draws)})
