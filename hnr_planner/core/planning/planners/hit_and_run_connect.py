"""
Trees of Hit-and-Run steps from start and goal, joined by the first free segment between them.

The paper's chain explores fast but wanders, and its path is the whole walk; the paper leaves
planners with short paths to future work. Here a tree grows from each end of the request. From a
vertex at the frontier of its tree a step is like Hit-and-Run's, but chooses among a few uniform
directions the one with the longest free ray, and a uniform point on the outer section of that ray.
For each new vertex segments to the other tree are tested: to vertices nearby, and to a few drawn
uniformly.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.planning.planner import Problem, reaches_goal, with_capacity
from hnr_planner.core.planning.planners.frontier import (
    add_to_bin,
    choose_vertex,
    empty_frontier,
    Frontier,
)
from hnr_planner.core.planning.planners.two_trees import (
    add_vertex,
    empty_trees,
    first_free_row,
    TreePair,
    TwoTreeSearch,
    with_rows,
)
from hnr_planner.core.sampling.draws import REDRAWS_MAX, try_between
from hnr_planner.core.spaces.lines import draw_direction
from hnr_planner.core.spaces.oracle_data import OracleData
from hnr_planner.core.spaces.primitives import (
    component,
    first_blocked,
    is_visible,
    longest_ray,
)
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Number of uniform directions that a step chooses from, and fraction of the longest ray that it
#: skips: in the plane the best of 1 to 6 and of 0 to .9 on building maps and spirals, in more
#: dimensions those of 1 to 16 and of 0 to .7 on walls with holes, among balls and for an arm.
N_RAYS, N_RAYS_IN_SPACE = 4, 8
INNER, INNER_IN_SPACE = 0.7, 0.5
#: Bins around that of a new vertex whose vertices of the other tree are tested, on each side, and
#: number of those drawn uniformly: in the plane, and in more dimensions, where bins, which are of
#: the first two coordinates, say little of what is near, and a segment costs less than a step
#: (of 2 to 12, 4 to 8 were fastest on walls with holes, among balls and for an arm).
AROUND, AROUND_IN_SPACE = 1, 0
N_UNIFORM, N_UNIFORM_IN_SPACE = 1, 6


class FrontierTrees(NamedTuple):
    """
    Two trees, with the index of their frontiers.

    Attributes
    ----------
    table : TreePair
        Vertices of both trees, kernel frame.
    members : (rows, 2) int64
        Rows in ``table`` of the vertices of each tree, one column for each tree.
    frontier : Frontier
        Bins from which the next vertex to grow each tree is chosen.
    directions : (n, dim)
        Work array of a step: the directions of the rays that it chooses from.

    """

    table: TreePair
    members: NDArray[np.int64]
    frontier: Frontier
    directions: Floats


@dataclass(frozen=True)
class HitAndRunConnect:
    """The planner that grows trees of Hit-and-Run steps from both ends. It has no settings."""

    name: ClassVar[str] = 'hit_and_run_connect'

    def start(self, problem: Problem, rng: Stream) -> 'HitAndRunConnectSearch':
        """Return a search whose trees begin at the problem's start and at its goal."""
        return HitAndRunConnectSearch(problem, rng)


@dataclass
class HitAndRunConnectSearch(TwoTreeSearch):
    """Search with two trees, which grow alternately; a transition is one step of one tree."""

    _redraws: int = field(init=False, default=0)
    #: None until the first steps, whose kernel call also makes the trees: one call less.
    _table: TreePair | None = field(init=False, default=None)
    #: None before the first steps, and where they solved the search.
    _trees: FrontierTrees | None = field(init=False, default=None)

    @property
    def tested(self) -> bool:
        """
        Whether every segment of the path has been tested as ``segment_is_free`` tests it.

        Where a space tests points only, steps are tested like that, and to test them again takes
        as long as a third of the search. Elsewhere a step ends on a ray known to be free.
        """
        space = self.problem.space
        return isinstance(space, OracleData) and space.tests_points and self._ends[1] != NONE

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: ``redraws``, draws repeated since they fell on the boundary."""
        return {'redraws': self._redraws}

    def advance(self, n_iterations: int) -> None:
        """Take ``n_iterations`` further steps, or fewer where the search is solved before."""
        if self.solved:
            return
        if self._trees is None:
            self._table, self._trees, grown = _begin(self.problem, self.rng, n_iterations)
        else:
            rows = len(self.samples) + n_iterations
            self._trees = _with_rows(self._trees, rows)
            self._table = self._trees.table
            grown = _grow(self.problem, self._trees, self.rng, self.iterations, n_iterations)
        self._ends, taken, redraws = grown
        self.iterations += taken
        self._redraws += redraws


def _with_rows(trees: FrontierTrees, rows: int) -> FrontierTrees:
    """Return the trees with a common capacity of at least ``rows`` vertices."""
    table = with_rows(trees.table, rows)
    return trees._replace(table=table, members=with_capacity(trees.members, len(table.parents)))


@kernel
def _begin(problem, rng, n_iterations):
    """
    Make the trees and take their first steps; return (table, trees, result of ``_grow``).

    ``trees`` is None where these steps solve the search: then only the table is of use, and to
    return the other arrays would take longer than several steps.
    """
    trees = _plant(problem, 2 + n_iterations)
    grown = _grow(problem, trees, rng, 0, n_iterations)
    ends, _, _ = grown
    if ends[0] != NONE:
        return trees.table, None, grown
    return trees.table, trees, grown


@kernel
def _plant(problem, rows):
    """
    Return trees with a capacity of ``rows``, with a root at the start and, if possible, the goal.

    The tree of the goal stays empty where the goal lies in another component, another connected
    part of free space, than the start.
    """
    dim = len(problem.start)
    trees = FrontierTrees(
        empty_trees(rows, dim),
        np.empty((rows, 2), dtype=np.int64),
        empty_frontier(problem.lower, problem.upper, problem.typical_clearance),
        np.empty((N_RAYS if dim <= 2 else N_RAYS_IN_SPACE, dim)),
    )
    copy_into(trees.table.vertices[0], problem.start)
    _add(trees, 0, NONE)
    if component(problem.space, problem.goal) == component(problem.space, problem.start):
        copy_into(trees.table.vertices[1], problem.goal)
        _add(trees, 1, NONE)
    return trees


@kernel
def _grow(problem, trees, rng, turn, n_iterations):
    """
    Grow the trees alternately by at most ``n_iterations`` steps; return (ends, steps, redraws).

    ``ends`` are the rows of the two vertices that connect the trees, the start's tree first,
    (row, NONE) for a vertex in the goal region, or (NONE, NONE) while the search is not solved.
    ``turn`` is the number of steps taken before.
    """
    problem, trees, rng = borrowed(problem), borrowed(trees), borrowed(rng)
    vertices = trees.table.vertices
    n_trees = 2 if trees.table.sizes[1] > 0 else 1
    redraws = 0
    for i in range(n_iterations):
        tree = (turn + i) % n_trees
        row = first_free_row(trees.table)
        parent = choose_vertex(trees.frontier, tree, rng)
        x, y = vertices[parent], vertices[row]
        redraws += _step(problem.space, x, rng, trees.directions, y)
        bin_number = _add(trees, tree, parent)
        met = _meet(problem.space, trees, row, bin_number, 1 - tree, rng)
        if met != NONE:
            return ((row, met) if tree == 0 else (met, row)), i + 1, redraws
        if tree == 0 and problem.goal_radius > 0.0 and reaches_goal(problem, y):
            return (row, NONE), i + 1, redraws
    return (NONE, NONE), n_iterations, redraws


@kernel
def _step(space, x, rng, directions, y):
    """
    Step from ``x`` (dim,) along the longest of a few uniform rays; write the end ``y``.

    The end is uniform on the outer section of the ray. Returns the number of redraws.
    """
    for k in range(len(directions)):
        draw_direction(space, rng, directions[k])
    k, end = longest_ray(space, x, directions)
    inner = INNER if len(x) <= 2 else INNER_IN_SPACE
    return _draw_on_ray(space, x, directions[k], inner, end, rng, y)


@kernel
def _draw_on_ray(space, x, u, inner, end, rng, y):
    """
    Write a uniform point of a ray, from ``inner * end`` to ``end``, into ``y``.

    It is drawn again where it is not free, or where the ray is found blocked before it, which then
    ends there. Returns the number of redraws; after ``REDRAWS_MAX`` redraws ``y`` is ``x``.
    """
    for redraws in range(REDRAWS_MAX):
        s = try_between(space, x, u, inner * end, end, rng, y)
        if not math.isnan(s):
            blocked = first_blocked(space, x, y)
            if blocked == math.inf:
                return redraws
            end = blocked * s
    copy_into(y, x)
    return REDRAWS_MAX


@kernel
def _add(trees, tree, parent):
    """Add the vertex in the first free row to a tree, below row ``parent``; return its bin."""
    trees.members[trees.table.sizes[tree], tree] = first_free_row(trees.table)
    row = add_vertex(trees.table, tree, parent)
    return add_to_bin(trees.frontier, tree, trees.table.vertices[row], row)


@kernel
def _meet(space, trees, row, bin_number, other, rng):
    """
    Return the row of a vertex of tree ``other`` visible from vertex ``row``; NONE if not found.

    Tested are the newest vertices in the bin of number ``bin_number`` and, in the plane, in the 8
    bins around it, and then different vertices drawn uniformly.
    """
    vertices, size = trees.table.vertices, trees.table.sizes[other]
    if size == 0:
        return NONE
    newest, columns = trees.frontier.newest, trees.frontier.bins.columns
    in_plane = vertices.shape[1] <= 2
    around = AROUND if in_plane else AROUND_IN_SPACE
    for below in range(-around, around + 1):
        for beside in range(-around, around + 1):
            k = newest[other, bin_number + columns * below + beside]
            if k != NONE and is_visible(space, vertices[row], vertices[k]):
                return k
    n_uniform = N_UNIFORM if in_plane else N_UNIFORM_IN_SPACE
    members = trees.members[:, other]
    for i in range(min(n_uniform, size)):
        chosen = i + int((size - i) * uniform(rng))
        k = members[chosen]
        if is_visible(space, vertices[row], vertices[k]):
            return k
        if n_uniform > 1:  # the next draws are without those before
            members[chosen], members[i] = members[i], k
    return NONE
