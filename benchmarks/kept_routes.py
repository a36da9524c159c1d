"""
Measure how steady routes are with ``keep_route`` while doors open and close and people walk by.

A robot drives through a floor of ``moving_world`` to one random goal after another, and asks for a
path whenever a map arrives. Another robot, which remembers no route, does the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
import time

from benchmarks.moving_world import (
    Floor,
    moving_world,
    office,
    place_in,
    RATE,
    RESOLUTION,
    store,
)
from benchmarks.progress import show
from benchmarks.sections import Bench, Section, table, Verdict, verdict_table
from hnr_planner.core import GridSpace, plan
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.homology import islands_at, signature
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.parameters.settings import DEFAULTS
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: The parameter that is measured, and the radius [m] and the speed [m/s] of the robot.
RATIO, RADIUS, SPEED = 0.2, 0.2, 0.2
#: Map updates of a world, and seeds of the worlds. RATIO was chosen on others, 0 and 1.
N_UPDATES, SEEDS = 1000, (10, 11)
N_UPDATES_QUICK, SEEDS_QUICK = 200, (10,)
#: The robot has arrived at this distance from its goal [m].
ARRIVED = 0.3
#: Paths of different classes among which one of the last route's class is looked for.
ALTERNATIVES = 16
#: Targets: changes of the route that nothing forces, as a fraction of all changes without memory;
#: mean length over the shortest; and CPU time [s] of all but one in a hundred requests.
MOST_CHANGES, MOST_LENGTH, MOST_TIME = 0.05, 1.02, 0.01
EXPLAINED = f"""\
Each map update comes {1.0 / RATE:g} s after the one before; the robot drives at {SPEED} m/s along
its last path and asks anew at each update, with `keep_route` at {RATIO}. A route changes where the
new path passes a wall or a shelf on another side than the rest of the last path does: where their
homology classes differ with respect to the islands of the floor with all doors open and nobody
there. People are not counted: to swerve to the other side of one is no change. A change is forced
where no path of the class of the last route is left on the new map, or only such as are longer
than the shortest one by more than `keep_route` allows: a door has closed, somebody stands in it,
or a much shorter way has opened. Lengths are those over the shortest path from where the robot is;
times are CPU times of whole requests, in the server.
"""


@dataclass
class Robot:
    """A robot that drives to the goals (g, 2) [m] one after another along the last path."""

    server: PlanningServer
    class_of: Callable[[Floats], int]
    goals: Floats
    at: Floats
    reached: int = 0
    rest: Floats | None = None
    changes: int = 0
    forced: int = 0
    lengths: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    routes: Counter[str] = field(default_factory=Counter)

    def ask(self, space: GridSpace) -> None:
        """Ask for a path, note whether the route changes, and drive on until the next map."""
        goal = self.goals[self.reached]
        ends = (Pose((*end.tolist(), 0.0)) for end in (self.at, goal))
        began = time.thread_time()
        response = self.server.plan(PlanRequest(*ends, 0.0, 'auto'))
        seconds = time.thread_time() - began
        if not response.solved:
            return
        self.seconds.append(seconds)
        self.routes[response.route] += 1
        path = response.path
        shortest = plan(space, self.at, goal, algorithm='polyanya').length
        self.lengths.append(path_length(path) / max(shortest, RESOLUTION))
        if self.rest is not None and self.class_of(self.rest) != self.class_of(path):
            self.changes += 1
            self.forced += self._is_forced(space, goal, shortest)
        self.rest = rest_after(path, SPEED / RATE)
        self.at = self.rest[0]
        if np.linalg.norm(goal - self.at) < ARRIVED:
            self.reached, self.rest = self.reached + 1, None

    def _is_forced(self, space: GridSpace, goal: Floats, shortest: float) -> bool:
        """Return whether no path of the class of the last route may be kept."""
        found = plan(space, self.at, goal, alternatives=ALTERNATIVES, seed=0, time_limit=60.0)
        return not any(
            self.class_of(path) == self.class_of(self.rest)
            and shortest >= (1.0 - RATIO) * path_length(path)
            for path in found.paths
        )


def rest_after(path: Floats, driven: float) -> Floats:
    """Return what is left of a path (m, 2) after a distance [m] on it."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    if driven >= along[-1]:
        return path[[-1, -1]]
    k = int(np.searchsorted(along, driven, side='right')) - 1
    after = k + 1
    point = path[k] + (driven - along[k]) / steps[k] * (path[after] - path[k])
    return np.vstack([point, path[after:]])


def drive(
    make_floor: Callable[[np.random.Generator], Floor], seed: int, n_updates: int
) -> tuple[Robot, Robot]:
    """Drive a robot that keeps its route and one that does not through one world."""
    world = moving_world(make_floor, seed, n_updates)
    settings = replace(DEFAULTS, robot_radius=RADIUS, seed=1, time_limit=10.0, map_wait=0.0)
    maps = MapStore(settings)
    walls = GridSpace.from_blocked(world.floor.walls, RESOLUTION)
    islands = islands_at(walls.island_points)
    rng = np.random.default_rng([seed, 1])
    places = rng.integers(len(world.floor.places), size=n_updates)
    goals = np.array([place_in(rng, world.floor.places[place]) for place in places])
    robots = []
    for keep_route in (RATIO, 0.0):
        mine = replace(settings, keep_route=keep_route)
        server = PlanningServer(lambda mine=mine: mine, maps.newest, only_same_frame, print)
        server.searches.enable()

        def class_of(path: Floats) -> int:
            return int(signature(islands, walls.to_kernel(path)))

        robots.append(Robot(server, class_of, goals[1:], goals[0]))
    for moment in range(n_updates):
        data = world.data(moment)
        maps.receive(lambda data=data: OccupancyMap(data, RESOLUTION))
        for robot in robots:
            robot.ask(maps.newest().space)
    return robots[0], robots[1]


def kept_routes(bench: Bench) -> Section:
    """Return the section on routes that stay while the map changes."""
    n_updates, seeds = N_UPDATES, SEEDS
    if bench.quick:
        n_updates, seeds = N_UPDATES_QUICK, SEEDS_QUICK
    rows, verdicts = [], []
    for make_floor in (office, store):
        name = make_floor.__name__
        pairs = [drive(make_floor, seed, n_updates) for seed in seeds]
        for seed, pair in zip(seeds, pairs, strict=True):
            for robot, label in zip(pair, (f'{RATIO}', '0'), strict=True):
                rows.append(_row(f'{name} {seed}', label, robot))
        verdicts.append(_verdict(name, n_updates, pairs))
        show(f'{verdicts[-1].what}: {verdicts[-1].measured}')
    head = (
        'world | keep_route | solved | changes | forced | mean length | longest | ms, median | p99'
    )
    body = f'{EXPLAINED}\n{table(head, rows)}\n\n{verdict_table(verdicts)}'
    return Section('Routes that stay', body, verdicts)


def _row(world: str, label: str, robot: Robot) -> list[str]:
    times = 1e3 * np.quantile(robot.seconds, [0.5, 0.99])
    return [
        world,
        label,
        str(len(robot.lengths)),
        str(robot.changes),
        str(robot.forced),
        f'{np.mean(robot.lengths):.4f}',
        f'{max(robot.lengths):.3f}',
        *(f'{milliseconds:.1f}' for milliseconds in times),
    ]


def _verdict(name: str, n_updates: int, pairs: list[tuple[Robot, Robot]]) -> Verdict:
    kept, free = zip(*pairs, strict=True)
    changes, forced = (
        sum(getattr(robot, what) for robot in kept) for what in ('changes', 'forced')
    )
    without = sum(robot.changes for robot in free)
    length = float(np.mean([ratio for robot in kept for ratio in robot.lengths]))
    p99 = float(np.quantile([seconds for robot in kept for seconds in robot.seconds], 0.99))
    unforced = changes - forced
    return Verdict(
        f'routes in the {name}, {len(pairs)} x {n_updates} map updates',
        f'unforced changes {MOST_CHANGES:.0%} of all without memory, mean length {MOST_LENGTH} x, '
        f'p99 {1e3 * MOST_TIME:g} ms',
        f'{unforced} unforced and {forced} forced changes, without memory {without}; '
        f'{length:.4f} x; {1e3 * p99:.1f} ms',
        unforced <= MOST_CHANGES * without and length <= MOST_LENGTH and p99 <= MOST_TIME,
    )
