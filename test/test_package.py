"""The package: its metadata, the layers of imports, and what is installed."""

import ast
from collections.abc import Iterator
from distutils.core import run_setup  # with setuptools, also on Python 3.12
from functools import cache
import importlib.util
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
from test.sweeps import sweep
from typing import Any
import xml.etree.ElementTree as ElementTree

from hnr_planner.cli.extras import EXTRAS
import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / 'hnr_planner'
MODULES = {
    path.relative_to(ROOT).with_suffix('').as_posix().replace('/', '.').removesuffix('.__init__')
    for path in PACKAGE.rglob('*.py')
}

#: The layers, the lowest first: a module imports from its own layer and those below. The first
#: name that a module's name begins with is its layer. CONTRIBUTING.md describes them.
LAYERS = (
    'hnr_planner.core.errors',
    'hnr_planner.core.cancellation',
    'hnr_planner.core.checks',
    'hnr_planner.core.kernels',
    'hnr_planner.core.lengths',
    'hnr_planner.core.trees',
    'hnr_planner.core.spaces',
    'hnr_planner.core.systems',
    'hnr_planner.core.sampling',
    'hnr_planner.core.theory',
    'hnr_planner.core.planning',
    'hnr_planner.core.trajectories',
    'hnr_planner.core',
    'hnr_planner.maps',
    'hnr_planner.server.parameters',
    'hnr_planner.server.geometry',
    'hnr_planner.server.requests',
    'hnr_planner.server.map',
    'hnr_planner.server.responses',
    'hnr_planner.server.validity',
    'hnr_planner.server.routes',
    'hnr_planner.server.planning',
    'hnr_planner.server',
    'hnr_planner.drawing',
    'hnr_planner.experiments',
    'hnr_planner.page',
    'hnr_planner.ros',
    'hnr_planner.demo',
    'hnr_planner.watch',
    'hnr_planner.cli',
    'hnr_planner.__main__',
)
#: The layers below ROS.
BELOW_ROS = LAYERS[: LAYERS.index('hnr_planner.ros')]
#: What a robot runs: only what these import is required of every installation.
OF_A_ROBOT = tuple(f'hnr_planner.{name}' for name in ('core', 'maps', 'server', 'ros'))

#: What a library is called on PyPI, and by rosdep.
ON_PYPI = {'PIL': 'pillow', 'cv2': 'opencv-python-headless', 'yaml': 'pyyaml'}
IN_ROSDEP = {
    'PIL': 'python3-pil',
    'cv2': 'python3-opencv',
    'numpy': 'python3-numpy',
    'scipy': 'python3-scipy',
    'shapely': 'python3-shapely',
    'yaml': 'python3-yaml',
}
#: rosdep has a key for numba, but Ubuntu 24.04 no package; it has neither for arviz. Tests in a
#: browser are skipped where selenium is missing, tests of a cluster where Dask is.
NOT_IN_ROSDEP = {'arviz', 'dask', 'distributed', 'numba', 'selenium'}
#: Imported by one function only, for those who have it.
OPTIONAL = {'arviz', 'joblib'}
#: What joblib's back end for Dask imports.
OF_A_CLUSTER = {'dask', 'distributed'}


@cache
def imports(path: Path) -> list[str]:
    """Return the full name of every module that a file imports, wherever in it."""
    folder = path.parent.relative_to(ROOT).parts
    found: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(), str(path))):
        if isinstance(node, ast.Import):
            found.extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = folder[: len(folder) + 1 - node.level] if node.level else ()
            base = '.'.join([*above, *filter(None, [node.module])])
            for alias in node.names:
                full = f'{base}.{alias.name}'
                found.append(full if full in MODULES else base)
    return found


def source(module: str) -> Path:
    path = ROOT.joinpath(*module.split('.'))
    return path / '__init__.py' if path.is_dir() else path.with_suffix('.py')


def layer(module: str) -> int:
    """Return the height of a module's layer; that of the package itself, which all may import."""
    if module == 'hnr_planner':
        return -1
    for height, name in enumerate(LAYERS):
        if module == name or module.startswith(f'{name}.'):
            return height
    pytest.fail(f'{module} is in no layer: add its layer to LAYERS')


def libraries(*paths: Path) -> set[str]:
    roots = {name.partition('.')[0] for path in paths for name in imports(path)}
    return roots - set(sys.stdlib_module_names) - {'hnr_planner'}


def is_in(module: str, layers: tuple[str, ...]) -> bool:
    return any(module == layer or module.startswith(f'{layer}.') for layer in layers)


def libraries_of(layers: tuple[str, ...]) -> set[str]:
    """Return the libraries, those of ROS aside, that the modules of some layers import."""
    found = libraries(*(source(module) for module in MODULES if is_in(module, layers)))
    return {name for name in found if not is_ros(name)}


def on_pypi(libraries: set[str]) -> set[str]:
    return {ON_PYPI.get(name, name) for name in libraries}


def names(requirements: list[str]) -> set[str]:
    return {re.split('[<>=[]', requirement)[0] for requirement in requirements}


def is_ros(library: str) -> bool:
    of_messages = library.endswith(('_msgs', '_srvs', '_interfaces'))
    return of_messages or library in ('bond', 'bondpy', 'launch', 'launch_ros', 'rclpy', 'tf2_ros')


def installed(distribution: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield each folder below the prefix with the files of ours that are installed there."""
    for folder, files in distribution.data_files:
        assert all((ROOT / file).is_file() for file in files), folder
        yield folder, files


def run(command: list[str], **settings: Any) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, **settings)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


@pytest.fixture
def distribution(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(ROOT)
    return run_setup('setup.py', stop_after='init')


@pytest.fixture(scope='module')
def manifest() -> ElementTree.Element:
    return ElementTree.parse(ROOT / 'package.xml').getroot()


# -- metadata


def test_both_manifests_agree(distribution: Any, manifest: ElementTree.Element) -> None:
    metadata, maintainer = distribution.metadata, manifest.find('maintainer')
    assert maintainer is not None
    assert metadata.name == manifest.findtext('name')
    assert metadata.version == manifest.findtext('version')
    assert metadata.license == manifest.findtext('license')
    assert metadata.maintainer == maintainer.text
    assert metadata.maintainer_email == maintainer.get('email')


def test_pip_requirements_are_what_a_robot_imports(distribution: Any) -> None:
    declared = names(distribution.install_requires)
    assert declared == on_pypi(libraries_of(OF_A_ROBOT) - OPTIONAL)


@pytest.mark.parametrize(
    ('extra', 'layers'),
    [
        ('plot', ('hnr_planner.drawing', 'hnr_planner.page', 'hnr_planner.demo')),
        ('experiments', ('hnr_planner.drawing', 'hnr_planner.experiments')),
        ('watch', ('hnr_planner.drawing', 'hnr_planner.page', 'hnr_planner.watch')),
    ],
)
def test_an_extra_is_what_its_layers_import_besides(
    distribution: Any, extra: str, layers: tuple[str, ...]
) -> None:
    needed = libraries_of(layers) - (libraries_of(OF_A_ROBOT) - OPTIONAL) - OF_A_CLUSTER
    assert names(distribution.extras_require[extra]) == on_pypi(needed)
    assert set(EXTRAS[extra]) == needed
    assert names(distribution.extras_require['cluster']) == set(EXTRAS['cluster']) == OF_A_CLUSTER


def test_commands_themselves_need_no_extra() -> None:
    assert libraries_of(('hnr_planner.cli', 'hnr_planner.__main__')) <= libraries_of(OF_A_ROBOT)


def test_rosdep_keys_are_what_a_robot_imports(manifest: ElementTree.Element) -> None:
    declared = {element.text for element in manifest.iter('exec_depend')}
    robot = [source(module) for module in MODULES if is_in(module, OF_A_ROBOT)]
    imported = libraries(*robot, *ROOT.glob('launch/*.py')) - NOT_IN_ROSDEP - OPTIONAL
    assert declared == {IN_ROSDEP.get(name, name) for name in imported}


def test_requirements_of_the_tests_are_what_they_import_besides(
    distribution: Any, manifest: ElementTree.Element
) -> None:
    imported = {name for name in libraries(*ROOT.glob('test/**/*.py')) if not is_ros(name)}
    imported -= libraries(*map(source, MODULES)) - OPTIONAL
    imported -= {'benchmarks', 'distutils', 'test', 'xdist'}  # xdist is among the tools
    tools = {'colcon-common-extensions', 'pytest-xdist', 'setuptools'}
    declared = names(distribution.extras_require['test'])
    assert declared == imported | tools
    assert set(distribution.extras_require) >= OPTIONAL
    of_extras = {library for extra in EXTRAS.values() for library in extra}
    keys = {f'python3-{name}' for name in (imported | of_extras) - NOT_IN_ROSDEP}
    assert {element.text for element in manifest.iter('test_depend')} == keys


def test_every_console_script_is_there(distribution: Any) -> None:
    scripts = distribution.entry_points['console_scripts']
    called = {line.split(' = ')[0] for line in scripts}
    assert called == {'hnr-planner', 'map_node', 'planner_node'}
    for line in scripts:
        module, function = line.split(' = ')[1].split(':')
        tree = ast.parse(source(module).read_text())
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert function in defined, line


def test_data_files_hold_what_ros_looks_for(distribution: Any) -> None:
    files = {
        folder: {Path(name).name for name in names} for folder, names in installed(distribution)
    }
    assert files['share/ament_index/resource_index/packages'] == {'hnr_planner'}
    assert files['share/hnr_planner'] == {'package.xml'}
    assert 'planner.launch.py' in files['share/hnr_planner/launch']
    assert 'hnr_planner.yaml' in files['share/hnr_planner/config']
    assert any(name.endswith('.yaml') for name in files['share/hnr_planner/config/maps'])
    assert files['lib/hnr_planner'] == {'map_node', 'planner_node'}
    assert all(os.access(path, os.X_OK) for path in ROOT.glob('scripts/*'))


# -- layers


def test_imports_run_downwards() -> None:
    upwards = [
        f'{module} imports {name}'
        for module in sorted(MODULES - {'hnr_planner'})
        for name in imports(source(module))
        if name.startswith('hnr_planner.') and layer(name) > layer(module)
    ]
    assert not upwards


def test_the_package_itself_imports_the_core_only() -> None:
    assert {name for name in imports(source('hnr_planner')) if 'hnr_planner' in name} == {
        'hnr_planner.core'
    }


def test_contributing_has_the_same_layers() -> None:
    text = (ROOT / 'CONTRIBUTING.md').read_text()
    rows = re.findall(r'^\| (`.*?`) \|', text.partition('| layer |')[2], re.MULTILINE)
    listed = [name for row in rows for name in re.findall('`(.*?)`', row)]
    modules = [name.removesuffix('.py').rstrip('/').replace('/', '.') for name in listed]
    assert [f'hnr_planner.{name}' for name in modules] == list(LAYERS[::-1])


def test_maps_import_nothing_of_the_core_but_its_errors() -> None:
    names = {name for path in PACKAGE.glob('maps/**/*.py') for name in imports(path)}
    assert {name for name in names if name.startswith('hnr_planner.core')} <= {
        'hnr_planner.core.errors'
    }


@pytest.mark.parametrize('name', BELOW_ROS)
def test_layers_below_ros_import_no_ros(name: str) -> None:
    modules = [module for module in MODULES if LAYERS[layer(module)] == name]
    assert modules
    for module in modules:
        assert not [library for library in libraries(source(module)) if is_ros(library)], module


@pytest.mark.parametrize('layer_name', [sweep('core'), sweep('maps'), 'server'])
def test_it_runs_where_there_is_no_ros(layer_name: str) -> None:
    program = f"""
import importlib, sys
sys.path.insert(0, {str(ROOT)!r})

class NoRos:
    def find_spec(self, name, path=None, target=None):
        root = name.partition('.')[0]
        if root.endswith(('_msgs', '_srvs', '_interfaces')) or root in ('rclpy', 'launch'):
            raise ModuleNotFoundError(f'there is no {{name}} here')

sys.meta_path.insert(0, NoRos())
for name in ('rclpy', 'nav_msgs.msg'):
    try:
        importlib.import_module(name)
    except ModuleNotFoundError:
        continue
    sys.exit(f'{{name}} could be imported: this program proves nothing')

for name in {sorted(name for name in MODULES if name.startswith(f'hnr_planner.{layer_name}'))!r}:
    importlib.import_module(name)

from hnr_planner import GridSpace, plan
space = GridSpace.from_blocked([[False, False], [False, False]])
print(plan(space, (0.5, 0.5), (1.5, 1.5), seed=1, time_limit=float('inf')).status.name)
"""
    done = run([sys.executable, '-c', program])
    assert done.stdout.split() == ['SOLVED']


def test_launch_file_describes_its_nodes() -> None:
    pytest.importorskip('launch_ros', reason='launch and launch_ros come with a ROS from apt only')
    spec = importlib.util.spec_from_file_location('planner', ROOT / 'launch/planner.launch.py')
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    entities = module.generate_launch_description().entities
    names = {entity.node_executable for entity in entities if hasattr(entity, 'node_executable')}
    assert names == {'map_node', 'planner_node', 'rviz2'}


# -- installation


@pytest.fixture
def colcon(tmp_path: Path) -> list[str]:
    """Return colcon's command; the sources are copied, since a build leaves traces in them."""
    places = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get('PATH', '')])
    command = shutil.which('colcon', path=places)
    if command is None:
        pytest.skip('colcon is not installed')
    # With a space in it, as a workspace may have.
    workspace = tmp_path / 'a workspace'
    traces = shutil.ignore_patterns('.*', '__pycache__', '*.egg-info', 'build', 'install', 'log')
    shutil.copytree(ROOT, workspace / 'src' / 'hnr_planner', ignore=traces)
    return [command, '--log-base', str(workspace / 'log')]


def test_colcon_takes_it_for_a_ros_package(colcon: list[str], tmp_path: Path) -> None:
    done = run([*colcon, 'list'], cwd=tmp_path / 'a workspace')
    assert done.stdout.split() == ['hnr_planner', 'src/hnr_planner', '(ros.ament_python)']


@pytest.mark.parametrize('how', [[], sweep(['--symlink-install'])], ids=['copied', 'linked'])
def test_colcon_installs_all_of_it(
    colcon: list[str], how: list[str], tmp_path: Path, distribution: Any
) -> None:
    workspace = tmp_path / 'a workspace'
    run([*colcon, 'build', *how], cwd=workspace)
    prefix = workspace / 'install' / 'hnr_planner'

    for folder, names in installed(distribution):
        for name in names:
            there = prefix / folder / Path(name).name
            if folder.startswith('lib/'):
                assert os.access(there, os.X_OK)
            else:
                assert there.read_bytes() == (ROOT / name).read_bytes()

    # Seen through the workspace's own setup file, every module is there and none is the clone's.
    # That file cannot start a Python whose path has a space in it.
    python = tmp_path / 'python'
    python.symlink_to(sys.executable)
    program = (
        'import hnr_planner, pathlib; root = pathlib.Path(hnr_planner.__file__).parent; '
        'print(root, *(path.relative_to(root.parent) for path in root.rglob("*.py")), sep="\\n")'
    )
    done = run(
        ['bash', '-c', 'source install/setup.bash; "$0" -P -c "$1"', sys.executable, program],
        cwd=workspace,
        env={**os.environ, 'COLCON_PYTHON_EXECUTABLE': str(python)},
    )
    where, *files = done.stdout.splitlines()
    assert Path(where).is_relative_to(workspace)
    assert set(files) == {path.relative_to(ROOT).as_posix() for path in PACKAGE.rglob('*.py')}
    other, installed_other = (
        {
            path.relative_to(root)
            for path in root.rglob('*.*')
            if path.suffix not in ('.py', '.pyc')
        }
        for root in (PACKAGE, Path(where))
    )
    assert {Path('py.typed'), Path('__init__.pyi'), Path('page/page.html')} <= other
    assert other == installed_other
