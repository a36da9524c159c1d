"""The front door: the public names of ``hnr_planner`` and of ``hnr_planner.core``."""

import ast
import importlib
from pathlib import Path
from test.fresh_python import run_and_list_imports
from types import ModuleType

import hnr_planner
from hnr_planner import core
import pytest

ROOT = Path(__file__).resolve().parents[1]

#: Public names, which users rely on: none of them may disappear.
PROMISED = {
    'ALGORITHMS',
    'BallSpace',
    'BallWalk',
    'BoxSpace',
    'Cancelled',
    'Car',
    'Chains',
    'Chord',
    'CoordinateHitAndRunWalk',
    'Diagnosis',
    'DifferenceSpace',
    'DoubleIntegrator',
    'Exponential',
    'FirstSolution',
    'FreeSpaceDraws',
    'Gaussian',
    'GridSpace',
    'HitAndRun',
    'HitAndRunConnect',
    'HitAndRunWalk',
    'HnrError',
    'KINODYNAMIC_ALGORITHMS',
    'KINODYNAMIC_PLANNERS',
    'MappedSpace',
    'Optimum',
    'OracleError',
    'OracleSpace',
    'PlanBatch',
    'PlanResult',
    'PlannerStatus',
    'Polyanya',
    'PolygonSpace',
    'PolytopeSpace',
    'PoseSpace',
    'ProductSpace',
    'RRT',
    'RRTConnect',
    'RequestError',
    'Roadmap',
    'ShearedSpace',
    'Space',
    'RoundedSpace',
    'SearchResult',
    'SpaceError',
    'StuckError',
    'System',
    'TotalVariation',
    'Tour',
    'Trajectory',
    'TrajectoryResult',
    'UnionSpace',
    'WALKS',
    'anneal',
    'begin_chains',
    'compile_all',
    'compile_in_background',
    'diagnose',
    'distances',
    'join_trajectories',
    'plan',
    'plan_many',
    'plan_trajectory',
    'relaxation_time',
    'round_space',
    'sample',
    'sample_free_space',
    'simplify',
    'to_arviz',
    'total_variation',
    'tour',
    'walk_on',
    'warm_up',
}


def test_no_promised_name_disappears() -> None:
    assert set(core.__all__) >= PROMISED
    assert hnr_planner.__all__ == core.__all__


@pytest.mark.parametrize('name', core.__all__)
def test_both_packages_have_the_same_value_under_a_name(name: str) -> None:
    value = getattr(core, name)
    assert getattr(hnr_planner, name) is value
    assert not isinstance(value, ModuleType)


@pytest.mark.parametrize('package', [hnr_planner, core])
def test_no_module_hides_a_public_name(package: ModuleType) -> None:
    assert package.__file__ is not None
    modules = {path.stem for path in Path(package.__file__).parent.iterdir()}
    assert modules.isdisjoint(core.__all__)


@pytest.mark.parametrize('package', [hnr_planner, core])
def test_an_unknown_name_is_an_attribute_error(package: ModuleType) -> None:
    with pytest.raises(AttributeError, match=rf"'{package.__name__}' has no attribute 'plam'"):
        package.plam  # noqa: B018
    with pytest.raises(ImportError):
        exec(f'from {package.__name__} import plam')


@pytest.mark.parametrize('package', [hnr_planner, core])
def test_completion_offers_every_name(package: ModuleType) -> None:
    assert set(dir(package)) >= {*core.__all__, '__doc__'}


def test_systems_are_also_in_their_own_package() -> None:
    systems = importlib.import_module('hnr_planner.core.systems')
    assert systems.DoubleIntegrator is core.DoubleIntegrator and systems.Car is core.Car


def test_the_stub_is_read_as_type_checkers_read_it() -> None:
    stub = ast.parse((ROOT / 'hnr_planner/core/__init__.pyi').read_text())
    seen = {}
    for statement in stub.body:
        assert isinstance(statement, ast.ImportFrom) and statement.module is not None
        for alias in statement.names:
            assert alias.asname == alias.name  # else it is not re-exported
            seen[alias.name] = statement.module
    assert seen == core._MODULE_OF


@pytest.mark.parametrize(
    'statement',
    ['import hnr_planner', 'import hnr_planner.core', 'from hnr_planner import HnrError'],
)
def test_the_door_imports_nothing_heavy(statement: str) -> None:
    _, packages = run_and_list_imports(statement)
    assert packages.isdisjoint({'numpy', 'numba', 'scipy', 'cv2', 'matplotlib'})
