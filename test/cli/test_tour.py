"""The command ``tour``."""

import json
import math
from pathlib import Path
from test.brute_force import path_collisions
from test.cli.conftest import at, Ran

from hnr_planner.maps import OccupancyMap
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('compiled')
#: Cells of two rooms, from room to room and back.
STOPS = ((5, 5), (8, 75), (30, 10), (12, 60))


def stops(rooms: OccupancyMap, *cells: tuple[int, int]) -> list[object]:
    """Return the argument ``--stops`` for cells of the map."""
    return ['--stops', *(number for cell in cells for number in at(rooms, *cell))]


def test_json_holds_the_order_and_a_free_path(run, rooms: OccupancyMap, rooms_file: Path) -> None:
    ran: Ran = run('tour', rooms_file, *stops(rooms, *STOPS), '--json')
    assert (ran.code, ran.err) == (0, '')
    found = json.loads(ran.out)
    assert found['order'] == [0, 2, 3, 1]
    path = found['path']
    assert path[0] == list(at(rooms, *STOPS[0])) and path[-1] == list(at(rooms, *STOPS[1]))
    assert found['length'] == pytest.approx(sum(map(math.dist, path[:-1], path[1:])))
    assert path_collisions(np.array(path), rooms.data >= 65, 0.1, rooms.origin) == []


def test_a_closed_tour_returns_and_is_drawn(
    run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    picture = tmp_path / 'tour.png'
    ran = run('tour', rooms_file, *stops(rooms, *STOPS), '--closed', '--plot', picture)
    assert ran.code == 0 and picture.stat().st_size > 1000
    assert ran.out.startswith('tour        ') and 'through 4 stops' in ran.out
    one = json.loads(run('tour', rooms_file, *stops(rooms, *STOPS), '--closed', '--json').out)
    assert one['path'][0] == one['path'][-1]


def test_a_stop_out_of_reach_is_no_success(run, rooms: OccupancyMap, rooms_file: Path) -> None:
    arguments = stops(rooms, (5, 5), (35, 75))
    ran = run('tour', rooms_file, *arguments)
    assert ran.code == 1 and 'cannot be reached' in ran.out
    found = json.loads(run('tour', rooms_file, *arguments, '--json').out)
    assert found['length'] is None and found['path'] == []


def test_bad_stops_are_refused(run, rooms: OccupancyMap, rooms_file: Path) -> None:
    ran = run('tour', rooms_file, '--stops', 1, 2, 3)
    assert ran.code == 2 and 'takes two numbers for each stop, X and Y, got 3 numbers' in ran.err
    ran = run('tour', rooms_file, *stops(rooms, (5, 5), (0, 0)))
    assert ran.code == 2 and 'row 1 of points' in ran.err
