"""
Results of actions that have a path, made from serialised bytes where rclpy sends these.

An action server of rclpy wraps a result into the response of a service of the action's type. Here
that type is replaced by one whose response is made from bytes.
"""

from typing import Any

from action_msgs.msg import GoalStatus
from hnr_planner.ros.messages.cdr import with_elements
from hnr_planner.ros.messages.from_bytes import kind_from_bytes, NOT_AS_EXPECTED
from hnr_planner.ros.messages.paths import path_message, POSE_BYTES
from nav_msgs.msg import Path
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header


class PathResults:
    """
    Makes results of an action from arrays of poses, from serialised bytes where that works.

    At construction a small result is made both from bytes and with an object for each pose (the
    ordinary way). Where they differ, or the first cannot be made, all results are made in the
    ordinary way, and ``why_slow`` is the reason; else ``why_slow`` is empty.

    Parameters
    ----------
    kind : type
        Type of the action, whose result has a field ``path``.

    Attributes
    ----------
    kind : type
        Type for the action server that sends the results.

    """

    def __init__(self, kind: Any) -> None:
        self._ordinary = kind
        self.why_slow = ''
        try:
            self._result = _result_kind(kind)
            self.kind = _action_kind(kind)
            self._check()
        except NOT_AS_EXPECTED as error:
            self.kind, self.why_slow = kind, f'{type(error).__name__}: {error}'

    def make(self, poses: NDArray[np.float64], header: Header, **fields: Any) -> Any:
        """
        Return the result with a path of poses (n, 7), and ``fields`` besides.

        A pose is x, y, z [m] and the quaternion x, y, z, w.
        """
        if self.why_slow:
            return self._ordinary.Result(path=path_message(poses, header), **fields)
        return self._result(poses, header, fields)

    def _check(self) -> None:
        """Raise ValueError unless a small result from bytes equals the one made pose by pose."""
        poses, header = np.arange(21.0).reshape(3, 7), Header(frame_id='map')
        kind = self._ordinary.Impl.GetResultService.Response
        ordinary = kind(
            status=GoalStatus.STATUS_ABORTED,
            result=self._ordinary.Result(path=path_message(poses, header), error_msg='why'),
        )
        response = self.kind.Impl.GetResultService.Response()
        response.status = ordinary.status
        response.result = self.make(poses, header, error_msg='why')
        if deserialize_message(serialize_message(response), kind) != ordinary:
            raise ValueError('a result from bytes differs from an ordinary one')


def _result_kind(kind: Any) -> Any:
    """Return a subclass of an action's result class that has an array of poses for its path."""

    class Result(kind.Result):
        # What rclpy's C code expects of a result.
        __module__ = kind.Result.__module__

        def __init__(
            self, poses: NDArray[np.float64], header: Header, fields: dict[str, Any]
        ) -> None:
            super().__init__(**fields)
            self.poses, self.header, self.fields = poses, header, fields

        @property
        def path(self) -> Path:
            """The path with an object for each pose, for whoever takes it in the ordinary way."""
            return path_message(self.poses, self.header)

        @path.setter
        def path(self, value: Path) -> None:
            """Ignore the empty path of the base class."""

        def with_poses(self, n_poses: int) -> Any:
            """Return the result with the first ``n_poses`` poses, in the ordinary way."""
            return kind.Result(path=path_message(self.poses[:n_poses], self.header), **self.fields)

    Result.__name__ = kind.Result.__name__
    return Result


def _action_kind(kind: Any) -> Any:
    """Return a subclass of an action's type whose results are sent from bytes."""
    ordinary = kind.Impl.GetResultService.Response
    base: Any = kind_from_bytes(ordinary)

    class Response(base):
        @property
        def serialised(self) -> bytes:
            """The response as bytes."""
            if not hasattr(self.result, 'poses'):  # as where there is no such goal
                return bytes(serialize_message(ordinary(status=self.status, result=self.result)))
            poses = self.result.poses
            short = [
                serialize_message(ordinary(status=self.status, result=self.result.with_poses(n)))
                for n in range(3)
            ]
            if len(poses) < len(short):
                return bytes(short[len(poses)])
            last_pose = poses[1].tobytes()
            n_after = len(short[2]) - short[2].rindex(last_pose) - len(last_pose)
            return with_elements(short, [(POSE_BYTES, poses)], n_after)

    class GetResultService(kind.Impl.GetResultService):
        pass

    class Impl(kind.Impl):
        pass

    class Action(kind):
        pass

    GetResultService.Response = Response
    Impl.GetResultService = GetResultService
    Action.Impl = Impl
    return Action
