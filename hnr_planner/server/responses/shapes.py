"""Shapes that show a search to people: points, lines and balls in the map's frame."""

from collections.abc import Sequence
import enum
from typing import NamedTuple

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.server.geometry.pose_motions import poses_of
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.subsample import subsample_tree
import numpy as np
from numpy.typing import NDArray

#: Most points in one shape: more take longer to draw, and do not show more to the eye.
MOST_POINTS = 10_000

#: Most outlines of a footprint along a path.
MOST_OUTLINES = 200


class Kind(enum.Enum):
    """
    How the points of a shape are drawn.

    POINTS: a dot each. PAIRS: a segment from the first to the second, third to fourth, and so on.
    LINE: a polyline through all. BALL: a ball around the only point.
    """

    POINTS = enum.auto()
    PAIRS = enum.auto()
    LINE = enum.auto()
    BALL = enum.auto()


class Shape(NamedTuple):
    """
    A named shape to draw.

    Attributes
    ----------
    name : str
        What the shape shows: 'samples', 'tree', 'alternatives', 'path', 'footprint', 'start' or
        'goal'.
    kind : Kind
        How the points are drawn.
    size : float
        Width of a line or dot, or diameter of a ball [m].
    points : (n, 2)
        Points in the map's frame [m]; for ``PAIRS`` an even number, for ``BALL`` one.

    """

    name: str
    kind: Kind
    size: float
    points: NDArray[np.float64]


def search_shapes(response: PlanResponse) -> list[Shape]:
    """
    Return the shapes of samples, tree, path, start and goal of a solved request.

    Further paths, where there are any, are one shape; with a footprint, its outlines along the
    path are another. None after a failure. Samples, edges and path vertices are thinned to
    ``MOST_POINTS`` points in each shape.
    """
    if not response.solved or response.result is None or response.snapshot is None:
        return []
    cell = response.snapshot.occupancy.resolution
    request = response.request
    return [
        *_result_shapes(response, response.result, cell),
        *_other_paths(response.others, cell),
        *_footprint_shapes(response, cell),
        Shape('start', Kind.BALL, 4.0 * cell, np.array([request.start.point])),
        Shape('goal', Kind.BALL, 4.0 * cell, np.array([request.goal.point])),
    ]


def _result_shapes(response: PlanResponse, result: SearchResult, cell: float) -> list[Shape]:
    """Return shapes of the samples, the tree edges and the path; ``cell`` [m] sets their size."""
    samples, parents = result.samples[:, :2], result.parents
    dots = subsample_tree(parents, MOST_POINTS)
    # An edge has two points.
    tree = subsample_tree(parents, MOST_POINTS // 2)
    children = np.flatnonzero(tree.parents >= 0)
    nodes = samples[tree.rows]
    edges = np.stack([nodes[tree.parents[children]], nodes[children]], axis=1).reshape(-1, 2)
    path = response.poses[:, :2] if response.has_footprint else result.path
    if len(path) > MOST_POINTS:
        path = path[np.linspace(0, len(path) - 1, MOST_POINTS).astype(int)]
    return [
        Shape('samples', Kind.POINTS, cell, samples[dots.rows]),
        Shape('tree', Kind.PAIRS, cell / 4.0, edges),
        Shape('path', Kind.LINE, cell, path),
    ]


def _other_paths(paths: Sequence[NDArray[np.float64]], cell: float) -> list[Shape]:
    """Return the shape of the alternatives to a path, if there are any."""
    segments = [np.repeat(path, 2, axis=0)[1:-1] for path in paths]
    if not segments:
        return []
    return [Shape('alternatives', Kind.PAIRS, cell / 2.0, np.vstack(segments)[:MOST_POINTS])]


def _footprint_shapes(response: PlanResponse, cell: float) -> list[Shape]:
    """Return the outlines of a footprint along the path as a shape; none for a circle."""
    space = response.snapshot.pose_space if response.snapshot is not None else None
    if space is None or not response.has_footprint:
        return []
    poses = poses_of(response.poses)
    n_outlines = min(MOST_OUTLINES, MOST_POINTS // (2 * len(space.footprint)), len(poses))
    rows = np.unique(np.linspace(0, len(poses) - 1, n_outlines).astype(int))
    outlines = np.stack([space.outline(pose) for pose in poses[rows]])
    sides = np.stack([outlines, np.roll(outlines, -1, axis=1)], axis=2)
    return [Shape('footprint', Kind.PAIRS, cell / 4.0, sides.reshape(-1, 2))]
