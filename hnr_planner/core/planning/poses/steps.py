"""Steps of a search tree that aim at no pose: Hit-and-Run along a random twist, and shuffles."""

import math

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.sampling.draws import REDRAWS_MAX
from hnr_planner.core.spaces.lines import draw_direction, point_on_line
from hnr_planner.core.spaces.poses.data import first_contact_of
from hnr_planner.core.spaces.poses.drive import CAR
from hnr_planner.core.spaces.primitives import chord, contains
from hnr_planner.core.trees import NONE

#: Least length [cells] of a motion that is cut off by a contact.
SHORTEST = 0.1
#: Most strokes of a shuffle, the angle [rad] after which one ends at the latest, and the
#: probability that it ends at the contact rather than before.
N_STROKES, STROKE_TURN, TO_CONTACT = 12, 0.5 * math.pi, 0.7
#: Probability that a shuffle begins at a root, where the robot may be hemmed in.
AT_ROOT = 0.5


@inlined
def driving_sign(tree):
    """Return 1.0 for the start's tree, and -1.0 for the goal's, which grows against driving."""
    return 1.0 if tree == 0 else -1.0


@kernel
def add_vertex(trees, tree, parent, row):
    """Make ``row`` a vertex of a tree with this parent; return the row."""
    trees.parents[row], trees.owners[row] = parent, tree
    return row


@kernel
def has_room(problem, tree, pose):
    """
    Return whether the robot gets on from a pose (3,), a new vertex of a tree, by ``problem.room``.

    A car that must not reverse gets on straight ahead or at full lock to either side, and back in
    the same ways in the tree of the goal. Without room it would be stuck at the vertex.
    """
    if problem.room == 0.0:
        return True
    space, room = problem.space, problem.room
    driven = driving_sign(tree)
    for side in range(-1, 2):
        bend = side * space.max_curvature
        reached = first_contact_of(space, pose[0], pose[1], pose[2], driven, 0.0, bend, room)
        if reached > room:
            return True
    return False


@kernel
def _draw_vertex(trees, tree, size, newest, rng):
    """Return the row of a random vertex of a tree, or of its ``newest``."""
    row = size - 1 if newest else math.floor(size * uniform(rng))
    while trees.owners[row] != tree:
        row = row - 1 if row > 0 else size - 1
    return row


@kernel
def hit_and_run_step(problem, trees, tree, size, from_newest, rng):
    """Add a step of Hit-and-Run from a vertex of a tree; return the number of vertices."""
    space = problem.space
    row = _draw_vertex(trees, tree, size, from_newest, rng)
    x, u, back = trees.poses[row], trees.work[1], trees.work[2]
    draw_direction(space, rng, u)
    for i in range(3):
        back[i] = -u[i]
    lower, upper = chord(space, x, u, back)
    if not space.reverse and u[0] != 0.0:
        # The tree of the goal grows against the direction in which the robot drives.
        if tree == 0:
            lower = 0.0
        else:
            upper = 0.0
    y = trees.poses[size]
    for _ in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        point_on_line(space, x, u, s, y)
        if lower < s < upper and contains(space, y):
            if not has_room(problem, tree, y):
                return size
            for i in range(3):
                trees.twists[size, i] = s * u[i]
            add_vertex(trees, tree, row, size)
            return size + 1
    return size


@kernel
def shuffle(problem, trees, tree, size, rng):
    """
    Add strokes back and forth that turn the robot to one side; return the number of vertices.

    This is how a driver turns in a tight place, or leaves one: a car goes ahead and back in turn,
    at full lock, mostly up to the contact; the other drives turn in place and move in turn. A
    robot that must not drive backwards makes strokes ahead only, a car to the left and right, and
    a car of that kind ends none of them at a contact.
    """
    space, u = problem.space, trees.work[1]
    driven = driving_sign(tree)
    row = _draw_vertex(trees, tree, size, False, rng)
    if uniform(rng) < AT_ROOT:
        while trees.parents[row] != NONE:
            row = trees.parents[row]
    side = 1.0 if uniform(rng) < 0.5 else -1.0
    ahead = 1.0 if uniform(rng) < 0.5 else -1.0
    for stroke in range(N_STROKES):
        if space.drive == CAR:
            u[0], u[1], u[2] = ahead, 0.0, side * space.max_curvature
            ahead = -ahead
            horizon = STROKE_TURN / space.max_curvature
        elif stroke % 2 == 0:
            u[0], u[1], u[2] = 0.0, 0.0, side / space.reach
            horizon = STROKE_TURN * space.reach
        else:
            draw_direction(space, rng, u)
            sign = 1.0 if uniform(rng) < 0.5 else -1.0
            for i in range(3):
                u[i] *= sign
            horizon = space.reach
        if not space.reverse and u[0] * driven < 0.0:
            for i in range(3):
                u[i] = -u[i]
        x = trees.poses[row]
        end = first_contact_of(space, x[0], x[1], x[2], u[0], u[1], u[2], horizon)
        # The footprint moves by two units of length in a unit of time, at the most.
        end = min(end - problem.margin, horizon)
        if problem.room > 0.0 or uniform(rng) >= TO_CONTACT:
            end *= uniform(rng)
        y = trees.poses[size]
        point_on_line(space, x, u, end, y)
        if end < SHORTEST or not contains(space, y) or not has_room(problem, tree, y):
            continue
        for i in range(3):
            trees.twists[size, i] = end * u[i]
        row = add_vertex(trees, tree, row, size)
        size += 1
    return size
