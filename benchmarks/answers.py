"""
Measure what an answer costs besides its search, and what rclpy alone needs to send it.

Two processes answer the same service in turns: the planning node, and a node that does nothing
but send a ready-made path with as many poses. One client times both, from its call to the
response; the time of the search is in the outcome of the request. Then, where a start sees its
goal and nothing is searched, the CPU time of both processes is compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import math
import os
from pathlib import Path
from statistics import median
import subprocess
import sys
from tempfile import TemporaryDirectory
from test.ros.domain import own_domain
from test.ros.harness import grid_message, node_process, pose

from benchmarks.answer_cost import cost_of, longest_hold
from benchmarks.caller import BARE, Caller, Pair, START
from benchmarks.progress import show
from benchmarks.sections import Bench, Section, Verdict, verdict_table
from geometry_msgs.msg import PoseStamped
from hnr_planner.core import GridSpace, plan
import numpy as np
from numpy.typing import NDArray

#: Cells along a side, cells across a corridor, and side of a cell [m] of the map: a serpentine,
#: so that a search has more samples than a marker shows.
SIDE, CORRIDOR, RESOLUTION = 200, 5, 0.1
#: The end of the long path, and a goal outside the map [m].
GOAL, NOWHERE = (19.75, 19.75), (-1.0, -1.0)
#: About how many poses the long path has.
N_POSES = 2000
#: With a seed, every request gets the same search and the same path.
SEED = 1
#: Target: time of an answer besides its search, as a multiple of the ready-made answer's.
MOST = 1.5
#: Pairs of answers that are timed.
N_PAIRS, N_PAIRS_QUICK = 200, 20
#: Targets: CPU time [s] of an answer besides its search, also as a multiple of the ready-made
#: answer's, and the longest time [s] for which an answer keeps the interpreter to itself.
MOST_CPU, MOST_CPU_RATIO, MOST_HOLD = 5e-3, 0.2, 2e-3
#: Ends [m] of the path whose start sees its goal, on an empty map, and its number of poses.
SEEN_START, SEEN_GOAL, SEEN_POSES = (1.0, 1.0), (19.0, 19.0), 2032
#: Clients that ask at once as fast as answers come, for so long [s]; and the target: answers a
#: second, as a multiple of those of a node that builds an object for each pose.
N_CLIENTS, SECONDS, MORE_ANSWERS = 8, 5.0, 4.0


def answers(bench: Bench) -> Section:
    """Return the section on the time of an answer besides its search."""
    measured = []
    for verdict in _measure(N_PAIRS_QUICK if bench.quick else N_PAIRS):
        show(f'{verdict.what}: {verdict.measured}')
        measured.append(verdict)
    return Section('Answers of the node', verdict_table(measured), measured)


def _measure(n_pairs: int) -> Iterator[Verdict]:
    """Measure an empty and a long answer, without and with subscribers to samples and markers."""
    data = _serpentine()
    length = plan(GridSpace.from_occupancy(data, RESOLUTION), START, GOAL, seed=SEED).length
    settings = {'seed': SEED, 'time_limit': 10.0, 'pose_spacing': length / N_POSES}
    with TemporaryDirectory() as folder, _quiet_domain(folder):
        with node_process('planner_node', Path(folder) / 'log', **settings) as planner:
            caller = Caller()
            caller.publish(grid_message(data, RESOLUTION))
            planner.wait_for('map received')
            for goal in (pose(*NOWHERE), pose(*GOAL)):
                yield from _compared(caller, goal, n_pairs)
            caller.close()
        seen = math.dist(SEEN_START, SEEN_GOAL) / (SEEN_POSES - 1) * (1.0 + 1e-9)
        with node_process('planner_node', Path(folder) / 'seen', pose_spacing=seen) as planner:
            caller = Caller()
            caller.publish(grid_message(np.zeros_like(data), RESOLUTION))
            planner.wait_for('map received')
            yield from _costs(caller, planner.popen.pid, n_pairs)
            bytes_rate = _answers_per_second()
        arguments = ('--ros-args', '-p', f'pose_spacing:={seen}')
        with _process('benchmarks.node_of_objects', *arguments):
            caller.ask(caller.planner, pose(*SEEN_GOAL), start=SEEN_START)
            objects_rate = _answers_per_second()
        caller.close()
    yield Verdict(
        f'answers a second of {SEEN_POSES} poses to {N_CLIENTS} clients that make no objects',
        f'{MORE_ANSWERS:g} x those from objects',
        f'{bytes_rate:.0f}, from objects {objects_rate:.0f}: {bytes_rate / objects_rate:.1f} x',
        bytes_rate >= MORE_ANSWERS * objects_rate,
    )
    hold = longest_hold(SEEN_POSES)
    yield Verdict(
        f'another thread waits for the interpreter during an answer of {SEEN_POSES} poses',
        f'{1e3 * MOST_HOLD:g} ms',
        f'{1e3 * hold:.2f} ms at most',
        hold <= MOST_HOLD,
    )


def _compared(caller: Caller, goal: PoseStamped, n_pairs: int) -> Iterator[Verdict]:
    """Measure one request; the ready-made path has as many poses as its answer."""
    path, _ = caller.ask(caller.planner, goal)
    n_poses = len(path.poses)
    with _process('benchmarks.ready_made', str(n_poses)):
        for listening in (False, True):
            listener = caller.listener() if listening else None
            caller.meet_ready_made(caller.ready_made, goal)
            pairs = [caller.pair(goal) for _ in range(n_pairs)]
            if listener is not None:
                listener.destroy_node()
            yield _verdict(n_poses, listening, pairs)


def _costs(caller: Caller, pid: int, n_pairs: int) -> Iterator[Verdict]:
    """Measure the CPU time of the process ``pid`` for an answer that needs no search."""
    goal = pose(*SEEN_GOAL)
    n_poses = len(caller.ask(caller.planner, goal, start=SEEN_START)[0].poses)
    bare = '--ros-args', '-r', f'__ns:={BARE}'
    with (
        _process('benchmarks.ready_made', str(n_poses)) as ready_made,
        _process('benchmarks.ready_made', '1', *bare) as of_one_pose,
    ):
        caller.meet_ready_made(caller.ready_made, goal)
        caller.meet_ready_made(caller.bare, goal)
        for listening in (False, True):
            listener = caller.listener() if listening else None
            costs = [
                (
                    cost_of(lambda: caller.ask(caller.planner, goal, start=SEEN_START), pid),
                    cost_of(lambda: caller.ask(caller.ready_made, goal), ready_made.pid),
                    cost_of(lambda: caller.ask(caller.bare, goal), of_one_pose.pid),
                )
                for _ in range(n_pairs)
            ]
            if listener is not None:
                listener.destroy_node()
            ours, least, least_of_one = (median(times) for times in zip(*costs, strict=True))
            yield Verdict(
                f'CPU time of the node for an answer of {n_poses} poses without a search, '
                f'pictures {"" if listening else "not "}subscribed to',
                f'{1e3 * MOST_CPU:g} ms, {MOST_CPU_RATIO} x',
                f'{1e3 * ours:.2f} ms, ready-made {1e3 * least:.2f} ms: {ours / least:.2f} x; '
                f'ready-made of one pose {1e3 * least_of_one:.2f} ms',
                ours <= min(MOST_CPU, MOST_CPU_RATIO * least),
            )


def _answers_per_second() -> float:
    """Return how many answers a second ``N_CLIENTS`` clients get that make no objects."""
    numbers = (N_CLIENTS, SECONDS, *SEEN_START, *SEEN_GOAL)
    ran = subprocess.run(
        [sys.executable, '-m', 'benchmarks.raw_clients', *map(str, numbers)],
        capture_output=True,
        text=True,
        check=True,
        timeout=300.0,
    )
    return float(ran.stdout)


def _verdict(n_poses: int, listening: bool, pairs: list[Pair]) -> Verdict:
    besides = median(pair.answer - pair.search for pair in pairs)
    least = median(pair.ready_made for pair in pairs)
    search = median(pair.search for pair in pairs)
    measured = (
        f'{1e3 * besides:.2f} ms (and {1e3 * search:.1f} ms of search), ready-made '
        f'{1e3 * least:.2f} ms: {besides / least:.2f} x'
    )
    what = f'an answer of {n_poses} poses besides its search, '
    what += f'pictures {"" if listening else "not "}subscribed to'
    return Verdict(what, f'{MOST} x', measured, besides <= MOST * least)


def _serpentine() -> NDArray[np.int8]:
    """Draw corridors side by side, each open to the next at the other end."""
    data = np.zeros((SIDE, SIDE), dtype=np.int8)
    for number, row in enumerate(range(CORRIDOR, SIDE - CORRIDOR, CORRIDOR)):
        data[row] = 100
        door = slice(-CORRIDOR, None) if number % 2 == 0 else slice(CORRIDOR)
        data[row, door] = 0
    return data


@contextmanager
def _quiet_domain(folder: str) -> Iterator[None]:
    """Run nodes in a ROS domain of their own, with their logs in a folder."""
    with own_domain() as domain:
        os.environ['ROS_DOMAIN_ID'] = str(domain)
        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        os.environ['ROS_LOG_DIR'] = folder
        yield


@contextmanager
def _process(*module_and_arguments: str) -> Iterator[subprocess.Popen]:
    """Run a Python module in a process while the block runs."""
    process = subprocess.Popen([sys.executable, '-m', *module_and_arguments])
    try:
        yield process
    finally:
        process.kill()  # rclpy's own executors may miss a gentler signal
        process.wait()
