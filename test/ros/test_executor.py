"""Nodes of this package survive that their own parts are destroyed while the executor looks."""

import subprocess
import sys

SCRIPT = """
import os
import signal
import sys
import threading
import time

from hnr_planner.ros.node.process import run
from rclpy.node import Node
from std_msgs.msg import Bool


sys.setswitchinterval(1e-6)  # threads take turns often: the race is narrow


class Churn(Node):
    def __init__(self):
        super().__init__('churn')
        self.create_timer(0.001, lambda: None)
        threading.Thread(target=self.churn, daemon=True).start()

    def churn(self):
        until = time.monotonic() + 3.0
        while time.monotonic() < until:
            parts = [self.create_subscription(Bool, 'topic', print, 1) for _ in range(5)]
            for part in parts:
                self.destroy_subscription(part)
        os.kill(os.getpid(), signal.SIGTERM)


sys.exit(run('churn', Churn, threads=3))
"""


def test_subscriptions_that_come_and_go_do_not_end_the_node() -> None:
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert 'Traceback' not in done.stderr
