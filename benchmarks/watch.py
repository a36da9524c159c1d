"""
Measure the page that shows a running node: ``python -m benchmarks.watch [--quick]``.

A real node plans on the office map, and a real browser without a screen shows it. Measured are the
time from a response until the page has drawn its path, and what the node pays for a page that
looks: the CPU time of its process for a request, without and with a page in turns. It needs
chromium and its driver. ``--picture FILE`` keeps a picture of the page.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
import os
from pathlib import Path
from statistics import median
import subprocess
import sys
from tempfile import TemporaryDirectory
from test.browser import BrowserPage, open_browser
from test.ros.domain import own_domain
from test.ros.harness import node_process, pose, SOON
import time
from typing import Any

from benchmarks.answer_cost import cost_of
from benchmarks.sections import Verdict, verdict_table
from hnr_planner.core.kernels import modes
from nav_msgs.srv import GetPlan
import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

OFFICE = Path(__file__).parents[1] / 'config' / 'maps' / 'office.yaml'
#: Ends of the requests [m]: through the whole floor, some of them by another way.
ENDS = (((3.0, 22.0), (34.0, 5.0)), ((34.0, 22.0), (3.0, 5.0)), ((20.0, 6.5), (3.0, 22.0)))
#: Requests with the page open, and turns without and with it; requests in each turn.
N_SHOWN, N_TURNS, N_EACH = 200, 20, 10
N_SHOWN_QUICK, N_TURNS_QUICK = 40, 6
#: Time [s] between requests.
PAUSE = 0.25
#: Targets: time [s] from a response to its path on the screen, 95 of 100 times; CPU time of the
#: node with a page as a multiple of that without.
MOST_TIME, MOST_COST = 0.15, 1.05

#: Notes, for each request, when its path was drawn [ms since 1970]: the frame after the drawing.
NOTE = """
window.drawn = {};
const drawAll = draw;
draw = () => {
  drawAll();
  const stamp = searches[0]?.stamp;
  if (stamp === undefined || window.drawn[stamp]) return;
  window.drawn[stamp] = Infinity;
  requestAnimationFrame(() => {
    window.drawn[stamp] = performance.timeOrigin + performance.now();
  });
};
"""


def main() -> None:
    """Measure, and print the verdicts."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.watch', description=__doc__)
    parser.add_argument('--quick', action='store_true', help='less, for a look')
    parser.add_argument('--picture', type=Path, help='a picture of the page to write (.png)')
    arguments = parser.parse_args()
    os.environ.setdefault(modes.VARIABLE, modes.Mode.COMPILED.value)
    with TemporaryDirectory() as folder, own_domain() as domain:
        os.environ |= {
            'ROS_DOMAIN_ID': str(domain),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
            'ROS_LOG_DIR': folder,
        }
        with _nodes(Path(folder)) as (pid, client, address), open_browser() as browser:
            page = BrowserPage(browser, address)
            page.wait(lambda: browser.execute_script('return data.map !== null'))
            if arguments.picture is not None:
                _picture(browser, client, arguments.picture)
            n_shown = N_SHOWN_QUICK if arguments.quick else N_SHOWN
            n_turns = N_TURNS_QUICK if arguments.quick else N_TURNS
            verdicts = [_on_screen(page, client, n_shown)]
            verdicts.append(_cost(page, client, address, pid, n_turns))
            client.close()
    print(verdict_table(verdicts))


@contextmanager
def _nodes(folder: Path) -> Iterator[tuple[int, Caller, str]]:
    """Run a planning node with a map and its page; yield its process, a client, the address."""
    settings = {'robot_radius': 0.22}
    with (
        node_process('planner_node', folder / 'planner', **settings) as planner,
        node_process('map_node', folder / 'map', yaml_filename=OFFICE),
        subprocess.Popen(
            [sys.executable, '-m', 'hnr_planner', 'watch', '--port', '0', '--allow-requests'],
            stdout=subprocess.PIPE,
            text=True,
        ) as watch,
    ):
        try:
            planner.wait_for('map received')
            assert watch.stdout is not None
            yield planner.popen.pid, Caller(), watch.stdout.readline().split()[0]
        finally:
            watch.terminate()


class Caller:
    """A client that subscribes to nothing: the node makes no pictures for it."""

    def __init__(self) -> None:
        """Take part in ROS, in a context of its own."""
        self._context = Context()
        rclpy.init(context=self._context)
        self._node = Node('caller', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._clients: dict[str, Any] = {}

    def close(self) -> None:
        """End the client."""
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Call a service of the planning node and return its response."""
        if name not in self._clients:
            self._clients[name] = self._node.create_client(kind, f'/hnr_planner/{name}')
            assert self._clients[name].wait_for_service(SOON)
        future = self._clients[name].call_async(request)
        deadline = time.monotonic() + SOON
        while not future.done() and time.monotonic() < deadline:
            self._executor.spin_once(SOON)
        return future.result()

    def plan(self, number: int, service: str = 'plan') -> Any:
        """Request a path between a pair of ``ENDS`` and return it."""
        start, goal = ENDS[number % len(ENDS)]
        return self.call(
            GetPlan, service, GetPlan.Request(start=pose(*start), goal=pose(*goal))
        ).plan


def _on_screen(page: BrowserPage, client: Caller, n_requests: int) -> Verdict:
    """Measure the time from a response at the client until the page has drawn its path."""
    page.browser.execute_script(NOTE)
    answered = {}
    for number in range(n_requests):
        path = client.plan(number)
        answered[f'{path.header.stamp.sec}.{path.header.stamp.nanosec:09d}'] = time.time()
        time.sleep(PAUSE)
    time.sleep(1.0)
    drawn = page.browser.execute_script('return window.drawn')
    delays = [drawn[stamp] / 1e3 - at for stamp, at in answered.items() if stamp in drawn]
    missed = len(answered) - len(delays)
    middle, most = np.percentile(delays, [50, 95])
    return Verdict(
        f'time from a response until its path is on the screen, {n_requests} requests',
        f'95 % within {1e3 * MOST_TIME:.0f} ms',
        f'median {1e3 * middle:.0f} ms, 95 % within {1e3 * most:.0f} ms, {missed} not shown',
        most <= MOST_TIME and missed == 0,
    )


def _cost(page: BrowserPage, client: Caller, address: str, pid: int, n_turns: int) -> Verdict:
    """Measure the CPU time of the node for a request, without and with the page, in turns."""
    # For each turn, the mean cost of a request, without and with the page.
    costs: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(n_turns):
        for looks in (False, True):
            page.browser.get(address if looks else 'about:blank')
            time.sleep(1.5)  # for subscriptions to come or go
            client.plan(0)
            requests = (partial(client.plan, number) for number in range(N_EACH))
            costs[looks].append(float(np.mean([cost_of(ask, pid) for ask in requests])))
    without, with_page = (float(np.mean(costs[looks])) for looks in (False, True))
    middle = median(more / less for less, more in zip(costs[False], costs[True], strict=True))
    return Verdict(
        f'CPU time of the node for a request while a page looks, {n_turns * N_EACH} requests each',
        f'{MOST_COST} x',
        f'{1e3 * without:.2f} ms without, {1e3 * with_page:.2f} ms with: '
        f'{with_page / without:.3f} x (median of turns {middle:.3f})',
        with_page <= MOST_COST * without,
    )


def _picture(browser: Any, client: Caller, file: Path) -> None:
    """Write a picture of the page with a search that has unfolded."""
    browser.execute_script("document.getElementById('unfold').checked = false")
    client.plan(0, 'plan_hit_and_run')
    time.sleep(2.0)
    browser.save_screenshot(str(file))


if __name__ == '__main__':
    main()
