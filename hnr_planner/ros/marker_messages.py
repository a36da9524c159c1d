"""`visualization_msgs/MarkerArray`: a search as a person wants to see it in RViz."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Vector3
from hnr_planner.core import PlanResult
from hnr_planner.ros.requests import Report, Request
from hnr_planner.ros.sample_cap import shown_samples
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

MOST_POINTS = 10_000
"""Points in one marker: more takes longer to draw than it helps to see."""

SAMPLES = ColorRGBA(r=0.10, g=0.45, b=0.85, a=0.9)
EDGES = ColorRGBA(r=0.45, g=0.65, b=0.90, a=0.5)
PATH = ColorRGBA(r=0.90, g=0.25, b=0.10, a=1.0)
START = ColorRGBA(r=0.10, g=0.65, b=0.25, a=1.0)
GOAL = ColorRGBA(r=0.75, g=0.10, b=0.55, a=1.0)


def markers_message(report: Report, stamp: Time) -> MarkerArray:
    """
    Return samples, tree or chain, path, start and goal of a solved request.

    The first marker deletes those of the request before; after a failure it stands alone.
    """
    header = Header(stamp=stamp, frame_id=report.frame)
    markers = [Marker(header=header, action=Marker.DELETEALL)]
    if report.solved and report.result is not None and report.snapshot is not None:
        cell = report.snapshot.grid.resolution
        shapes = _search_shapes(report.result, cell) + _request_shapes(report.request, cell)
        for shape in shapes:
            shape.header = header
        markers += shapes
    return MarkerArray(markers=markers)


def _search_shapes(result: PlanResult, cell: float) -> list[Marker]:
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
        _shape('samples', Marker.POINTS, SAMPLES, Vector3(x=cell, y=cell), samples[dots.rows]),
        _shape('tree', Marker.LINE_LIST, EDGES, Vector3(x=cell / 4.0), edges),
        _shape('path', Marker.LINE_STRIP, PATH, Vector3(x=cell), path),
    ]


def _request_shapes(request: Request, cell: float) -> list[Marker]:
    """Return the start and the goal asked for."""
    size = Vector3(x=4.0 * cell, y=4.0 * cell, z=4.0 * cell)
    shapes = []
    for name, colour, pose in (
        ('start', START, request.start),
        ('goal', GOAL, request.goal),
    ):
        marker = _shape(name, Marker.SPHERE, colour, size, np.empty((0, 2)))
        marker.pose.position.x, marker.pose.position.y = pose.point
        shapes.append(marker)
    return shapes


def _shape(
    name: str, kind: int, colour: ColorRGBA, size: Vector3, points: NDArray[np.float64]
) -> Marker:
    """Return one marker under its own name; its header is still to be set."""
    pose = Pose()
    pose.orientation.w = 1.0
    return Marker(
        ns=name,
        id=0,
        type=int(kind),
        action=Marker.ADD,
        pose=pose,
        scale=size,
        color=colour,
        points=[Point(x=x, y=y, z=0.0) for x, y in points.tolist()],
    )
