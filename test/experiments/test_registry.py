"""The registry lists every experiment once, and is read without numerical libraries."""

from pathlib import Path
import pkgutil
from test.fresh_python import run_and_list_imports

from hnr_planner import experiments
from hnr_planner.experiments import EXPERIMENTS, NAMES
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_the_registry_is_read_without_numerical_libraries() -> None:
    program = 'from hnr_planner.experiments.registry import EXPERIMENTS\nprint(*EXPERIMENTS)'
    printed, packages = run_and_list_imports(program)
    assert printed.split() == list(NAMES)
    assert packages.isdisjoint({'numpy', 'numba', 'matplotlib', 'joblib', 'scipy'})


def test_every_module_with_an_experiment_is_listed() -> None:
    (folder,) = experiments.__path__
    defined = {
        f'hnr_planner.experiments.{module.name}'
        for module in pkgutil.iter_modules([folder])
        if 'EXPERIMENT = ' in source(Path(folder) / module.name)
    }
    assert {entry.module for entry in EXPERIMENTS.values()} == defined
    assert len(EXPERIMENTS) == len(defined)


def source(module: Path) -> str:
    """Return the text of a module or of a package's first file."""
    file = module / '__init__.py' if module.is_dir() else module.with_suffix('.py')
    return file.read_text(encoding='utf-8')


@pytest.mark.parametrize('name', NAMES)
def test_pages_show_the_summary(name: str) -> None:
    numbers = (ROOT / 'docs' / 'figures' / f'{name}.md').read_text(encoding='utf-8')
    assert numbers.startswith(f'# {name}\n\n{EXPERIMENTS[name].summary}\n')
