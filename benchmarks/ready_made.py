"""
Run a node that sends a ready-made path: ``python -m benchmarks.ready_made N_POSES``.

Its time is what rclpy itself needs for an answer: it takes a request, and sends a message that
existed before. Its executor has threads, as that of every node that stays responsive.
"""

from __future__ import annotations

import sys

from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlan
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

NAME = 'ready_made'


def main(n_poses: int) -> None:
    """Serve until the process is killed."""
    answer = GetPlan.Response()
    answer.plan.header.frame_id = 'map'
    for _ in range(n_poses):
        pose = PoseStamped(header=answer.plan.header)
        pose.pose.orientation.w = 1.0
        answer.plan.poses.append(pose)
    rclpy.init()
    node = Node(NAME)
    node.create_service(GetPlan, '~/plan', lambda _request, _response: answer)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    executor.spin()


if __name__ == '__main__':
    main(int(sys.argv[1]))
