"""
Run the planning node with responses that have an object for each pose.

``python -m benchmarks.node_of_objects --ros-args ...`` is the node as rclpy alone would send.
"""

from __future__ import annotations

from typing import Any

from hnr_planner.ros.messages import plan_responses
from hnr_planner.ros.node.planner_node import main


def _refuse(_kind: Any) -> Any:
    raise RuntimeError('objects are measured')


if __name__ == '__main__':
    plan_responses.kind_from_bytes = _refuse
    main()
