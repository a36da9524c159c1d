"""A running node in a real browser: what it shows, clicks that plan, and how it ends."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import signal
import socket
import subprocess
import sys
from test.browser import ActionChains, BrowserPage, Keys, open_browser
from test.brute_force import path_collisions
from test.ros.harness import (
    Client,
    grid_message,
    node_process,
    NodeProcess,
    points_of,
    pose,
    two_rooms,
    until,
)
from test.watch.reader import read
from typing import Any

from hnr_planner.ros.messages.paths import path_message
from hnr_planner.watch.reading import read_path
import numpy as np
import pytest
from rclpy.serialization import serialize_message
from std_msgs.msg import Header
from tornado.websocket import websocket_connect

DATA = two_rooms()
START, GOAL = (0.5, 0.6), (4.5, 0.7)
#: Colour of the path.
PATH = '#D55E00'


@contextmanager
def watching(*arguments: str) -> Iterator[str]:
    """Run the command ``watch`` and return the address of its page."""
    command = [sys.executable, '-m', 'hnr_planner', 'watch', '--port', '0', *arguments]
    pipes = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE}
    process = subprocess.Popen(command, **pipes, text=True)
    try:
        assert process.stdout is not None
        yield process.stdout.readline().split()[0]
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20.0)
        assert (process.returncode, errors) == (0, '')
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope='module')
def browser() -> Iterator[Any]:
    with open_browser() as driver:
        yield driver


@pytest.fixture(scope='module')
def site(planner: NodeProcess, client: Client) -> Iterator[str]:
    """Return the address of a page that may plan, for a node that has a map."""
    client.publish_map(grid_message(DATA))
    planner.wait_for('map received')
    with watching('--allow-requests') as address:
        yield address


@pytest.fixture
def page(browser: Any, site: str) -> Iterator[LivePage]:
    page = LivePage(browser, site)
    page.wait(lambda: 'runs' in page.text('#state'))
    page.wait(lambda: page.run('return data.map !== null'))
    yield page
    assert page.errors() == []


class LivePage(BrowserPage):
    """The page of a running node."""

    def run(self, script: str) -> Any:
        return self.browser.execute_script(script)

    def status(self) -> str:
        return self.text('#outcome b') if self.find('#outcome').is_displayed() else ''

    def path(self) -> np.ndarray:
        return np.array(self.run('return searches[0].path'))

    def click(self, x: float, y: float) -> None:
        """Click a point of the map [m]."""
        right, down = self.run(
            f'return [({x} - view.x) * view.scale, -({y} - view.y) * view.scale]'
        )
        move = ActionChains(self.browser).move_to_element_with_offset
        move(self.find('#view'), right, down).click().perform()


def test_a_plan_is_on_screen_with_its_samples_and_its_outcome(
    page: LivePage, client: Client
) -> None:
    planned = client.plan(pose(*START), pose(*GOAL), 'plan_hit_and_run')
    positions = [(p.pose.position.x, p.pose.position.y) for p in planned.poses]
    page.wait(
        lambda: page.status() == 'SOLVED' and page.run('return searches[0].parents.length > 1')
    )
    assert page.path() == pytest.approx(np.array(positions), abs=1e-6)
    _, values = client.outcome_of(planned)
    assert page.text('#why') == values['why']
    assert page.run('return searches[0].parents.length') == int(values['samples'])
    assert 'plan_hit_and_run' in page.text('#outcome small')
    page.find('#outcome summary').click()
    assert values['seed'] in page.text('#values')
    page.go_to(Keys.END)
    for layer in ('samples', 'tree'):
        before = page.pixels()
        page.find(f'#layers [name="{layer}"]').click()
        assert not np.array_equal(page.pixels(), before)
    assert page.has(PATH)
    page.find('#layers [name="path"]').click()
    assert not page.has(PATH)


def test_a_search_unfolds_under_its_path(page: LivePage, client: Client) -> None:
    page.run("document.getElementById('unfold').checked = true; calmAt = 0")
    planned = client.plan(pose(*START), pose(*GOAL), 'plan_rrt')
    stamp = f'{planned.header.stamp.sec}.{planned.header.stamp.nanosec:09d}'
    page.wait(lambda: page.run('return searches[0]?.stamp') == stamp and page.time() < 1000)
    page.go_to(Keys.HOME)
    assert page.text('#now') == '1 sample' and page.has(PATH)
    page.find('#play').click()
    page.wait(lambda: page.time() == 1000)


def test_clicks_set_a_start_and_a_goal_and_plan(page: LivePage, client: Client) -> None:
    answered = len(client.outcomes)
    page.find('#set-start').click()
    page.click(1.0, 4.0)
    page.click(4.0, 1.0)
    until(lambda: len(client.outcomes) > answered, 'the outcome of a click')
    stamp = client.outcomes[-1].header.stamp
    shown = f'{stamp.sec}.{stamp.nanosec:09d}'
    page.wait(lambda: page.run('return searches[0]?.stamp') == shown)
    assert page.status() == 'SOLVED' and page.text('#reply') == ''
    path = page.path()
    assert path[[0, -1]] == pytest.approx(np.array([(1.0, 4.0), (4.0, 1.0)]), abs=0.02)
    published = points_of(client.paths[-1])
    assert path == pytest.approx(published, abs=1e-6)
    assert not path_collisions(published, DATA == 100, 0.05)
    # A further click plans to another goal; one in the wall fails in words.
    page.click(2.5, 1.0)
    page.wait(lambda: page.status() == 'INVALID_GOAL')
    assert 'goal' in page.text('#why')
    assert page.run('return data.goal')[0] == pytest.approx(2.5, abs=0.02)


def test_the_map_changes_on_screen_and_so_does_the_word_on_the_path(
    page: LivePage, client: Client
) -> None:
    client.plan(pose(*START), pose(*GOAL))
    page.wait(lambda: page.status() == 'SOLVED')
    before = page.pixels()
    closed = DATA.copy()
    closed[:, 49:51] = 100
    client.publish_map(grid_message(closed))
    page.wait(lambda: 'MAP_CHANGED' in page.text('#notice'))
    page.wait(lambda: not np.array_equal(page.pixels(), before))
    client.plan(pose(*START), pose(*GOAL))
    page.wait(lambda: page.status() == 'UNREACHABLE')
    assert page.text('#notice') == '' and not page.has(PATH)
    client.publish_map(grid_message(DATA))


def test_another_viewer_sees_the_same_at_once(page: LivePage, site: str, client: Client) -> None:
    client.plan(pose(*START), pose(*GOAL))
    page.wait(lambda: page.status() == 'SOLVED')

    async def look() -> dict[str, dict[str, Any]]:
        seen: dict[str, dict[str, Any]] = {}
        other = await websocket_connect(f'{site.replace("http", "ws")}live')
        while not {'node', 'map', 'search', 'samples'} <= seen.keys():
            message = await asyncio.wait_for(other.read_message(), 20.0)
            assert isinstance(message, bytes)
            header, _ = read(message)
            seen[header['kind']] = header
        other.close()
        return seen

    seen = asyncio.run(look())
    assert seen['search']['stamp'] == page.run('return searches[0].stamp')
    assert seen['node'] == {'kind': 'node', 'name': '/hnr_planner', 'runs': True, 'blobs': []}


@pytest.mark.usefixtures('site')  # it brings the map
def test_a_page_outlives_nodes_and_ends_with_the_node_that_serves_it(
    browser: Any, tmp_path: Path
) -> None:
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    arguments = ('-r', '__ns:=/robot', '-r', 'map:=/map')
    runs, gone = '/robot/hnr_planner runs; to look at only', '/robot/hnr_planner does not run'
    with watching('--node', 'robot/hnr_planner', '--map', '/map') as address:
        page = LivePage(browser, address)
        page.wait(lambda: page.text('#state') == gone)
        taken = int(address.rstrip('/').rpartition(':')[2])
        parameters = {'watch_port': taken}
        with node_process(
            'planner_node', tmp_path / 'first', 'map received', *arguments, **parameters
        ) as first:
            first.wait_for(f'watch_port: error: port {taken} of 127.0.0.1 cannot be served')
            page.wait(lambda: page.text('#state') == runs)
            robot = Client('/robot/hnr_planner')
            robot.plan(pose(*START), pose(*GOAL))
            page.wait(lambda: page.status() == 'SOLVED')
            robot.close()
        page.wait(lambda: page.text('#state') == gone)
        second = NodeProcess('planner_node', tmp_path / 'second', {'watch_port': port}, *arguments)
        try:
            second.wait_for(f'http://127.0.0.1:{port}/ shows /robot/hnr_planner')
            page.wait(lambda: page.text('#state') == runs)
            assert page.errors() == []
            page = LivePage(browser, f'http://127.0.0.1:{port}/')
            page.wait(lambda: page.text('#state') == runs)
            page.wait(lambda: page.run('return data.map !== null'))
            assert not page.find('#request').is_displayed()
            assert page.errors() == []
        finally:
            second.popen.kill()
        until(lambda: not is_open(port), 'an end of the page')


def is_open(port: int) -> bool:
    with socket.socket() as attempt:
        return attempt.connect_ex(('127.0.0.1', port)) == 0


def test_a_port_that_is_taken_is_named_on_one_line() -> None:
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        done = subprocess.run(
            [sys.executable, '-m', 'hnr_planner', 'watch', '--port', str(port)],
            capture_output=True,
            text=True,
            timeout=60.0,
        )
    assert done.returncode == 2
    assert done.stderr.startswith(f'error: port {port} of 127.0.0.1 cannot be served')
    assert done.stderr.count('\n') == 1


@pytest.mark.parametrize('frame', ['', 'm', 'map', 'odom', 'robot/map', 'a' * 9])
def test_paths_are_read_as_rclpy_reads_them(frame: str) -> None:
    generator = np.random.default_rng(len(frame))
    for n_poses in (0, 1, 2, 5):
        rows = generator.normal(size=(n_poses, 7))
        path = path_message(rows, Header(frame_id=frame))
        path.header.stamp.sec, path.header.stamp.nanosec = 12, 34
        for other in ('', 'x' * n_poses):  # poses in a frame of their own are read, too
            if path.poses:
                path.poses[0].header = Header(frame_id=frame + other)
            stamp, points = read_path(serialize_message(path))
            assert stamp == (12, 34)
            assert np.array_equal(points, rows[:, :2].astype(np.float32))
