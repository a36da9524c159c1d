"""Hostile maps and requests: each refusal is named, no path is wrong, and the node stays up."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from test.ros.harness import Client, node_process, NodeProcess, until
from test.ros.soak.callers import callers
from test.ros.soak.effort import EFFORT
from test.ros.soak.hostile import Generator
from test.ros.soak.judge import SOLVED, World

from hnr_planner.ros.messages.maps import map_from_message
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan

REQUESTS_A_MAP = 10


def test_hostile_maps_and_requests(tmp_path: Path, tell: Callable[[str], None]) -> None:
    generator, ended, maps = Generator(seed=3), Counter[str](), Counter[bool]()
    settings = {'time_limit': 30.0, 'pose_spacing': 0.0}
    with node_process('planner_node', tmp_path / 'log', **settings) as planner:
        client = Client()
        with callers(1) as (caller,):
            world = None
            while ended.total() < EFFORT.hostile:
                message = generator.occupancy()
                accepted = publish(client, planner, message)
                maps[accepted] += 1
                world = world_of(message) if accepted else world
                if world is None:
                    continue
                for _ in range(REQUESTS_A_MAP):
                    request = generator.request(world)
                    path = caller.ask(request).path
                    outcome = client.outcome_of(path)[0].name
                    ended[outcome] += 1
                    check(world, request, path, outcome)
        client.close()
        assert planner.popen.poll() is None
        assert 'Traceback' not in planner.log and 'INTERNAL_ERROR' not in planner.log
    tell(
        f'{maps[True]} maps taken, {maps[False]} refused; {ended.total()} requests: {dict(ended)}'
    )


def publish(client: Client, planner: NodeProcess, message: OccupancyGrid) -> bool:
    """Send a map and return whether the node takes it; each gets one line on its log."""
    taken, refused = planner.log.count('map received'), planner.log.count('map refused')
    client.publish_map(message)

    def seen() -> bool:
        return planner.log.count('map received') + planner.log.count('map refused') > (
            taken + refused
        )

    until(seen, 'a word about a map')
    return planner.log.count('map received') > taken


def world_of(message: OccupancyGrid) -> World:
    """Return a map that was taken, for the judge."""
    grid = map_from_message(message)
    return World(grid.data, grid.resolution, grid.origin, grid.frame)


def check(world: World, request: GetPlan.Request, path: PathMessage, outcome: str) -> None:
    """Hold an answer to what the judge says."""
    expected, moved = world.expected(request), False
    if request.tolerance > 0.0 and expected in ('INVALID_GOAL', 'UNREACHABLE'):
        moved = outcome == SOLVED
        expected = outcome if moved else expected
    assert outcome == expected, request
    assert bool(path.poses) == (outcome == SOLVED)
    if path.poses:
        wrong = world.complaints(request, path)
        assert [words for words in wrong if not (moved and words.startswith('the goal'))] == []
