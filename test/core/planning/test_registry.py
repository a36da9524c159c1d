"""The table of planners: every name leads to a planner, and the table costs no import."""

from pathlib import Path
import subprocess
import sys

from hnr_planner.core.planning import registry
from hnr_planner.core.planning.registry import ALGORITHMS, make_planner, PLANNERS
import pytest

ROOT = Path(registry.__file__).parents[3]
#: Loads the table from its file, as if the packages above it imported nothing.
ALONE = f"""
import sys, types
for name in ('hnr_planner', 'hnr_planner.core', 'hnr_planner.core.planning'):
    package = types.ModuleType(name)
    package.__path__ = ['{ROOT}/' + name.replace('.', '/')]
    sys.modules[name] = package
from hnr_planner.core.planning.registry import ALGORITHMS
print(len(ALGORITHMS), sorted({{'numpy', 'numba'}} & set(sys.modules)))
"""


def test_names_are_known_without_the_compiler():
    done = subprocess.run(
        [sys.executable, '-c', ALONE], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split(maxsplit=1) == [str(len(ALGORITHMS)), '[]\n']


@pytest.mark.parametrize('entry', PLANNERS, ids=lambda entry: entry.name)
def test_every_name_makes_a_planner_that_is_described_in_a_line(entry):
    planner = make_planner(entry.name, {})
    assert isinstance(planner, entry.load())
    assert entry.name in (planner.name, 'auto')
    assert 0 < len(entry.summary) < 100 and '\n' not in entry.summary


def test_names_are_listed_once():
    assert len(set(ALGORITHMS)) == len(ALGORITHMS)
