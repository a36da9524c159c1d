"""Conduct an experiment: compute missing rows in parallel, then write figure and tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
import platform
from typing import Any

from hnr_planner.core import warm_up
from hnr_planner.core.kernels.modes import in_this_mode
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import save, sign
from hnr_planner.experiments.results import made_with, Results, ResultsError, ResultsFile
from joblib import delayed, Parallel
from tqdm import tqdm


def conduct(
    experiment: Experiment,
    runs: int,
    folder: Path,
    *,
    n_jobs: int = -1,
    fresh: bool = False,
) -> Results:
    """
    Run every case of an experiment with the seeds 0 to ``runs - 1`` and return the results.

    Only rows that the CSV file does not have yet are computed.

    joblib computes the rows, by default in as many processes as there are cores; a call within
    ``on_cluster(address)`` sends them to a Dask cluster. The rows and their order in the file are
    the same. All processes treat kernels without machine code as the mode of this thread says.

    Parameters
    ----------
    experiment : Experiment
        The experiment.
    runs : int
        Runs of every case, at least 1.
    folder : Path
        Folder for NAME.csv, NAME.json (versions that the rows were computed with), NAME.svg and
        NAME.md. Rows already in NAME.csv are kept.
    n_jobs : int
        Number of rows computed at the same time; -1 for one on each core.
    fresh : bool
        Whether existing rows are discarded.

    Raises
    ------
    ResultsError
        When the existing rows belong to other cases, or to another version of the core, or when a
        worker of a cluster has other versions than this process.

    """
    folder.mkdir(parents=True, exist_ok=True)
    file = ResultsFile(folder / f'{experiment.name}.csv', experiment.cases(), fresh=fresh)
    file.extend(_rows(experiment, file, runs, n_jobs))
    results = file.read(runs)

    signature = _signature(experiment, results, file.made_with)
    figure = experiment.figure(results)
    sign(figure, signature)
    save(figure, folder / f'{experiment.name}.svg')
    text = f'# {experiment.name}\n\n{experiment.entry.summary}\n\n{experiment.tables(results)}\n'
    (folder / f'{experiment.name}.md').write_text(f'{text}{signature}.\n', encoding='utf-8')
    return results


def _rows(
    experiment: Experiment, file: ResultsFile, runs: int, n_jobs: int
) -> Iterator[tuple[object, int, dict[str, float]]]:
    """Yield (case, seed, measured columns) of every missing row, in order, with a progress bar."""
    done, missing = file.n_rows, file.tasks(runs)
    if not missing:
        return
    warm_up()  # so that not every process compiles what grids need
    versions, run = made_with(), in_this_mode(measured_with)
    compute = Parallel(n_jobs=n_jobs, return_as='generator')
    computed = compute(
        delayed(run)(versions, experiment.run, case, seed) for case, seed in missing
    )
    bar = tqdm(
        computed, experiment.name, initial=done, total=done + len(missing), unit='run', smoothing=0
    )
    for (case, seed), measured in zip(missing, bar, strict=True):
        yield case, seed, measured


def measured_with(
    versions: Mapping[str, str],
    run: Callable[[Any, int], Mapping[str, float]],
    case: Any,
    seed: int,
) -> Mapping[str, float]:
    """
    Return the columns of one row, computed by a process that has to have the given versions.

    Raises
    ------
    ResultsError
        When this process, such as a worker on another machine, has other versions.

    """
    differing = [
        f'{name} {here} (expected {versions[name]})'
        for name, here in _versions_here().items()
        if here != versions[name]
    ]
    if differing:
        raise ResultsError(f'{platform.node()} would compute with {", ".join(differing)}')
    return run(case, seed)


@cache
def _versions_here() -> dict[str, str]:
    """Return the versions of this process, read once."""
    return made_with()


def _signature(experiment: Experiment, results: Results, made: dict[str, str]) -> str:
    """Return the line at the foot of figure and tables: runs, seeds, command and versions."""
    return (
        f'{results.runs} runs of each, seeds 0 to {results.runs - 1}. python -m hnr_planner '
        f'experiment {experiment.name} --runs {results.runs}; hnr_planner {made["hnr_planner"]}, '
        f'core {made["core"][:8]}'
    )
