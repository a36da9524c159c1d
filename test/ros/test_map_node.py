"""The map source: publishes a file, changes it while running, refuses broken ones."""

from collections.abc import Iterator
from pathlib import Path
from test.fresh_python import run_and_list_imports
from test.ros.harness import (
    Client,
    from_corner,
    node_process,
    NodeProcess,
    pose,
    SOON,
    until,
)

from hnr_planner.maps import FREE, OccupancyMap, OCCUPIED, save_map
from hnr_planner.ros.messages.maps import map_from_message
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
import numpy as np
import pytest

ORIGIN = (-1.0, 2.0, 0.25)


def drawn(rows: int, cols: int, seed: int) -> OccupancyMap:
    """Return a map with some obstacles, turned and moved."""
    rng = np.random.default_rng(seed)
    data = np.where(rng.random((rows, cols)) < 0.1, OCCUPIED, FREE).astype(np.int8)
    data[:3, :3] = data[-3:, -3:] = FREE
    return OccupancyMap(data, 0.05, ORIGIN)


@pytest.fixture(scope='module')
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the YAML files of two maps and of a broken one."""
    folder = tmp_path_factory.mktemp('maps')
    paths = {name: folder / f'{name}.yaml' for name in ('first', 'second', 'broken')}
    save_map(drawn(30, 40, 1), paths['first'])
    save_map(drawn(20, 25, 2), paths['second'])
    good = paths['first'].read_text()
    paths['broken'].write_text(good.replace('resolution: 0.05', 'resolution: -0.05'))
    return paths


@pytest.fixture(scope='module')
def source(
    files: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[NodeProcess]:
    """Run a map source with the first map."""
    log = tmp_path_factory.mktemp('source') / 'log'
    with node_process('map_node', log, yaml_filename=files['first']) as process:
        yield process


@pytest.fixture(scope='module')
def client(source: NodeProcess) -> Iterator[Client]:
    """Return a client that hears maps, and does not publish any."""
    client = Client()
    client.node.destroy_publisher(client._map_publisher)
    yield client
    client.close()


def served(client: Client) -> OccupancyGrid:
    """Return the map that the service gives."""
    return client.call(GetMap, '/map_source/map', GetMap.Request()).map


def assert_is(message: OccupancyGrid, expected: OccupancyMap, frame: str = 'map') -> None:
    """Compare a message with a map."""
    grid = map_from_message(message)
    assert np.array_equal(grid.data, expected.data)
    assert grid.resolution == expected.resolution
    assert grid.origin == pytest.approx(expected.origin, abs=1e-12)
    assert grid.frame == frame


def test_map_is_latched_and_served(client: Client, source: NodeProcess) -> None:
    heard = client.listen(OccupancyGrid, '/map')
    until(lambda: heard, 'the latched map')
    assert_is(heard[0], drawn(30, 40, 1))
    assert_is(served(client), drawn(30, 40, 1))


def test_broken_file_is_refused_and_the_map_stays(client: Client, files: dict[str, Path]) -> None:
    for bad, word in ((files['broken'], 'resolution'), (files['first'].with_name('no'), 'no')):
        (answer,) = client.set_parameters('/map_source', yaml_filename=str(bad))
        assert not answer.successful
        assert bad.name in answer.reason and word in answer.reason
        assert_is(served(client), drawn(30, 40, 1))


def test_warning_about_a_file_is_a_line_of_the_log(
    client: Client, source: NodeProcess, files: dict[str, Path]
) -> None:
    twice = files['first'].with_name('twice.yaml')
    twice.write_text(files['first'].read_text() + 'resolution: 9.0\n')
    (answer,) = client.set_parameters('/map_source', yaml_filename=str(twice))
    assert answer.successful, answer.reason
    (line,) = [line for line in source.log.splitlines() if 'occurs repeatedly' in line]
    assert '[WARN]' in line and 'twice.yaml: the key resolution' in line
    assert 'MapFileWarning' not in source.log
    assert_is(served(client), drawn(30, 40, 1))


def test_file_and_frame_change_while_running(client: Client, files: dict[str, Path]) -> None:
    heard = client.listen(OccupancyGrid, '/map')
    (answer,) = client.set_parameters('/map_source', yaml_filename=str(files['second']))
    assert answer.successful, answer.reason
    until(lambda: heard and heard[-1].info.width == 25, 'the second map')
    assert_is(served(client), drawn(20, 25, 2))
    client.set_parameters('/map_source', frame_id='floor')
    until(lambda: heard[-1].header.frame_id == 'floor', 'the map in its new frame')
    assert_is(heard[-1], drawn(20, 25, 2), 'floor')
    client.set_parameters('/map_source', frame_id='map', yaml_filename=str(files['first']))


def test_planner_started_later_plans_on_it(client: Client, tmp_path: Path) -> None:
    with node_process('planner_node', tmp_path / 'log') as planner:
        planner.wait_for('map received')
        start, goal = from_corner(ORIGIN, 0.05, 0.05), from_corner(ORIGIN, 1.95, 1.45)
        assert len(client.plan(pose(*start), pose(*goal)).poses) > 2


@pytest.mark.parametrize(
    ('name', 'words'),
    [
        ('broken', 'resolution'),
        ('', '[map_source]: the parameter yaml_filename is empty: no map file is given\n'),
    ],
)
def test_broken_file_at_the_start_is_one_line_and_exit_code_1(
    tmp_path: Path, files: dict[str, Path], name: str, words: str
) -> None:
    chosen = {'yaml_filename': files[name]} if name else {}
    with node_process('map_node', tmp_path / 'log', '[FATAL]', **chosen) as process:
        assert process.popen.wait(SOON) == 1
        (line,) = process.log.splitlines(keepends=True)
        assert words in line and 'Traceback' not in line


def test_processes_that_plan_nothing_import_no_compiler() -> None:
    modules = 'hnr_planner.ros.node.map_node, hnr_planner.demo.client'
    _, packages = run_and_list_imports(f'import {modules}')
    assert packages.isdisjoint({'numba', 'llvmlite', 'scipy', 'matplotlib'})
