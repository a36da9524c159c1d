"""`visualization_msgs/MarkerArray`: a search as a person wants to see it in RViz."""

import math
from typing import NamedTuple

from geometry_msgs.msg import Point, Pose, Vector3
from hnr_planner.core.planning.result import SearchResult
from hnr_planner.server.requests import PlanRequest
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.subsample import shown_samples
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

MOST_POINTS = 10_000
"""Points in one marker: more takes longer to draw than it helps to see."""

SAMPLES = ColorRGBA(r=0.10, g=0.45, b=0.85, a=0.9)
EDGES = ColorRGBA(r=0.45, g=0.65, b=0.90, a=0.5)
PATH = ColorRGBA(r=0.90, g=0.25, b=0.10, a=1.0)
START = ColorRGBA(r=0.10, g=0.65, b=0.25, a=1.0)
GOAL = ColorRGBA(r=0.75, g=0.10, b=0.55, a=1.0)


def serialised_markers(report: PlanResponse, header: Header) -> bytes:
    """
    Return samples, tree or chain, path, start and goal of a solved request, a MarkerArray.

    The first marker deletes those of the request before; after a failure it stands alone. The
    message is in its serialised form, without an object for each point.
    """
    markers, drawn = [Marker(header=header, action=Marker.DELETEALL)], []
    if report.solved and report.result is not None and report.snapshot is not None:
        cell = report.snapshot.grid.resolution
        shapes = [*_search_shapes(report.result, cell), *_request_shapes(report.request, cell)]
        markers += [_marker(shape, header) for shape in shapes]
        drawn = [shape.points for shape in shapes if len(shape.points) > 0]
    return _with_points(serialize_message(MarkerArray(markers=markers)), drawn)


class _Shape(NamedTuple):
    """What is drawn under a name: at a place, or through points (n, 2)."""

    name: str
    kind: int
    colour: ColorRGBA
    size: Vector3
    points: NDArray[np.float64] = np.empty((0, 2))
    place: tuple[float, float] = (0.0, 0.0)


def _search_shapes(result: SearchResult, cell: float) -> list[_Shape]:
    """Return the samples, the edges between them and the path."""
    samples, parents = result.samples, result.parents
    dots = shown_samples(parents, MOST_POINTS)
    # An edge has two points.
    tree = shown_samples(parents, MOST_POINTS // 2)
    children = np.flatnonzero(tree.parents >= 0)
    nodes = samples[tree.rows]
    edges = np.stack([nodes[tree.parents[children]], nodes[children]], axis=1).reshape(-1, 2)
    path = result.path
    if len(path) > MOST_POINTS:
        path = path[np.linspace(0, len(path) - 1, MOST_POINTS).astype(int)]
    return [
        _Shape('samples', Marker.POINTS, SAMPLES, Vector3(x=cell, y=cell), samples[dots.rows]),
        _Shape('tree', Marker.LINE_LIST, EDGES, Vector3(x=cell / 4.0), edges),
        _Shape('path', Marker.LINE_STRIP, PATH, Vector3(x=cell), path),
    ]


def _request_shapes(request: PlanRequest, cell: float) -> list[_Shape]:
    """Return the start and the goal asked for."""
    size = Vector3(x=4.0 * cell, y=4.0 * cell, z=4.0 * cell)
    return [
        _Shape('start', Marker.SPHERE, START, size, place=request.start.point),
        _Shape('goal', Marker.SPHERE, GOAL, size, place=request.goal.point),
    ]


def _marker(shape: _Shape, header: Header) -> Marker:
    """Return the marker of a shape, with `_ONE_POINT` for its points."""
    pose = Pose()
    pose.position.x, pose.position.y = shape.place
    pose.orientation.w = 1.0
    return Marker(
        header=header,
        ns=shape.name,
        id=0,
        type=int(shape.kind),
        action=Marker.ADD,
        pose=pose,
        scale=shape.size,
        color=shape.colour,
        points=[_ONE_POINT] if len(shape.points) > 0 else [],
    )


_ONE_POINT = Point(x=math.nan, y=math.nan, z=math.nan)
_ITS_BYTES = np.full(3, math.nan).tobytes()
"""Found nowhere else in a serialised message: numbers are finite, and strings hold no zeros."""


def _with_points(serialised: bytes, sequences: list[NDArray[np.float64]]) -> bytes:
    """
    Return serialised markers with all points (n, 2) for each `_ONE_POINT`, in their order.

    The four bytes before it say how many there are: what stands before them in a marker ends at
    a multiple of eight bytes, less four, so nothing lies between. A point has three times eight
    bytes, so all that follows stays aligned.
    """
    parts, done = [], 0
    for points in sequences:
        place = serialised.index(_ITS_BYTES, done)
        count = place - 4
        rows = np.zeros((len(points), 3))
        rows[:, :2] = points
        parts += [serialised[done:count], np.uint32(len(rows)).tobytes(), rows.tobytes()]
        done = place + len(_ITS_BYTES)
    return b''.join([*parts, serialised[done:]])
