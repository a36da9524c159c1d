"""The example of a ROS client asks a real node, and reads the reason where there is no path."""

import os
from pathlib import Path
import subprocess
import sys
from test.ros.harness import node_process, NodeProcess

ROOT = Path(__file__).parents[3]


def test_the_client_gets_a_path_and_a_reason(planner: NodeProcess, tmp_path: Path) -> None:
    office = ROOT / 'config' / 'maps' / 'office.yaml'
    with node_process('map_node', tmp_path / 'log', yaml_filename=office):
        planner.wait_for('map received')
        done = subprocess.run(
            [sys.executable, ROOT / 'examples' / 'ask_the_node.py'],
            env={**os.environ, 'PYTHONPATH': str(ROOT), 'MPLBACKEND': 'agg'},
            capture_output=True,
            text=True,
            timeout=120,
        )
    assert done.returncode == 0, done.stderr
    found, failed = done.stdout.splitlines()
    assert found.startswith('(34, 5): ') and 'SOLVED' in found and '(34, 5): 0 poses' not in found
    assert failed.startswith('(-50, 0): 0 poses, INVALID_GOAL: ')
