"""
Responses of ``nav_msgs/GetPlan`` from serialised bytes, without an object for each pose.

rclpy turns a message into its C struct by a function that it finds on the message's class. The
class of responses here has another such function, which fills the struct from bytes by
``rmw_deserialize`` of the middleware. This takes milliseconds for ten thousand poses, without the
interpreter lock; the ordinary way, with an object for each pose, holds that lock ten times as
long.
"""

import ctypes

from hnr_planner.ros.messages.paths import path_message, serialised_path
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
import rclpy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.type_support import check_for_type_support
from std_msgs.msg import Header

#: The C signature of a function that fills a struct from a Python message.
_FromPython = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, ctypes.c_void_p)


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
            self._kind = _serialised_kind()
            self._check()
        except (AttributeError, OSError, RuntimeError, TypeError, ValueError) as error:
            self.why_slow = f'{type(error).__name__}: {error}'

    def make(self, poses: NDArray[np.float64], header: Header) -> GetPlan.Response:
        """Return the response with poses (n, 7): x, y, z [m] and the quaternion x, y, z, w."""
        if self.why_slow:
            return GetPlan.Response(plan=path_message(poses, header))
        response = self._kind()
        # The path is the only field: both are serialised alike.
        response.serialised = serialised_path(poses, header)
        return response

    def _check(self) -> None:
        """Raise ValueError when a small response from bytes differs from the ordinary one."""
        poses, header = np.arange(21.0).reshape(3, 7), Header(frame_id='map')
        ordinary = GetPlan.Response(plan=path_message(poses, header))
        made = deserialize_message(serialize_message(self.make(poses, header)), GetPlan.Response)
        if made != ordinary:
            raise ValueError('a response from bytes differs from an ordinary one')


class _Allocator(ctypes.Structure):
    """The C struct ``rcutils_allocator_t``."""

    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ('allocate', 'deallocate', 'reallocate', 'zero_allocate', 'state')
    ]


class _SerialisedMessage(ctypes.Structure):
    """The C struct ``rcutils_uint8_array_t``, the type of a serialised message."""

    _fields_ = [
        ('buffer', ctypes.c_char_p),
        ('buffer_length', ctypes.c_size_t),
        ('buffer_capacity', ctypes.c_size_t),
        ('allocator', _Allocator),
    ]


def _serialised_kind() -> type[GetPlan.Response]:
    """Return a class of responses that rclpy sends from their attribute ``serialised``."""
    check_for_type_support(GetPlan.Response)
    type_support = _pointer(type(GetPlan.Response)._TYPE_SUPPORT)
    deserialize = _middleware().rmw_deserialize
    deserialize.argtypes = [
        ctypes.POINTER(_SerialisedMessage),
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    deserialize.restype = ctypes.c_int32

    def fill(response: GetPlan.Response, struct: int) -> bool:
        data: bytes = response.serialised
        message = _SerialisedMessage(data, len(data), len(data), _Allocator())
        return bool(deserialize(ctypes.byref(message), type_support, struct) == 0)

    function = _FromPython(fill)

    class SerialisedResponse(GetPlan.Response):
        _CONVERT_FROM_PY = _capsule(ctypes.cast(function, ctypes.c_void_p))
        # Kept, since the capsule does not own it.
        _function = function

    return SerialisedResponse


def _middleware() -> ctypes.CDLL:
    """
    Return the library with ``rmw_deserialize``.

    It is ``librmw_implementation.so``, or, in a ROS from wheels, which lacks that, the library of
    the middleware itself.
    """
    try:
        return ctypes.CDLL('librmw_implementation.so')
    except OSError:
        return ctypes.CDLL(f'lib{rclpy.get_rmw_implementation_identifier()}.so')


def _pointer(capsule: object) -> int:
    """Return the address that a Python capsule (an object for a C pointer) holds."""
    name = ctypes.pythonapi.PyCapsule_GetName
    name.argtypes, name.restype = [ctypes.py_object], ctypes.c_char_p
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.argtypes, get.restype = [ctypes.py_object, ctypes.c_char_p], ctypes.c_void_p
    pointer: int = get(capsule, name(capsule))
    return pointer


def _capsule(pointer: ctypes.c_void_p) -> object:
    """Return a Python capsule, without a name, that holds ``pointer`` but does not own it."""
    new = ctypes.pythonapi.PyCapsule_New
    new.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    new.restype = ctypes.py_object
    capsule: object = new(pointer, None, None)
    return capsule
