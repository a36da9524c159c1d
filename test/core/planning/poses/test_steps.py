"""Steps of a search among poses that aim at no pose."""

from test.core.planning.poses.test_plan_poses import GOAL, hall, START
from test.core.planning.poses.test_words import DRIVES, RADIUS

from hnr_planner.core.planning.poses.request import check_pose_request, ROOM
from hnr_planner.core.planning.poses.search import PoseSearch
from hnr_planner.core.planning.poses.trees import Proposals
import numpy as np
import pytest

#: Steps of each search, and the least number of vertices that they have to add.
N_STEPS, N_LEAST = 20, 20
STROKES, HIT_AND_RUN = Proposals(0.0, 0.0, 1.0, False, 2), Proposals(0.0, 0.0, 0.0, False, 2)


@pytest.mark.interpreted
@pytest.mark.parametrize('drive', ['car', 'car ahead', 'differential', 'differential ahead'])
def test_strokes_of_a_robot_that_must_not_reverse_lead_ahead(drive):
    space = hall(**DRIVES[drive])
    search = _search(space, STROKES)
    ahead = _ahead(search.samples, search.parents)
    assert len(ahead) >= N_LEAST
    # A robot that may reverse does so in strokes: the measure sees it.
    assert (ahead.min() >= -1e-9) != space.drive.reverse


@pytest.mark.interpreted
@pytest.mark.parametrize('proposals', [STROKES, HIT_AND_RUN])
@pytest.mark.parametrize('drive', ['car', 'car ahead'])
def test_a_car_that_must_not_reverse_gets_on_from_every_vertex(drive, proposals):
    space = hall(**DRIVES[drive])
    search = _search(space, proposals)
    poses, added = space.from_kernel(search.samples), search.parents >= 0
    assert added.sum() >= N_LEAST // 2
    room = ROOM * RADIUS
    distances = np.array(
        [
            _distance_on(space, poses[row], _root(search.parents, row) == 0)
            for row in np.flatnonzero(added)
        ]
    )
    # A car that may reverse stops close to walls as well: the measure sees it.
    assert (distances.min() >= room - 1e-9) != space.drive.reverse


def _search(space, proposals):
    """Return a search without a guide after ``N_STEPS`` transitions."""
    request = check_pose_request(
        space, START, GOAL, algorithm='auto', goal_radius=0.0, simplify=True, seed=1
    )
    no_guide = np.empty((0, 3))
    search = PoseSearch(
        request.problem(no_guide, space.disc),
        proposals,
        space.to_kernel(request.ends()),
        request.stream(0),
        lambda turn, stuck: no_guide,
    )
    search.advance(N_STEPS)
    return search


def _distance_on(space, pose, is_ahead):
    """Return how far [m] a car gets on from a pose, straight or at full lock, ahead or back."""
    bends = (-1.0 / RADIUS, 0.0, 1.0 / RADIUS)
    return max(space.chord(pose, (1.0 if is_ahead else -1.0, 0.0, bend)).upper for bend in bends)


def _root(parents, row):
    """Return the row of the root that a vertex was reached from."""
    while parents[row] >= 0:
        row = parents[row]
    return row


def _ahead(poses, parents):
    """Return how far ahead the robot drives (k,) [cells] from or to the parent of each vertex."""
    distances = []
    for row in np.flatnonzero(parents >= 0):
        # The goal's tree leads away from the goal, and is driven back.
        a, b = (parents[row], row) if _root(parents, row) == 0 else (row, parents[row])
        dx, dy = poses[b, :2] - poses[a, :2]
        # Along an arc of less than half a turn, the sign is that of the direction of driving.
        middle = poses[a, 2] + (poses[b, 2] - poses[a, 2] + np.pi) % (2.0 * np.pi) / 2.0
        middle -= np.pi / 2.0
        distances.append(dx * np.cos(middle) + dy * np.sin(middle))
    return np.array(distances)
