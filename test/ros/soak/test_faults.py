"""What goes wrong around the node, and the node itself killed: whoever is left goes on."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
import signal
import subprocess
import sys
from test.ros.harness import (
    Client,
    grid_message,
    node_process,
    NodeProcess,
    SOON,
    until,
)
from test.ros.soak.callers import Caller, callers
from test.ros.soak.effort import EFFORT
from test.ros.soak.judge import World
from test.ros.soak.worlds import END, LONG, plan_request, rooms, START
from test.ros.transitions import change, state, WAY_TO
import time

import numpy as np
import pytest

Tell = Callable[[str], None]
N_WAITING = 4

#: A request in the rooms that has a path wherever the doors are.
ACROSS = plan_request((1.5, 1.5), (7.0, 7.0))

#: A request that is answered at once where others take long.
SHORT = plan_request(START, START)


@contextmanager
def client_of(planner: NodeProcess, world: World | None = None) -> Iterator[Client]:
    """Return a client, once the node has the map that it publishes."""
    client = Client()
    if world is not None:
        client.publish_map(grid_message(world.data, world.resolution))
        planner.wait_for('map received')
    yield client
    client.close()


def test_map_source_that_dies_is_survived_and_one_that_comes_back_is_heard(
    tmp_path: Path, tell: Tell
) -> None:
    taken = []
    with node_process('planner_node', tmp_path / 'log') as planner, callers(1) as (caller,):
        for door in range(2 * EFFORT.rounds):
            world = rooms(door)
            file = map_file(tmp_path, world)
            began = time.monotonic()
            with node_process('map_node', tmp_path / 'source', yaml_filename=file) as source:
                until(lambda n=door: planner.log.count('map received') == n + 1, 'the next map')
                taken.append(time.monotonic() - began)
                source.popen.kill()
                source.popen.wait(SOON)
            for _ in range(3):
                path = caller.ask(ACROSS).path
                assert path.poses and world.complaints(ACROSS, path) == []
        assert 'Traceback' not in planner.log
    tell(f'{len(taken)} times killed and started; map there {max(taken):.1f} s later at most')


def map_file(folder: Path, world: World) -> Path:
    """Write a map for the map source: an image with its top row first, and its description."""
    rows, columns = world.data.shape
    pixels = np.where(world.data[::-1] == 100, 0, 254).astype(np.uint8)
    (folder / 'map.pgm').write_bytes(b'P5 %d %d 255\n' % (columns, rows) + pixels.tobytes())
    file = folder / 'map.yaml'
    file.write_text(
        f'image: map.pgm\nresolution: {world.resolution}\norigin: [0.0, 0.0, 0.0]\n'
        'negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n'
    )
    return file


@pytest.mark.sweep
def test_node_that_is_killed_leaves_clients_that_can_ask_the_next_one(
    tmp_path: Path, tell: Tell
) -> None:
    taken = []
    with callers(N_WAITING) as asking:
        for _ in range(EFFORT.rounds):
            with searching(tmp_path, asking) as (planner, futures):
                planner.popen.kill()
                planner.popen.wait(SOON)
                began = time.monotonic()
                with node_process('planner_node', tmp_path / 'next') as heir:
                    heir.wait_for('map received')
                    for caller in asking:
                        assert len(caller.ask_again_until_answered(SHORT).poses) == 2
                    taken.append(time.monotonic() - began)
                    assert 'Traceback' not in heir.log
                assert not any(future.done() for future in futures)
    tell(
        f'{N_WAITING} clients, {len(taken)} times: answered by the next node '
        f'{max(taken):.1f} s after the kill at most'
    )


@pytest.mark.sweep
def test_clients_that_vanish_leave_the_node_to_others(tmp_path: Path, tell: Tell) -> None:
    count = 0
    with (
        callers(1) as (other,),
        searching(tmp_path, [], time_limit=5.0) as (planner, _),
    ):
        other.ask_again_until_answered(SHORT)
        with client_of(planner) as client:
            for _ in range(EFFORT.rounds):
                client.wait_for_running(0)
                with vanishing(N_WAITING) as client_process:
                    client.wait_for_running(N_WAITING)
                    client_process.kill()
                    count += N_WAITING
                began = time.monotonic()
                assert len(other.ask(SHORT).path.poses) == 2
                answered = time.monotonic() - began
            client.wait_for_running(0)
        assert planner.end(signal.SIGTERM) == 0
        assert 'Traceback' not in planner.log
    tell(f'{count} requests left behind; the next one answered in {1e3 * answered:.0f} ms')


@contextmanager
def vanishing(n_requests: int) -> Iterator[subprocess.Popen]:
    """Start a client in a process of its own that has asked for what takes long."""
    command = [sys.executable, '-m', 'test.ros.soak.vanishing', str(n_requests)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == 'asked\n'
            yield process
        finally:
            process.kill()


@contextmanager
def searching(
    folder: Path, asking: list[Caller], time_limit: float = 60.0
) -> Iterator[tuple[NodeProcess, list]]:
    """Run a node that searches for each of some callers, and return the futures of theirs."""
    # With auto, a flood fill would soon solve it.
    settings = {'time_limit': time_limit, 'algorithm': 'hit_and_run'}
    with node_process('planner_node', folder / 'log', **settings) as planner:
        with client_of(planner, World(LONG, 0.05)) as client:
            for caller in asking:
                caller.ask_again_until_answered(SHORT)
            futures = [caller.send(plan_request(START, END)) for caller in asking]
            client.wait_for_running(len(futures))
            yield planner, futures


@pytest.mark.sweep
@pytest.mark.parametrize('where', [*(WAY_TO if EFFORT.rounds > 1 else ()), 'searching'])
def test_end_is_prompt_in_every_state(tmp_path: Path, where: str, tell: Tell) -> None:
    """
    How prompt is a figure to be read: a test does not judge the speed of the machine.

    What else holds in each state without a search is tested with the life cycle.
    """
    taken = []
    for _ in range(EFFORT.rounds):
        if where == 'searching':
            with (
                callers(3) as asking,
                searching(tmp_path, asking) as (planner, _),
            ):
                taken.append(time_to_end(planner))
        else:
            with node_process('planner_node', tmp_path / 'log', autostart=False) as planner:
                with client_of(planner) as client:
                    change(client, *WAY_TO[where])
                    assert state(client) == where
                    taken.append(time_to_end(planner))
    tell(f'{len(taken)} times SIGTERM, exit code 0 after {max(taken):.2f} s at most')


def time_to_end(planner: NodeProcess) -> float:
    """Send SIGTERM, hold the end to an orderly one and return how long it took [s]."""
    began = time.monotonic()
    assert planner.end(signal.SIGTERM) == 0, planner.log
    taken = time.monotonic() - began
    assert 'Traceback' not in planner.log
    return taken
