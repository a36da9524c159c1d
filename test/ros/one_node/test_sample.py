"""Draws of the free space by a real node: where they lie, how they are told, and how they fail."""

from collections.abc import Iterator
from test.brute_force import path_collisions
from test.ros.harness import (
    Client,
    free_map,
    grid_message,
    NodeProcess,
    points_in,
    pose,
    result_of,
)

from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest
from scipy import ndimage, stats
from std_srvs.srv import Trigger

#: Edges of cells are exact numbers in single precision: no rounding takes a point across.
RESOLUTION, ORIGIN = 0.0625, (-2.0, 1.0, 0.0)

ALPHA = 1e-6

#: What takes hours, and so ends by a cancellation or by the clock.
ENDLESS = {'sample_count': 1_000_000, 'sample_thin': 100_000, 'time_limit': 60.0}

USUAL = {
    'robot_radius': 0.0,
    'sample_count': 1000,
    'sample_radius': 0.0,
    'sample_thin': 1,
    'sample_walk': 'hit_and_run',
    'samples_max': 100_000,
    'seed': -1,
    'time_limit': 1.0,
}


def rooms() -> np.ndarray:
    """Return two rooms with a door, and a closed cupboard in a corner."""
    data = free_map(12, 20)
    data[:, 10] = 100
    data[5:8, 10] = 0
    data[8, 15:] = data[8:, 15] = 100
    return data


DATA = rooms()
PARTS, N_PARTS = ndimage.label(DATA == 0)


@pytest.fixture(scope='module', autouse=True)
def map_is_there(client: Client, planner: NodeProcess) -> None:
    """Ask once without a map, then publish the rooms."""
    answer = client.sample()
    assert not answer.success
    assert answer.message.startswith('NO_MAP: no map has arrived yet')
    assert client.outcome_of(answer)[0] is Outcome.NO_MAP
    client.publish_map(grid_message(DATA, RESOLUTION, ORIGIN))
    planner.wait_for('map received')


@pytest.fixture(autouse=True)
def usual_parameters(client: Client) -> Iterator[None]:
    """Set back what a test has set."""
    yield
    assert all(answer.successful for answer in client.set_parameters(**USUAL))


def drawn(client: Client, answer: Trigger.Response) -> np.ndarray:
    """Return the points (n, 2) of the cloud that belongs to an answer."""
    assert answer.success, answer.message
    points = points_in(client.stamped(client.clouds, answer))
    return np.stack([points['x'], points['y']], axis=1).astype(float)


def cells_of(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows and columns of the cells of points (n, 2)."""
    columns, rows = np.floor((points - ORIGIN[:2]) / RESOLUTION).astype(int).T
    return rows, columns


def over_cells(points: np.ndarray) -> float:
    """Return the p-value that points are uniform over the free cells, all parts of them."""
    counts = np.zeros(DATA.shape)
    np.add.at(counts, cells_of(points), 1)
    return float(stats.chisquare(counts[DATA == 0]).pvalue)


@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run'])
def test_draws_are_uniform_over_every_part_of_free_space(client: Client, walk: str) -> None:
    # 8,000 draws over 223 cells, 200 steps apart: the relaxation time of these rooms is 13
    # steps, so a draw depends on the one before by less than 1e-6. Were the seed not fixed, one
    # run in a million would fail.
    client.set_parameters(
        sample_count=8000, sample_thin=200, sample_walk=walk, seed=3, time_limit=60.0
    )
    points = drawn(client, client.sample())
    assert len(points) == 8000
    assert over_cells(points) > ALPHA
    rows, columns = cells_of(points)
    without_cupboard = points[PARTS[rows, columns] == PARTS[0, 0]]
    assert over_cells(without_cupboard) < ALPHA, 'so few points of a part would be seen'


def test_ball_walk_takes_steps_of_its_radius(client: Client) -> None:
    client.set_parameters(sample_walk='ball_walk', sample_radius=0.25, seed=2)
    answer = client.sample()
    points = drawn(client, answer)
    parents = points_in(client.stamped(client.clouds, answer))['parent']
    steps = (points - points[parents])[parents >= 0]
    assert 0.2 < np.hypot(*steps.T).max() < 0.25 + 1e-6


def test_ball_walk_that_finds_no_step_says_so(client: Client) -> None:
    client.set_parameters(sample_walk='ball_walk', sample_radius=1000.0, sample_thin=10)
    answer = client.sample()
    assert answer.message.startswith('BAD_REQUEST: ') and 'smaller radius' in answer.message


def test_draws_are_free_for_the_robot(client: Client) -> None:
    client.set_parameters(robot_radius=0.13, sample_count=300, seed=5)
    for point in drawn(client, client.sample()):
        assert not path_collisions(
            [point], DATA >= 65, RESOLUTION, ORIGIN, robot_radius=0.13
        )  # fmt: skip


def test_cloud_and_outcome_bear_the_stamp_of_the_answer_and_tell_all(client: Client) -> None:
    client.set_parameters(sample_count=400, seed=6)
    answer = client.sample()
    assert answer.message.startswith('SAMPLED: 400 draws by hit_and_run, seed 6 (stamp ')
    outcome, values = client.outcome_of(answer)
    assert outcome is Outcome.SAMPLED
    assert (values['algorithm'], values['seed']) == ('hit_and_run', '6')
    assert (int(values['samples']), int(values['parts'])) == (400, N_PARTS)
    assert int(values['iterations']) == 400 - N_PARTS
    cloud = client.stamped(client.clouds, answer)
    assert (cloud.width, cloud.header.frame_id) == (400, 'map')


def test_parent_is_the_draw_before_in_the_same_part(client: Client) -> None:
    client.set_parameters(sample_count=400, seed=6)
    answer = client.sample()
    parts = PARTS[cells_of(drawn(client, answer))]
    points = points_in(client.stamped(client.clouds, answer))
    assert points['index'].tolist() == list(range(400))
    last: dict[int, int] = {}
    for index, (part, parent) in enumerate(zip(parts, points['parent'], strict=True)):
        assert parent == last.get(part, -1)
        last[part] = index


def test_draws_more_than_a_step_apart_have_no_parents(client: Client) -> None:
    client.set_parameters(sample_thin=2)
    answer = client.sample()
    assert set(points_in(client.stamped(client.clouds, answer))['parent']) == {-1}


def test_same_seed_is_the_same_cloud_and_fresh_ones_differ(client: Client) -> None:
    fresh = client.sample()
    client.set_parameters(seed=int(client.outcome_of(fresh)[1]['seed']))
    assert np.array_equal(drawn(client, client.sample()), drawn(client, fresh))
    client.set_parameters(seed=-1)
    assert not np.array_equal(drawn(client, client.sample()), drawn(client, fresh))


def test_draws_are_all_published_whatever_a_search_may_show(client: Client) -> None:
    client.set_parameters(samples_max=10)
    assert len(drawn(client, client.sample())) == 1000


def test_path_and_markers_of_the_last_request_stay(client: Client) -> None:
    path = client.plan(pose(-1.9, 1.1), pose(-1.0, 1.2))
    client.stamped(client.markers, path)
    client.stamped(client.clouds, client.sample())
    after = client.plan(pose(-1.9, 1.1), pose(-1.0, 1.2))
    client.stamped(client.markers, after)
    for received in (client.paths, client.markers):
        assert len(received) >= 2
        assert received[-2] is client.stamped(received, path)


def test_time_limit_holds(client: Client) -> None:
    client.set_parameters(**ENDLESS | {'time_limit': 0.3})
    answer = client.sample()
    assert not answer.success
    assert answer.message.startswith('TIMEOUT: the time limit of 0.3 s passed before there were ')
    outcome, values = client.outcome_of(answer)
    assert outcome is Outcome.TIMEOUT
    assert float(values['elapsed']) >= 0.3
    assert client.stamped(client.clouds, answer).width == 0


def test_sampling_holds_up_nothing_and_can_be_cancelled(client: Client) -> None:
    client.set_parameters(**ENDLESS)
    futures = [client.send_sample() for _ in range(3)]
    client.wait_for_running(3)
    assert client.outcome_of(client.plan(pose(-1.9, 1.1), pose(-1.0, 1.2)))[0] is Outcome.SOLVED
    assert client.get_parameters('sample_thin') == [100_000]
    assert not any(future.done() for future in futures)
    assert client.cancel().message.startswith('3 running searches')
    for future in futures:
        answer = result_of(future)
        assert not answer.success
        assert answer.message.startswith('CANCELLED: ')
        assert client.outcome_of(answer)[0] is Outcome.CANCELLED


def test_map_without_a_free_cell_is_told(client: Client, planner: NodeProcess) -> None:
    """Stands last: it replaces the map of the other tests."""
    client.publish_map(grid_message(np.full((3, 4), 100, dtype=np.int8)))
    planner.wait_for('4 x 3 cells')
    answer = client.sample()
    assert not answer.success
    assert answer.message.startswith('BAD_REQUEST: nothing can be drawn of this map: no cell')
    assert client.outcome_of(answer)[0] is Outcome.BAD_REQUEST
