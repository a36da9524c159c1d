"""Responses of ``nav_msgs/GetPlan``, made from serialised bytes where rclpy sends these."""

from hnr_planner.ros.messages.from_bytes import kind_from_bytes, NOT_AS_EXPECTED
from hnr_planner.ros.messages.paths import path_message, serialised_path
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header


class PlanResponses:
    """
    Makes responses from arrays of poses, from serialised bytes where that works.

    The way from bytes depends on internals of rclpy. So at construction a small response is made
    both from bytes and with an object for each pose (the ordinary way). Where they differ, or the
    first cannot be made, all responses are made in the ordinary way, and ``why_slow`` is the
    reason; else ``why_slow`` is empty.
    """

    def __init__(self) -> None:
        self.why_slow = ''
        try:
            self._kind = kind_from_bytes(GetPlan.Response)
            self._check()
        except NOT_AS_EXPECTED as error:
            self.why_slow = f'{type(error).__name__}: {error}'

    def make(self, poses: NDArray[np.float64], header: Header, path: bytes) -> GetPlan.Response:
        """
        Return the response with poses (n, 7): x, y, z [m] and the quaternion x, y, z, w.

        ``path`` is ``serialised_path(poses, header)``.
        """
        if self.why_slow:
            return GetPlan.Response(plan=path_message(poses, header))
        response = self._kind()
        # The path is the only field: both are serialised alike.
        response.serialised = path
        return response

    def _check(self) -> None:
        """Raise ValueError unless a small response from bytes equals the one made pose by pose."""
        poses, header = np.arange(21.0).reshape(3, 7), Header(frame_id='map')
        ordinary = GetPlan.Response(plan=path_message(poses, header))
        made = self.make(poses, header, serialised_path(poses, header))
        if deserialize_message(serialize_message(made), GetPlan.Response) != ordinary:
            raise ValueError('a response from bytes differs from an ordinary one')
