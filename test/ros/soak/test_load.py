"""Many clients at once, and maps that come while they plan."""

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from statistics import median
from test.ros.harness import (
    Client,
    grid_message,
    MANY,
    node_process,
    NodeProcess,
    points_of,
    stamp_of,
    until,
)
from test.ros.soak.callers import Answered, callers
from test.ros.soak.effort import EFFORT
from test.ros.soak.judge import SOLVED, World
from test.ros.soak.worlds import across, hall, requests, rooms
import threading
import time

from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.srv import GetPlan
import numpy as np
import pytest

Tell = Callable[[str], None]
N_CLIENTS, N_PLANNING = 8, 4
LARGEST_GROWTH = 0.05
MAPS_A_SECOND = 5.0

#: Seconds for which a map may be in use after the next one was sent, on a busy machine.
LONGEST_USE = 5.0


@pytest.fixture
def planner(tmp_path: Path) -> Iterator[NodeProcess]:
    """Run a planning node; a request may take long on a busy machine, but none times out."""
    settings = {
        'time_limit': 30.0,
        'pose_spacing': 0.5,
        'clearance': 0.2,
        'alternatives': 2,
        'roadmap': True,
        'keep_route': 0.1,
    }
    with node_process('planner_node', tmp_path / 'log', **settings) as process:
        yield process
        assert 'Traceback' not in process.log


@pytest.fixture
def client(planner: NodeProcess) -> Iterator[Client]:
    """Return the client that publishes maps and hears outcomes."""
    client = Client()
    yield client
    client.close()


def test_every_request_of_many_clients_is_answered_rightly(
    client: Client, planner: NodeProcess, tell: Tell
) -> None:
    """A judge says what each answer has to be; the node's memory does not grow meanwhile."""
    world = rooms()
    client.publish_map(grid_message(world.data, world.resolution))
    planner.wait_for('map received')
    outcomes = client.listen(DiagnosticArray, '/hnr_planner/outcome', MANY)
    with callers(N_CLIENTS) as asking:
        # What is allocated once, by each of the node's threads too, is no growth.
        run(asking, 20, seed=0)
        for caller in asking:
            caller.answered.clear()
        began = time.monotonic()
        memory = run(asking, EFFORT.requests, seed=1, planner=planner)
        seconds = time.monotonic() - began
    answered = [one for caller in asking for one in caller.answered]
    assert len(answered) == N_CLIENTS * EFFORT.requests

    stamps = {stamp_of(one.path) for one in answered}
    until(lambda: stamps <= {stamp_of(m) for m in list(outcomes)}, 'an outcome for each answer')
    told = {stamp_of(message): message.status[0].message for message in outcomes}
    expected = [world.expected(one.request) for one in answered]
    assert [told[stamp_of(one.path)] for one in answered] == expected
    assert [bool(one.path.poses) for one in answered] == [name == SOLVED for name in expected]
    assert [words for one in answered for words in complaints(world, one)] == []

    fifth = max(len(memory) // 5, 1)
    first, last = median(memory[:fifth]), median(memory[-fifth:])
    times = [1e3 * (one.answered - one.sent) for one in answered]
    tell(
        f'{len(answered)} requests in {seconds:.0f} s, {dict(Counter(expected))}; answered in '
        f'{median(times):.0f} ms (p95 {np.quantile(times, 0.95):.0f}); memory '
        f'{first / 2**20:.1f} -> {last / 2**20:.1f} MiB'
    )
    assert last < (1.0 + LARGEST_GROWTH) * first


def run(asking: list, n_requests: int, seed: int, planner: NodeProcess | None = None) -> list[int]:
    """Let all clients ask; return the node's memory [bytes] every tenth of a second meanwhile."""
    seeds = np.random.SeedSequence(seed).spawn(len(asking))
    working = [
        caller.ask_all(requests(np.random.default_rng(own), n_requests))
        for caller, own in zip(asking, seeds, strict=True)
    ]
    memory = []
    while any(thread.is_alive() for thread in working):
        if planner is not None:
            memory.append(resident(planner.popen.pid))
        time.sleep(0.1)
    return memory


def resident(pid: int) -> int:
    """Return the memory of a process that is in use [bytes]."""
    pages = int(Path(f'/proc/{pid}/statm').read_text().split()[1])
    return pages * 4096


def complaints(world: World, one: Answered) -> list[str]:
    """Return what is wrong with the path of an answer, if it has one."""
    return world.complaints(one.request, one.path) if one.path.poses else []


@pytest.mark.sweep
def test_paths_are_right_while_maps_arrive(
    client: Client, planner: NodeProcess, tell: Tell
) -> None:
    """
    Each path is free on a map that may have been the newest when it was answered.

    The route of a client that asks for the same again and again does not change its side.
    """
    sent: list[tuple[float, World]] = []
    done = threading.Event()

    def publish() -> None:
        for moment in count():
            sent.append((time.monotonic(), hall(moment)))
            client.publish_map(grid_message(sent[-1][1].data, sent[-1][1].resolution))
            if done.wait(1.0 / MAPS_A_SECOND):
                break

    publishing = threading.Thread(target=publish, daemon=True)
    publishing.start()
    planner.wait_for('map received')
    with callers(N_PLANNING) as asking:
        ending = time.monotonic() + EFFORT.seconds
        seeds = np.random.SeedSequence(2).spawn(N_PLANNING)
        working = [
            caller.ask_all(until_time(ending, np.random.default_rng(own), across(number)))
            for number, (caller, own) in enumerate(zip(asking, seeds, strict=True))
        ]
        for thread in working:
            thread.join()
    done.set()
    publishing.join()
    answered = [one for caller in asking for one in caller.answered]
    wrong = [one for one in answered if not right_on_some(sent, one)]
    sides = [[above for one in caller.answered for above in side_of(one)] for caller in asking]
    prepared = planner.log.count('map received')
    tell(
        f'{len(answered)} requests while {len(sent)} maps came in {EFFORT.seconds:.0f} s, '
        f'{prepared} of them prepared; {sum(bool(one.path.poses) for one in answered)} paths; '
        f'sides of routes that stay: {[len(side) for side in sides]} answers'
    )
    assert wrong == []
    assert all(len(set(side)) <= 1 for side in sides)
    assert any(sides)


def until_time(ending: float, rng: np.random.Generator, same: GetPlan.Request) -> Iterator:
    """Yield a request again and again, and random ones between, until a time."""
    while time.monotonic() < ending:
        yield same
        yield from requests(rng, 1)


def side_of(one: Answered) -> list[bool]:
    """Return whether the path of an answer passes above the island; nothing for others."""
    if all(one.request != across(number) for number in range(N_PLANNING)):
        return []
    points = points_of(one.path)
    middle = int(np.argmin(abs(points[:, 0] - 4.0)))
    return [bool(points[middle, 1] > 4.0)]


def right_on_some(sent: list[tuple[float, World]], one: Answered) -> bool:
    """Return whether an answer is right on one of the maps that may have been in use."""
    after = [*(when for when, _ in sent[1:]), np.inf]
    in_use = [
        world
        for (when, world), next_came in zip(sent, after, strict=True)
        if when < one.answered and next_came > one.sent - LONGEST_USE
    ]
    # The newest first: most often that is it.
    return any(right_on(world, one) for world in reversed(in_use))


def right_on(world: World, one: Answered) -> bool:
    """Return whether an answer is right on a map."""
    solvable = world.expected(one.request) == SOLVED
    return solvable == bool(one.path.poses) and complaints(world, one) == []
