"""Every experiment runs, repeats itself, and draws what it measured."""

from dataclasses import replace
from pathlib import Path
import re
from test.sweeps import sweep

from hnr_planner.core import GridSpace
from hnr_planner.experiments import clouds, EXPERIMENTS, load, NAMES, safety
from hnr_planner.experiments.conduct import conduct
from hnr_planner.experiments.mixing import sets, variation
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.experiments.results import Results
from hnr_planner.maps import OccupancyMap, save_map
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
#: Experiments that compile for themselves alone, or take seconds; what they are made of is tested
#: below, in test_mixing.py and in test/core/.
LONG = ('clouds', 'mixing', 'restarts', 'safety', 'theory')


@pytest.mark.parametrize(
    'name',
    [sweep(name) if name in LONG else name for name in NAMES],
)
def test_every_experiment_runs_and_repeats_itself(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv('HNR_MAPS', raising=False)
    monkeypatch.setattr(sets, 'CHAINS_PER_CELL', 4)  # a few chains, seen from afar
    monkeypatch.setattr(variation, 'MIXED', 0.5)
    monkeypatch.setattr(safety, 'FLOORS', {'floor 2': 2})  # one of three
    experiment = load(name)
    assert experiment.entry is EXPERIMENTS[name]
    results = conduct(experiment, 1, tmp_path, n_jobs=1)
    cases = experiment.cases()
    assert len(results) == len(cases)
    for k in (0, len(cases) - 1):
        again = experiment.run(cases[k], 0)
        assert {column: results[column][k] for column in again} == pytest.approx(
            dict(again), rel=0.0, abs=0.0, nan_ok=True
        )
    assert (tmp_path / f'{name}.svg').stat().st_size < 250_000


@pytest.mark.parametrize('name', NAMES)
def test_every_experiment_has_its_page_and_figure(name: str) -> None:
    page = (ROOT / 'docs' / f'{name}.md').read_text()
    assert f'figures/{name}.svg' in page
    assert f'python -m hnr_planner experiment {name}' in page
    assert f'({name}.md)' in (ROOT / 'docs' / 'measured.md').read_text()
    assert (ROOT / 'docs' / 'figures' / f'{name}.svg').stat().st_size < 150_000


# -- safety


def test_clearance_is_measured_along_the_whole_path() -> None:
    blocked = np.zeros((60, 200), dtype=bool)
    blocked[0] = True
    space = GridSpace.from_blocked(blocked, 0.1)
    # 8 m at .25 m from the wall, then 4 m straight away from it.
    path = np.array([[1.0, 0.35], [9.0, 0.35], [9.0, 4.35]])
    measured = safety.measures(space, path)
    assert measured['length'] == pytest.approx(12.0)
    assert measured['least'] == pytest.approx(0.25 - safety.ROBOT_RADIUS, abs=1e-9)
    mean = (8.0 * 0.25 + 4.0 * 2.25) / 12.0 - safety.ROBOT_RADIUS
    assert measured['mean'] == pytest.approx(mean, abs=0.01)
    near = (8.0 + safety.ROBOT_RADIUS + safety.NEAR - 0.25) / 12.0
    assert measured['near'] == pytest.approx(near, abs=0.01)
    assert measured['near_length'] == pytest.approx(12.0 * near, abs=0.05)


@pytest.mark.parametrize('seed', range(5))
def test_start_and_goal_are_far_apart_in_one_part(seed: int) -> None:
    blocked = np.zeros((30, 80), dtype=bool)
    blocked[:, 60] = True
    space = GridSpace.from_blocked(blocked, 0.1)
    pairs = far_pairs(space, 50, seed)
    assert (pairs == far_pairs(space, 50, seed)).all()
    assert (pairs[:10] == far_pairs(space, 10, seed)).all()
    assert space.contains(pairs.reshape(-1, 2)).all()
    assert (pairs[..., 0] < 6.0).all()
    distances = np.hypot(*(pairs[:, 1] - pairs[:, 0]).T)
    assert distances.min() >= 0.4 * np.hypot(2.9, 5.9) - 1e-9


@pytest.fixture
def with_a_robot_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the map of a hall with a pillar into the folder of robot maps."""
    data = np.zeros((80, 120), dtype=np.int8)
    data[[0, -1]], data[:, [0, -1]], data[30:50, 50:60] = 100, 100, 100
    save_map(OccupancyMap(data, 0.05), tmp_path / 'hall.yaml')
    monkeypatch.setenv(safety.MAPS_VARIABLE, str(tmp_path))


@pytest.mark.sweep
@pytest.mark.usefixtures('with_a_robot_map')
def test_robot_maps_take_part_by_name_and_are_told_apart(tmp_path: Path) -> None:
    cases = [case for case in safety.cases() if case.place in ('floor 2', 'hall')]
    assert len(cases) == 2 * len(safety.PLANNERS)
    two_maps = replace(safety.EXPERIMENT, cases=lambda: cases)
    results = conduct(two_maps, 1, tmp_path / 'out', n_jobs=1)
    assert len(safety.figure(results).axes) == 4
    written = (tmp_path / 'out' / 'safety.md').read_text()
    headers = re.findall(r'^\| ([^|]+) \| mean', written, re.MULTILINE)
    assert headers == ['all generated floors', 'all robot maps', 'floor 2', 'hall']
    for file in (tmp_path / 'out').iterdir():
        assert str(tmp_path) not in file.read_text()


def test_mean_over_maps_is_as_certain_as_each_of_them() -> None:
    values = np.array([1.0, 3.0, 11.0, 13.0])
    results = Results(
        {
            'place': np.array(['near', 'near', 'far', 'far']),
            'algorithm': np.full(4, 'rrt'),
            'clearance': np.zeros(4),
            'found_mean': values,
        }
    )
    table = safety._mean(results, ('rrt', 0.0), 'found_mean')
    assert table.value == pytest.approx(7.0)
    assert table.half == pytest.approx(1.96 * np.sqrt(0.5))


# -- clouds


@pytest.fixture(scope='module')
def corridor() -> clouds.Straightened:
    return clouds.straightened(clouds.SHOWN_WIDTH)


def test_slices_have_equal_areas_from_start_to_goal(corridor: clouds.Straightened) -> None:
    free = corridor.way[np.isfinite(corridor.way)]
    counts = np.histogram(free, corridor.edges)[0]
    assert counts == pytest.approx(np.full(clouds.N_SLICES, counts.mean()), rel=0.02)
    assert corridor.edges[0] == 0.0
    assert corridor.edges[-1] == pytest.approx(1.0, abs=0.05)


def test_uniform_points_are_even_and_others_are_not() -> None:
    """
    The distance of 400 uniform points in 40 slices from even ones is .125 with spread .016.

    So .04 off .125 in the mean of 20 runs is 11 standard deviations.
    """
    case = clouds.Case(clouds.SHOWN_WIDTH, clouds.UNIFORM)
    runs = [clouds.run(case, seed) for seed in range(20)]
    assert np.mean([run['uneven'] for run in runs]) == pytest.approx(0.125, abs=0.04)
    layers = np.array([[run[f'layer_{k}'] for k in range(clouds.N_LAYERS)] for run in runs])
    assert layers.mean(axis=0) == pytest.approx(np.ones(clouds.N_LAYERS), abs=0.1)
    walk = clouds.run(clouds.Case(clouds.SHOWN_WIDTH, 'rrt'), 0)
    assert walk['uneven'] > 0.17
    assert walk['on_wall'] > 0.01


def test_arrivals_are_in_order_and_the_last_one_is_the_goal() -> None:
    measured = clouds.run(clouds.Case(clouds.SHOWN_WIDTH, 'hit_and_run'), 3)
    arrivals = [measured[f'arrival_{k + 1}'] for k in range(clouds.N_PARTS)]
    assert arrivals == sorted(arrivals)
    assert arrivals[0] > 0
    assert arrivals[-1] == measured['transitions']
