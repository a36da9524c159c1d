"""Searches as ``visualization_msgs/MarkerArray``, for RViz."""

from geometry_msgs.msg import Pose, Vector3
from hnr_planner.ros.messages.cdr import ONE_POINT, with_points
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.shapes import Kind, search_shapes, Shape
from rclpy.serialization import serialize_message
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

#: The colour of each shape, by the name of the shape.
COLOURS = {
    'samples': ColorRGBA(r=0.10, g=0.45, b=0.85, a=0.9),
    'tree': ColorRGBA(r=0.45, g=0.65, b=0.90, a=0.5),
    'alternatives': ColorRGBA(r=0.90, g=0.60, b=0.10, a=0.8),
    'path': ColorRGBA(r=0.90, g=0.25, b=0.10, a=1.0),
    'footprint': ColorRGBA(r=0.90, g=0.45, b=0.20, a=0.35),
    'start': ColorRGBA(r=0.10, g=0.65, b=0.25, a=1.0),
    'goal': ColorRGBA(r=0.75, g=0.10, b=0.55, a=1.0),
}

#: The marker type of each kind of shape, and how many of the marker's scales x, y, z are set to
#: the size of the shape; the others are 0.
TYPES = {
    Kind.POINTS: (Marker.POINTS, 2),
    Kind.PAIRS: (Marker.LINE_LIST, 1),
    Kind.LINE: (Marker.LINE_STRIP, 1),
    Kind.BALL: (Marker.SPHERE, 3),
}


def serialised_markers(response: PlanResponse, header: Header) -> bytes:
    """
    Return a serialised MarkerArray of samples, tree, path and ends of a solved request.

    The first marker deletes the markers of earlier requests; after a failure it is the only one.
    """
    shapes = search_shapes(response)
    clear = Marker(header=header, action=Marker.DELETEALL)
    markers = MarkerArray(markers=[clear, *(_marker(shape, header) for shape in shapes)])
    return with_points(
        serialize_message(markers), [shape.points for shape in shapes if _has_points(shape)]
    )


def _has_points(shape: Shape) -> bool:
    """Return whether the marker of a shape has any points; that of a ball has a pose instead."""
    return shape.kind is not Kind.BALL and len(shape.points) > 0


def _marker(shape: Shape, header: Header) -> Marker:
    """Return the marker of a shape, with ``ONE_POINT`` as a placeholder for any points."""
    kind, n_scales = TYPES[shape.kind]
    pose = Pose()
    pose.orientation.w = 1.0
    if shape.kind is Kind.BALL:
        pose.position.x, pose.position.y = shape.points[0].tolist()
    size = float(shape.size)
    return Marker(
        header=header,
        ns=shape.name,
        id=0,
        type=int(kind),
        action=Marker.ADD,
        pose=pose,
        scale=Vector3(**dict.fromkeys('xyz'[:n_scales], size)),
        color=COLOURS[shape.name],
        points=[ONE_POINT] if _has_points(shape) else [],
    )
