"""Transforms of poses from their own frames to the map's, by ``tf2`` where it is installed."""

from dataclasses import replace

from hnr_planner.server.geometry.orientations import LEVEL, normalised, product, rotated
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import Pose
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time

try:
    from tf2_ros import Buffer, TransformException, TransformListener
except ImportError:  # a ROS from wheels has none
    HAVE_TF = False
else:
    HAVE_TF = True


class Transforms:
    """
    Transforms poses; subscribes to transforms from construction to ``close``.

    Without ``tf2`` there are no transforms: a pose in another frame than the map's is refused.
    """

    def __init__(self, node: Node) -> None:
        if HAVE_TF:
            self._buffer = Buffer()
            self._listener = TransformListener(self._buffer, node)

    def close(self) -> None:
        """End the subscription to transforms."""
        if HAVE_TF:
            self._listener.unregister()

    def transform(self, pose: Pose, frame: str, patience: float) -> Pose:
        """
        Return ``pose`` transformed to ``frame``, with its orientation at norm 1.

        A pose whose frame is empty or ``frame`` keeps its numbers. The transform is that at the
        stamp of the pose; wait up to ``patience`` [s] for it.

        Raises
        ------
        Refusal
            BAD_FRAME when no transform came; its words continue a sentence that begins with the
            name of the pose.

        """
        if not HAVE_TF or pose.frame in ('', frame):
            return only_same_frame(pose, frame)
        try:
            found = self._buffer.lookup_transform(
                frame,
                pose.frame,
                Time(nanoseconds=pose.stamp),
                timeout=Duration(seconds=patience),
            ).transform
        except TransformException as error:
            raise Refusal(
                Outcome.BAD_FRAME,
                f"is in frame '{pose.frame}', the map in '{frame}', and no transform leads from "
                f'one to the other within {patience:g} s: {" ".join(str(error).split())}',
            ) from error
        shift, turn = found.translation, found.rotation
        rotation = normalised((turn.x, turn.y, turn.z, turn.w)) or LEVEL
        x, y, z = rotated(pose.position, rotation)
        return replace(
            pose,
            position=(x + shift.x, y + shift.y, z + shift.z),
            orientation=product(rotation, normalised(pose.orientation) or LEVEL),
            frame=frame,
        )
