"""
Messages that rclpy sends from serialised bytes, without an object for each pose.

rclpy turns a message into its C struct by a function that it finds on the message's class. The
classes here have another such function, which fills the struct from bytes by ``rmw_deserialize``
of the middleware. This takes milliseconds for ten thousand poses, without the interpreter lock;
the ordinary way, with an object for each pose, holds that lock ten times as long.
"""

import ctypes
from typing import Any

import rclpy
from rclpy.type_support import check_for_type_support

#: The C signature of a function that fills a struct from a Python message.
_FromPython = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, ctypes.c_void_p)

#: What a ROS raises at one of the internals that is not as it is used here.
NOT_AS_EXPECTED = (AttributeError, OSError, RuntimeError, TypeError, ValueError)


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


def kind_from_bytes(kind: Any) -> Any:
    """
    Return a subclass of a message class whose objects rclpy sends from their ``serialised``.

    ``serialised`` is an attribute or property of the objects: a message of ``kind`` as bytes. The
    fields of the objects are not sent.

    Raises
    ------
    AttributeError, OSError, RuntimeError, TypeError, ValueError
        When rclpy or the middleware lack one of the internals that this needs: see
        ``NOT_AS_EXPECTED``.

    """
    check_for_type_support(kind)
    type_support = _pointer(type(kind)._TYPE_SUPPORT)
    deserialize = _middleware().rmw_deserialize
    deserialize.argtypes = [
        ctypes.POINTER(_SerialisedMessage),
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    deserialize.restype = ctypes.c_int32

    def fill(message: Any, struct: int) -> bool:
        data: bytes = message.serialised
        source = _SerialisedMessage(data, len(data), len(data), _Allocator())
        return bool(deserialize(ctypes.byref(source), type_support, struct) == 0)

    function = _FromPython(fill)

    class FromBytes(kind):
        _CONVERT_FROM_PY = _capsule(ctypes.cast(function, ctypes.c_void_p))
        # Kept, since the capsule does not own it.
        _function = function

    return FromBytes


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
