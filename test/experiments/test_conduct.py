"""Experiments can be interrupted, resumed and repeated, and their files stay the same."""

from collections.abc import Callable, Mapping
import json
from pathlib import Path
from typing import NamedTuple

from hnr_planner.experiments.conduct import conduct
from hnr_planner.experiments.entry import ExperimentEntry
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import new_figure
from hnr_planner.experiments.results import Mean, Results, ResultsError, ResultsFile
from matplotlib.figure import Figure
import numpy as np
import pytest


class Case(NamedTuple):
    name: str
    factor: float


class Breaking(NamedTuple):
    """A case that cannot be run while a file is missing."""

    name: str
    needed: str


CASES = [Case('third', 1 / 3), Case('tenth', 0.1), Case('nothing', 0.0)]


def measure(case: Case, seed: int) -> dict[str, float]:
    drawn = np.random.default_rng(seed).uniform()
    return {'product': case.factor * drawn, 'missing': np.nan}


def measure_where_possible(case: Breaking, seed: int) -> dict[str, float]:
    if seed == 1 and not Path(case.needed).exists():
        raise FileNotFoundError(case.needed)
    return {'seed_again': seed}


def figure(results: Results) -> Figure:
    drawn = new_figure(4.0, 3.0)
    drawn.subplots().plot(results['seed'])
    return drawn


def experiment(
    cases: list, run: Callable[[Case, int], Mapping[str, float]] = measure
) -> Experiment:
    return Experiment(
        ExperimentEntry('arithmetic', __name__, 'Products.'),
        runs=4,
        cases=lambda: cases,
        run=run,
        figure=figure,
        tables=lambda results: f'{len(results)} rows\n',
    )


def written(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


@pytest.fixture(scope='module')
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of an experiment of four runs, conducted in one call."""
    folder = tmp_path_factory.mktemp('whole')
    conduct(experiment(CASES), 4, folder, n_jobs=1)
    return folder


def test_rows_are_those_of_the_cases_and_seeds(whole: Path) -> None:
    results = conduct(experiment(CASES), 4, whole)
    assert len(results) == 12 and results.runs == 4
    for case in CASES:
        for seed in range(4):
            row = results.where(**case._asdict(), seed=seed)
            assert row['product'].tolist() == [measure(case, seed)['product']]
            assert np.isnan(row['missing']).all()


def test_files_are_the_same_however_the_rows_were_computed(whole: Path, tmp_path: Path) -> None:
    conduct(experiment(CASES), 4, tmp_path, n_jobs=2)
    assert written(tmp_path) == written(whole)
    assert set(written(whole)) == {f'arithmetic.{end}' for end in ('csv', 'json', 'md', 'svg')}


@pytest.mark.parametrize('kept', [0.0, 0.02, 0.4, 0.77, 1.0])
def test_what_was_broken_off_goes_on(whole: Path, tmp_path: Path, kept: float) -> None:
    for name, content in written(whole).items():
        part = content[: round(kept * len(content))] if name.endswith('.csv') else content
        (tmp_path / name).write_bytes(part)
    conduct(experiment(CASES), 4, tmp_path, n_jobs=1)
    assert written(tmp_path) == written(whole)


def test_rows_before_an_error_are_kept(tmp_path: Path) -> None:
    needed = tmp_path / 'needed'
    cases = [Breaking('always', str(tmp_path)), Breaking('at last', str(needed))]
    breaking = experiment(cases, measure_where_possible)  # type: ignore[arg-type]
    folder = tmp_path / 'results'
    with pytest.raises(FileNotFoundError):
        conduct(breaking, 3, folder, n_jobs=1)
    kept = (folder / 'arithmetic.csv').read_text().splitlines()
    assert kept[1:] == [
        f'always,{tmp_path},0,0',
        f'at last,{needed},0,0',
        f'always,{tmp_path},1,1',
    ]
    needed.touch()
    assert len(conduct(breaking, 3, folder, n_jobs=1)) == 6


def test_more_runs_continue_fewer_and_fewer_read_their_part(whole: Path, tmp_path: Path) -> None:
    conduct(experiment(CASES), 2, tmp_path, n_jobs=1)
    few = written(tmp_path)
    assert written(whole)['arithmetic.csv'].startswith(few['arithmetic.csv'])
    conduct(experiment(CASES), 4, tmp_path, n_jobs=1)
    assert written(tmp_path) == written(whole)
    assert conduct(experiment(CASES), 2, tmp_path).runs == 2
    assert written(tmp_path) == few | {'arithmetic.csv': written(whole)['arithmetic.csv']}


def test_figure_and_numbers_say_what_was_run(whole: Path) -> None:
    for end in ('svg', 'md'):
        # XML allows no -- in a comment, where matplotlib puts the text of a figure.
        text = (whole / f'arithmetic.{end}').read_text().replace('- -', '--')
        assert '4 runs of each, seeds 0 to 3' in text
        assert 'python -m hnr_planner experiment arithmetic --runs 4' in text


def test_results_of_other_cases_are_refused(whole: Path, tmp_path: Path) -> None:
    for name, content in written(whole).items():
        (tmp_path / name).write_bytes(content)
    other = experiment([*CASES[:2], Case('nothing', 0.5)])
    with pytest.raises(ResultsError, match=r'row 3 should begin with nothing,0\.5,0 and is'):
        conduct(other, 4, tmp_path)
    assert written(tmp_path) == written(whole)
    assert len(conduct(other, 1, tmp_path, n_jobs=1, fresh=True)) == 3


def test_results_of_another_core_are_refused(whole: Path, tmp_path: Path) -> None:
    for name, content in written(whole).items():
        (tmp_path / name).write_bytes(content)
    note = tmp_path / 'arithmetic.json'
    note.write_text(json.dumps(json.loads(note.read_text()) | {'core': '0123'}))
    with pytest.raises(ResultsError, match='other sources of the core'):
        ResultsFile(tmp_path / 'arithmetic.csv', CASES)


def test_mean_leaves_out_what_is_missing_and_says_how_sure_it_is() -> None:
    values = np.random.default_rng(0).normal(5.0, 2.0, 400)
    mean = Results({'x': np.append(values, np.nan)}).mean('x')
    assert mean.value == pytest.approx(values.mean())
    assert mean.half == pytest.approx(1.96 * values.std(ddof=1) / 20)
    assert str(Mean(1234.567, 12.3)) == '1,235 ± 12'
    assert str(Mean(0.123456, 0.00123)) == '0.1235 ± 0.0012'
    assert str(Results({'x': np.array([np.nan])}).mean('x')) == '-'
