"""
Ask as fast as answers come, with clients that leave answers as they are.

``python -m benchmarks.raw_clients N_CLIENTS SECONDS X Y X Y`` prints the answers a second to
requests from one point to another. An answer is received by the middleware, and no Python
object is made of it.
"""

from __future__ import annotations

import ctypes
import sys
from test.ros.harness import MANY, pose, SOON
import threading
import time

from nav_msgs.srv import GetPlan
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.type_support import check_for_type_support

#: The C signature of a function that makes a Python object of a struct.
_ToPython = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)


def raw_service() -> type:
    """Return the type of the service with responses that stay structs of the middleware."""
    check_for_type_support(GetPlan)
    received = _ToPython(lambda _struct: True)
    new = ctypes.pythonapi.PyCapsule_New
    new.argtypes, new.restype = (
        [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p],
        ctypes.py_object,
    )

    class Raw(type(GetPlan.Response)):  # type: ignore[misc]
        """Where rclpy looks for the functions of a message."""

        _CONVERT_TO_PY = new(ctypes.cast(received, ctypes.c_void_p), None, None)
        _function = received

    class Response(GetPlan.Response, metaclass=Raw):
        pass

    class RawPlan(GetPlan):
        pass

    RawPlan.Response = Response
    return RawPlan


def main(n_clients: int, seconds: float, *ends: float) -> None:
    """Print the answers a second that all clients get together."""
    rclpy.init()
    kind = raw_service()
    request = GetPlan.Request(start=pose(*ends[:2]), goal=pose(*ends[2:]))
    counts, begin = [0] * n_clients, threading.Barrier(n_clients + 1)
    ended = threading.Event()

    def ask(number: int) -> None:
        node = Node(f'raw_{number}', enable_rosout=False)
        client = node.create_client(kind, '/hnr_planner/plan', qos_profile=MANY)
        assert client.wait_for_service(SOON)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        time.sleep(1.0)  # discovery
        begin.wait()
        while not ended.is_set():
            future = client.call_async(request)
            deadline = time.monotonic() + SOON
            while not future.done() and time.monotonic() < deadline:
                executor.spin_once(timeout_sec=SOON)
            counts[number] += future.done() and future.result() is True  # no object of it

    threads = [threading.Thread(target=ask, args=(k,), daemon=True) for k in range(n_clients)]
    for thread in threads:
        thread.start()
    begin.wait()
    began = time.monotonic()
    time.sleep(seconds)
    total, took = sum(counts), time.monotonic() - began
    ended.set()
    for thread in threads:
        thread.join(SOON)
    print(total / took)
    rclpy.try_shutdown()


if __name__ == '__main__':
    main(int(sys.argv[1]), *map(float, sys.argv[2:]))
