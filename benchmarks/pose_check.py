"""
Check chords and plans of robots that are not round against an independent checker, for long.

``python -m benchmarks.pose_check [--chords N] [--plans N] [--minutes M]`` takes three footprints
on five maps: every chord has to be free all along and to end at a contact, and every path of a
plan has to be free in small steps, with its ends. It prints what is wrong, and counts.
"""

from __future__ import annotations

import argparse
import itertools
import math
from test.core.spaces.poses.robots import checker, FOOTPRINTS, free_poses, MAPS, random_twist
from test.pose_checker import orbit, PoseChecker
import time

from benchmarks.progress import say
from hnr_planner.core import plan, PlannerStatus, PoseSpace
import numpy as np

#: Poses along a chord that are tested, distance from a contact [cells] at which a chord may end,
#: and distance between the poses of a plan that are tested [cells].
N_ALONG, CONTACT, STEP = 150, 1e-5, 0.2
#: Transitions that a plan may take: enough for most.
N_ITERATIONS = 2000
#: Free poses that are drawn at once; the more, the surer some are found on a crowded map.
N_FREE = 20
DRIVES = (
    {'drive': 'car', 'min_turning_radius': 0.8},
    {'drive': 'differential'},
    {'drive': 'omnidirectional'},
)
SEED = 20163


def main() -> None:
    """Check until the numbers or the time are reached, and print the counts."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.pose_check', description=__doc__)
    parser.add_argument('--chords', type=int, default=20_000)
    parser.add_argument('--plans', type=int, default=10_000)
    parser.add_argument('--minutes', type=float, default=math.inf)
    wanted = parser.parse_args()
    rng, end = np.random.default_rng(SEED), time.monotonic() + 60.0 * wanted.minutes
    scenes = [
        (f'{footprint} on {name}, {drive["drive"]}', space, checker(space))
        for name, footprint, drive in itertools.product(MAPS, FOOTPRINTS, DRIVES)
        for space in [PoseSpace(MAPS[name](), FOOTPRINTS[footprint], **drive)]
    ]
    counts = dict.fromkeys(('chords', 'wrong chords', 'plans', 'solved', 'wrong plans'), 0)
    for name, space, judge in itertools.cycle(scenes):
        more_chords, more_plans = (
            counts[what] < getattr(wanted, what) for what in ('chords', 'plans')
        )
        if time.monotonic() > end or not (more_chords or more_plans):
            break
        for _ in range(20 if more_chords else 0):
            wrong = wrong_chord(space, judge, rng)
            counts['chords'] += 1
            counts['wrong chords'] += bool(wrong)
            if wrong:
                say(f'{name}: {wrong}')
        for _ in range(4 if more_plans else 0):
            status, wrong = wrong_plan(space, judge, rng)
            counts['plans'] += 1
            counts['solved'] += status is PlannerStatus.SOLVED
            counts['wrong plans'] += bool(wrong)
            if wrong:
                say(f'{name}: {wrong}')
    say(', '.join(f'{count} {what}' for what, count in counts.items()))


def wrong_chord(space: PoseSpace, judge: PoseChecker, rng: np.random.Generator) -> str:
    """Return what is wrong with the chord of a random twist at a random free pose; '' for none."""
    pose, twist = free_poses(space, rng, N_FREE)[0], random_twist(rng)
    lower, upper = space.chord(pose, twist)
    fractions = np.concatenate([np.linspace(0.0, 1.0, N_ALONG)[1:-1], [1e-7, 1.0 - 1e-7]])
    along = orbit(pose, twist, lower + fractions * (upper - lower))
    where = f'chord of the twist {twist.tolist()} at {pose.tolist()}'
    if not (lower < 0.0 < upper and (judge.distances(along) > 0.0).all()):
        return f'{where} is not free'
    closed = abs(twist[2]) * (upper - lower) >= 2.0 * math.pi * (1.0 - 1e-9)
    if not closed and judge.distances(orbit(pose, twist, [lower, upper])).max() > CONTACT:
        return f'{where} ends early'
    return ''


def wrong_plan(
    space: PoseSpace, judge: PoseChecker, rng: np.random.Generator
) -> tuple[PlannerStatus, str]:
    """Return the status of a plan between random free poses, and what is wrong with its path."""
    start, goal = free_poses(space, rng, N_FREE)[:2]
    seed = int(rng.integers(2**31))
    result = plan(space, start, goal, seed=seed, time_limit=math.inf, max_iterations=N_ITERATIONS)
    if result.status is not PlannerStatus.SOLVED:
        return result.status, ''
    assert result.twists is not None
    wrong = judge.collisions(result.path, result.twists, STEP)
    if not (np.array_equal(result.path[0], start) and np.array_equal(result.path[-1], goal)):
        wrong.append('the ends are others')
    where = f'seed {seed} from {start.tolist()} to {goal.tolist()}'
    return result.status, f'{where}: {wrong}' if wrong else ''


if __name__ == '__main__':
    main()
