"""Where a path is blocked on a newer map."""

from dataclasses import replace
import math
from pathlib import Path
import re
from test.server.test_requests import GOAL, rooms, store
import time

from hnr_planner.maps import load_map
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.parameters.settings import DEFAULTS
from hnr_planner.server.validity.path_validity import first_blocked_pose, judge_path
import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parents[2]

#: Seconds: far less than a loop in Python would take.
SLACK = 5.0


def test_free_path_is_blocked_nowhere() -> None:
    path = np.array([(0.5, 0.5), (1.5, 1.05), (3.5, 1.05)])
    assert first_blocked_pose(path, 'map', store(rooms()).newest()) is None


def test_first_blocked_pose_is_where_the_path_meets_the_obstacle() -> None:
    path = np.array([(0.5, 0.5), (0.5, 1.5), (3.5, 1.5)])
    pose = first_blocked_pose(path, 'map', store(rooms()).newest())
    # The wall begins at x = 1.9 m.
    assert pose == pytest.approx((1.9, 1.5, 0.0))
    turned = first_blocked_pose(path[:, ::-1], 'map', store(rooms().T.copy()).newest())
    assert turned == pytest.approx((1.5, 1.9, math.pi / 2.0))


def test_path_that_begins_in_an_obstacle_is_blocked_there() -> None:
    path = np.array([(2.0, 0.25), (3.5, 0.25)])
    assert first_blocked_pose(path, 'map', store(rooms()).newest()) == (2.0, 0.25, 0.0)
    stays = np.array([(2.0, 0.25), (2.0, 0.25)])
    assert first_blocked_pose(stays, 'map', store(rooms()).newest()) == (2.0, 0.25, 0.0)


def test_path_in_another_frame_is_blocked_from_its_first_pose() -> None:
    path = np.array([(0.5, 0.5), (0.5, 1.5)])
    assert first_blocked_pose(path, 'odom', store(rooms()).newest()) == (0.5, 0.5, math.pi / 2.0)


def test_long_path_is_held_against_a_map_at_once() -> None:
    newest = store(rooms()).newest()
    path = np.tile([(0.5, 0.5), (0.5, 1.5)], (1_000_000, 1))
    began = time.thread_time()  # that of this thread alone: other work does not count
    assert first_blocked_pose(path, 'map', newest) is None
    path[-1] = GOAL
    assert first_blocked_pose(path, 'map', newest) is not None
    assert time.thread_time() - began < SLACK


@pytest.mark.parametrize('radius', [0.0, 0.22])
def test_example_of_the_page_is_valid_on_its_map(radius: float) -> None:
    page = (ROOT / 'msg_docs' / 'is_path_valid.md').read_text()
    (example,) = re.findall(r'ros2 service call /is_path_valid \S+ "(.*)"', page)
    path = yaml.safe_load(example)['path']
    positions = [pose['pose']['position'] for pose in path['poses']]
    points = np.array([(position['x'], position['y']) for position in positions])
    (file,) = re.findall(r'`(config/maps/\S+)`', page)
    occupancy = load_map(ROOT / file)
    maps = MapStore(replace(DEFAULTS, robot_radius=radius))
    snapshot = maps.receive(lambda: occupancy)
    assert judge_path(points, path['header']['frame_id'], snapshot, None) == ([], '')
