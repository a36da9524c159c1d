"""The parts of the demo that need no ROS: the scene, the check of paths, the processes."""

import math
from pathlib import Path
import signal
import socket
from test.brute_force import path_collisions
from test.cli.conftest import at, OFFICE, REAL_MAPS
import time

from hnr_planner.core import plan
from hnr_planner.demo.check import check_path
from hnr_planner.demo.processes import free_domain, Interruptions, ProcessError, Processes, Screen
from hnr_planner.demo.scene import choose_scene, farthest_cells, office_file, SceneError
from hnr_planner.maps import load_map, OccupancyMap, save_map
import numpy as np
import pytest


class TestCheck:
    """The demo's check of a path."""

    def test_agrees_with_the_other_checker(self) -> None:
        # Points on a lattice of half cells: many touch edges and corners exactly.
        rng = np.random.default_rng(1)
        found = {True: 0, False: 0}
        for trial in range(1000):
            data = np.where(rng.random((6, 7)) < 0.2, 100, 0).astype(np.int8)
            data[rng.random(data.shape) < 0.05] = -1
            origin = (-1.0, 2.0, (0.0, math.pi / 2, 0.3)[trial % 3])
            occupancy = OccupancyMap(data, 0.5, origin)
            cells = rng.integers(1, (13, 11), size=(2, 2)) / 2 - 0.5
            if ((cells % 1) == 0.5).all(axis=1).any():
                continue  # an end on a corner: rounding decides on which side of it
            path = np.array([at(occupancy, row, col) for col, row in cells])
            check = check_path(path, occupancy, (*path[0],), (*path[-1],))
            collisions = path_collisions(path, data != 0, 0.5, origin)
            assert bool(check.problems) == bool(collisions), (cells, data, check, collisions)
            found[bool(collisions)] += 1
        assert min(found.values()) > 100

    def test_clearance_is_the_distance_to_the_squares(self) -> None:
        # Against points close together on the path: they miss the least distance by half a step.
        rng, step = np.random.default_rng(2), 1e-4
        for _ in range(40):
            data = np.where(rng.random((20, 20)) < 0.03, 100, 0).astype(np.int8)
            a, b = path = rng.uniform(0.1, 1.9, size=(2, 2))
            share = np.linspace(0, 1, round(math.dist(a, b) / step) + 2)[:, None]
            points = a + share * (b - a)
            least = math.inf
            for row, col in np.argwhere(data):
                low = np.array([col, row]) * 0.1
                off = np.maximum(np.maximum(low - points, points - low - 0.1), 0)
                least = min(least, np.linalg.norm(off, axis=1).min())
            check = check_path(path, OccupancyMap(data, 0.1), (*a,), (*b,))
            assert check.clearance == least or least - step < check.clearance <= least + 1e-12
            assert check.length == pytest.approx(math.dist(a, b))

    def test_diagonal_obstacles_let_nothing_through(self) -> None:
        data = np.array([[0, 100], [100, 0]], dtype=np.int8)
        occupancy = OccupancyMap(data, 1.0)
        path = np.array([[0.5, 0.5], [1.5, 1.5]])
        (problem,) = check_path(path, occupancy, (0.5, 0.5), (1.5, 1.5)).problems
        assert 'share a corner' in problem

    def test_seam_between_obstacles_is_closed(self) -> None:
        data = np.zeros((4, 5), dtype=np.int8)
        data[:, 2] = 100
        path = np.array([[0.5, 2.0], [4.5, 2.0]])
        assert check_path(path, OccupancyMap(data, 1.0), (0.5, 2.0), (4.5, 2.0)).problems

    @pytest.mark.parametrize(
        ('path', 'words'),
        [
            ([], 'no path'),
            ([[0.1, 0.5], [0.9, 0.5]], 'starts'),
            ([[0.2, 0.5], [0.8, 0.5]], 'ends'),
            ([[0.2, 0.5], [0.5, 1.5], [0.9, 0.5]], 'leaves the map'),
            ([[0.2, 0.5], [math.nan, 0.5], [0.9, 0.5]], 'not finite'),
            ([[0.2, 0.5], [0.2, 0.95], [0.9, 0.5]], 'comes within'),
        ],
    )
    def test_each_fault_is_named(self, path: list[list[float]], words: str) -> None:
        data = np.zeros((10, 10), dtype=np.int8)
        data[9, 2] = 100
        points = np.array(path).reshape(-1, 2)
        check = check_path(
            points, OccupancyMap(data, 0.1), (0.2, 0.5), (0.9, 0.5), robot_radius=0.25
        )
        assert any(words in problem for problem in check.problems), check


class TestScene:
    """The request that the demo chooses."""

    def test_office_is_found_and_fits_the_robot(self) -> None:
        assert office_file() == OFFICE
        scene = choose_scene(OFFICE)
        assert scene.robot_radius == 0.22
        assert math.dist(scene.start, scene.goal) > 10.0
        assert scene.space.connected(scene.start, scene.goal)

    def test_office_is_found_where_it_is_installed(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        file = tmp_path / 'share' / 'hnr_planner' / 'config' / 'maps' / 'office.yaml'
        file.parent.mkdir(parents=True)
        file.write_text(OFFICE.read_text())
        package = tmp_path / 'lib' / 'python3.12' / 'site-packages' / 'hnr_planner'
        monkeypatch.setattr('hnr_planner.demo.scene.__file__', str(package / 'demo' / 'scene.py'))
        assert office_file() == file

    @pytest.mark.parametrize('file', REAL_MAPS, ids=lambda file: file.name)
    def test_real_map_has_a_scene_that_can_be_solved(self, file: Path) -> None:
        scene = choose_scene(file)
        path = plan(scene.space, scene.start, scene.goal, time_limit=20.0, seed=1).path
        check = check_path(
            path, scene.occupancy, scene.start, scene.goal, robot_radius=scene.robot_radius
        )
        assert check.problems == ()

    def test_far_apart_is_along_the_way_not_through_the_wall(self) -> None:
        free = np.zeros((30, 30), dtype=bool)
        free[2:28, 2:28] = True
        free[:20, 14:16] = False  # two arms, joined at the high rows
        first, last = farthest_cells(free)
        assert max(first[0], last[0]) < 10
        assert {first[1] < 14, last[1] < 14} == {True, False}

    @pytest.mark.parametrize('width', [1, 2, 5])
    def test_corridor_has_its_ends_far_apart(self, width: int) -> None:
        free = np.zeros((width + 2, 50), dtype=bool)
        free[1:-1, 1:-1] = True
        first, last = farthest_cells(free)
        assert abs(first[1] - last[1]) > 35
        assert free[tuple(first)] and free[tuple(last)]

    def test_where_the_robot_is_stuck_a_point_drives(self, tmp_path: Path) -> None:
        data = np.full((40, 40), 100, dtype=np.int8)
        data[18:21, 2:38] = 0  # a corridor of 0.3 m
        save_map(OccupancyMap(data, 0.1), tmp_path / 'narrow.yaml')
        assert choose_scene(tmp_path / 'narrow.yaml').robot_radius == 0.0

    def test_cells_larger_than_the_robot_are_planned_for_a_point(self, tmp_path: Path) -> None:
        file = tmp_path / 'city.map'
        file.write_text('type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n')
        assert choose_scene(file).robot_radius == 0.0

    def test_map_without_free_space_is_refused(self, solid_file: Path) -> None:
        with pytest.raises(SceneError, match=r'solid\.yaml: .*no free space'):
            choose_scene(solid_file)

    def test_ends_are_free_on_a_turned_map(self, rooms_file: Path) -> None:
        scene, rooms = choose_scene(rooms_file), load_map(rooms_file)
        assert scene.space.contains([scene.start, scene.goal]).all()
        assert path_collisions([scene.start], rooms.data != 0, 0.1, rooms.origin) == []


class TestProcesses:
    """Processes are shown, watched and ended."""

    @pytest.fixture
    def processes(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Processes:
        """Return processes that find the modules ``stubborn``, ``brief`` and ``patient``."""
        ignore = 'import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)\n'
        wait = 'print("up", flush=True)\nimport time\ntime.sleep(60)\n'
        (tmp_path / 'stubborn.py').write_text(ignore + wait)
        (tmp_path / 'patient.py').write_text(wait)
        (tmp_path / 'brief.py').write_text('import sys; print("bye"); sys.exit(3)\n')
        monkeypatch.setenv('PYTHONPATH', str(tmp_path))
        return Processes(Screen(), Interruptions(), 1, tmp_path)

    def test_end_of_a_process_is_noticed(
        self, processes: Processes, capsys: pytest.CaptureFixture[str]
    ) -> None:
        processes.start('thing', 'brief', [])
        with pytest.raises(ProcessError, match='the thing ended with exit code 3'):
            processes.wait_for('thing', 30.0, 'waiting')
        processes.stop()
        assert 'thing    bye' in capsys.readouterr().out

    def test_death_of_another_is_noticed_while_waiting(self, processes: Processes) -> None:
        processes.start('node', 'brief', [])
        processes.start('thing', 'patient', [])
        with pytest.raises(ProcessError, match='the node died with exit code 3'):
            processes.wait_for('thing', 30.0, 'waiting')
        processes.stop()

    def test_a_process_that_takes_too_long_is_given_up(self, processes: Processes) -> None:
        processes.start('client', 'patient', [])
        with pytest.raises(ProcessError, match='not done after 1 s'):
            processes.wait_for('client', 1.0, 'waiting')
        assert processes.stop() == []

    def test_a_process_that_does_not_listen_is_killed(
        self,
        processes: Processes,
        capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        monkeypatch.setattr('hnr_planner.demo.processes.END_WITHIN', 0.5)
        processes.start('node', 'stubborn', [])
        running = processes._running['node']
        shown, deadline = '', time.monotonic() + 30.0
        while 'up' not in shown and time.monotonic() < deadline:
            shown += capsys.readouterr().out
            time.sleep(0.05)
        (complaint,) = processes.stop()
        assert 'killed' in complaint
        assert running.returncode == -signal.SIGKILL

    def test_interruption_waits_until_a_process_is_known(self) -> None:
        interruptions, reached = Interruptions(), []
        with interruptions.caught():
            with pytest.raises(KeyboardInterrupt):
                with interruptions.held():
                    signal.raise_signal(signal.SIGINT)
                    reached.append('the end of the block')
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGTERM)
        assert reached

    def test_domain_in_use_is_not_taken(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr('random.shuffle', lambda domains: domains.sort())
        first = free_domain()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
            taken.bind(('', 7410 + 250 * first))
            assert free_domain() > first
