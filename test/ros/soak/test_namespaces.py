"""Two nodes in two namespaces side by side: each has its own map, answers and cancellations."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from test.ros.harness import (
    Client,
    grid_message,
    LATCHED,
    node_process,
    NodeProcess,
    result_of,
    until,
)
from test.ros.soak.callers import Caller, callers
from test.ros.soak.effort import EFFORT
from test.ros.soak.judge import SOLVED, World
from test.ros.soak.worlds import END, LONG, plan_request, requests, rooms, START
from typing import NamedTuple

from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
import numpy as np
import pytest

Tell = Callable[[str], None]


class Side(NamedTuple):
    """All that belongs to one namespace."""

    name: str
    node: NodeProcess
    client: Client
    caller: Caller

    def use(self, world: World) -> None:
        """Publish a map, and wait until the node has it."""
        received = self.node.log.count('map received')
        maps = self.client.node.create_publisher(OccupancyGrid, f'/{self.name}/map', LATCHED)
        maps.publish(grid_message(world.data, world.resolution))
        until(lambda: self.node.log.count('map received') > received, 'the map')


@contextmanager
def side(folder: Path, name: str) -> Iterator[Side]:
    """Run a node and its clients in a namespace."""
    remap, planner = ('-r', f'__ns:=/{name}'), f'/{name}/hnr_planner'
    settings = {'time_limit': 60.0, 'pose_spacing': 0.5}
    log = folder / name
    with node_process('planner_node', log, 'ready', *remap, **settings) as node:
        with callers(1, f'{planner}/plan') as (caller,):
            client = Client(planner)
            yield Side(name, node, client, caller)
            client.close()
        assert 'Traceback' not in node.log


@pytest.fixture
def sides(tmp_path: Path) -> Iterator[tuple[Side, Side]]:
    """Run both."""
    with side(tmp_path, 'left') as left, side(tmp_path, 'right') as right:
        yield left, right


def test_requests_are_answered_on_the_own_map(sides: tuple[Side, Side], tell: Tell) -> None:
    worlds = rooms(0), rooms(5)
    for own, world in zip(sides, worlds, strict=True):
        own.use(world)
    # Both get the same requests at the same time.
    seeds = [np.random.default_rng(4) for _ in sides]
    working = [
        own.caller.ask_all(requests(rng, EFFORT.requests))
        for own, rng in zip(sides, seeds, strict=True)
    ]
    for thread in working:
        thread.join()
    for own, world in zip(sides, worlds, strict=True):
        assert len(own.caller.answered) == EFFORT.requests
        for request, path, *_ in own.caller.answered:
            assert bool(path.poses) == (world.expected(request) == SOLVED)
            assert not path.poses or world.complaints(request, path) == []
            outcome = own.client.stamped(own.client.outcomes, path)
            assert outcome.status[0].name == f'/{own.name}/hnr_planner/plan'
        names = {message.status[0].name for message in own.client.outcomes}
        assert names == {f'/{own.name}/hnr_planner/plan'}
    tell(f'2 x {EFFORT.requests} requests')


@pytest.mark.sweep
def test_cancellation_is_for_the_own_searches(sides: tuple[Side, Side]) -> None:
    left, right = sides
    for own in sides:
        own.use(World(LONG, 0.05))
        # With auto, a flood fill would soon solve it.
        own.client.set_parameters(algorithm='hit_and_run', time_limit=60.0)
    futures = [own.caller.send(plan_request(START, END)) for own in sides]
    for own in sides:
        own.client.wait_for_running(1)
    assert left.client.cancel().message.startswith('1 running search')
    path = result_of(futures[0]).plan
    assert left.client.outcome_of(path)[0] is Outcome.CANCELLED
    assert not futures[1].done()
    assert right.client.cancel().message.startswith('1 running search')
