"""The table of planners for systems: every name leads to a planner, and none costs an import."""

from pathlib import Path
import subprocess
import sys

from hnr_planner.core.trajectories import registry
from hnr_planner.core.trajectories.registry import (
    AUTO_SUMMARY,
    KINODYNAMIC_ALGORITHMS,
    KINODYNAMIC_ENTRIES,
    KINODYNAMIC_PLANNERS,
)
import pytest

PACKAGES = 'hnr_planner hnr_planner.core hnr_planner.core.planning hnr_planner.core.trajectories'
ROOT = Path(registry.__file__).parents[3]
#: Loads the table from its file, as if the packages above it imported nothing.
ALONE = f"""
import sys, types
for name in '{PACKAGES}'.split():
    package = types.ModuleType(name)
    package.__path__ = ['{ROOT}/' + name.replace('.', '/')]
    sys.modules[name] = package
from hnr_planner.core.trajectories.registry import KINODYNAMIC_ALGORITHMS
print(len(KINODYNAMIC_ALGORITHMS), sorted({{'numpy', 'numba'}} & set(sys.modules)))
"""


def test_names_are_known_without_the_compiler() -> None:
    done = subprocess.run(
        [sys.executable, '-c', ALONE], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split(maxsplit=1) == [str(len(KINODYNAMIC_ALGORITHMS)), '[]\n']


def test_every_planner_is_listed_once_by_the_name_of_its_class() -> None:
    names = [entry.name for entry in KINODYNAMIC_ENTRIES]
    assert KINODYNAMIC_ALGORITHMS == ('auto', *names) and len(set(names)) == len(names)
    assert list(KINODYNAMIC_PLANNERS) == names
    for entry in KINODYNAMIC_ENTRIES:
        assert KINODYNAMIC_PLANNERS[entry.name] is entry.load()
        assert entry.load().name == entry.name
        assert entry.summary and entry.summary in entry.summary.splitlines()
        assert entry.name in KINODYNAMIC_PLANNERS
    assert 'rrt' not in KINODYNAMIC_PLANNERS and KINODYNAMIC_PLANNERS.get('rrt') is None
    with pytest.raises(KeyError):
        KINODYNAMIC_PLANNERS['rrt']
    assert all(name in AUTO_SUMMARY for name in ('kinodynamic_connect', 'kinodynamic_rrt'))
