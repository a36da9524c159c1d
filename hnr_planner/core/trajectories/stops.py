"""Motions along a polyline that are at rest at each vertex and as fast as possible between."""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.homology import NO_ISLANDS
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.postprocessing.shortcuts import pull, skip
from hnr_planner.core.systems.primitives import move
from hnr_planner.core.trajectories.problem import SHORTEST_STEP
import numpy as np

#: Largest number of visibility tests of each of the two methods that shorten the polyline.
TESTS = 2000


def shorten_stops(geometric: Problem, stops: Floats) -> Floats:
    """
    Return a shorter free polyline (k, dim) with the same ends as ``stops`` (m, dim).

    Vertices are skipped where a straight segment is free; then the rest is pulled taut. Each of
    the two methods makes at most ``TESTS`` visibility tests.
    """
    kept = np.zeros(len(stops), dtype=np.int64)
    n_kept, _ = skip(geometric.space, NO_ISLANDS, stops, kept, 1, True, TESTS)
    beyond = kept[n_kept - 1] + 1
    left = np.concatenate([stops[kept[:n_kept]], stops[beyond:]])
    taut: Floats
    taut, _, _ = pull(geometric.space, NO_ISLANDS, left, 1, geometric.margin, TESTS)
    return taut


@kernel
def drive_stops(system, stops):
    """
    Return the motion (durations, states, controls) that is at rest at each of ``stops`` (m, dim).

    A segment has a ramp up, a cruise at full speed if it is long enough for that, and a ramp down.
    A segment whose ramp would be shorter than ``SHORTEST_STEP`` is left out.
    """
    n, dim = len(stops) - 1, stops.shape[1]
    durations, controls = np.empty(3 * n), np.zeros((3 * n, dim))
    states = np.zeros((3 * n + 1, 2 * dim))
    copy_into(states[0, :dim], stops[0])
    rows = 0
    for k in range(n):
        length = distance(stops[k], stops[k + 1])
        strongest = system.max_acceleration
        speed = min(math.sqrt(strongest * length), system.max_speed)
        ramp = speed / strongest
        if ramp < SHORTEST_STEP:
            continue
        cruise = length / speed - ramp
        if 1e-12 * ramp < cruise < SHORTEST_STEP:
            # No cruise: ramps to the same speed at a lower acceleration, in the same time.
            ramp = length / speed
            strongest, cruise = speed / ramp, 0.0
        u = (stops[k + 1] - stops[k]) / length
        for sign, duration in ((1.0, ramp), (0.0, cruise), (-1.0, ramp)):
            if duration < SHORTEST_STEP:
                continue
            durations[rows] = duration
            for i in range(dim):
                controls[rows, i] = sign * strongest * u[i]
            move(system, states[rows], controls[rows], duration, states[rows + 1])
            rows += 1
        for i in range(dim):
            states[rows, i], states[rows, dim + i] = stops[k + 1, i], 0.0
    return durations[:rows], states[: rows + 1], controls[:rows]
