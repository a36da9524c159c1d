"""The launch file, with real nodes, where launch is installed; and the layout of RViz."""

from collections.abc import Iterator
from contextlib import contextmanager
from distutils.core import run_setup  # with setuptools, also on Python 3.12
import os
from pathlib import Path
import shutil
import signal
import subprocess
import sys
from test.ros.harness import Client, pose, until
from test.ros.transitions import ACTIVE, state, UNCONFIGURED
from typing import Any

from hnr_planner.server.requests.outcomes import Outcome
import pytest
import yaml

ROOT = Path(__file__).parents[2]
OFFICE = ROOT / 'config' / 'maps' / 'office.yaml'
LAYOUT = yaml.safe_load((ROOT / 'config' / 'hnr_planner.rviz').read_text())

#: What ``ros2 launch`` does, for those who have launch but not ros2cli.
PROGRAM = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
service = LaunchService()
arguments = [tuple(word.split(':=')) for word in sys.argv[2:]]
service.include_launch_description(LaunchDescription([
    IncludeLaunchDescription(sys.argv[1], launch_arguments=arguments)
]))
sys.exit(service.run())
"""


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install what pip and colcon install besides the modules; return where."""
    pytest.importorskip('launch_ros', reason='launch and launch_ros come with a ROS from apt only')
    monkeypatch.chdir(ROOT)
    for folder, names in run_setup('setup.py', stop_after='init').data_files:
        for name in names:
            (tmp_path / folder).mkdir(parents=True, exist_ok=True)
            shutil.copy(name, tmp_path / folder)
    return tmp_path


@contextmanager
def launched(prefix: Path, *arguments: str) -> Iterator[Path]:
    """Run the launch file for the length of a ``with`` block; return its log."""
    paths = {
        'AMENT_PREFIX_PATH': [str(prefix)],
        'PATH': [str(Path(sys.executable).parent)],
        'PYTHONPATH': [str(ROOT)],
    }
    env = dict(os.environ)
    for name, entries in paths.items():
        env[name] = os.pathsep.join(entries + env.get(name, '').split(os.pathsep)).strip(':')
    log = prefix / 'launch_log'
    file = prefix / 'share/hnr_planner/launch/planner.launch.py'
    with log.open('w') as output:
        process = subprocess.Popen(
            [sys.executable, '-c', PROGRAM, str(file), *arguments],
            env=env,
            stdout=output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
    try:
        yield log
        process.send_signal(signal.SIGINT)
        assert process.wait(20.0) == 0, log.read_text()
        assert 'Traceback' not in log.read_text()
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait(5.0)


def said(log: Path, words: str) -> None:
    """Wait until a node has said something."""
    until(lambda: words in log.read_text(), lambda: f'"{words}" in\n{log.read_text()}', 60.0)


def test_planner_with_a_map_plans_in_its_namespace(prefix: Path) -> None:
    with launched(prefix, f'map:={OFFICE}', 'namespace:=robot') as log:
        said(log, 'map received')
        client = Client('/robot/hnr_planner')
        assert state(client, '/robot/hnr_planner') == ACTIVE
        path = client.plan(pose(3.0, 2.0), pose(12.0, 8.0))
        assert client.outcome_of(path)[0] is Outcome.SOLVED
        assert client.get_parameters('rviz_clicks', 'autostart') == [False, True]
        client.close()


def test_autostart_is_handed_on_and_no_transition_is_sent(prefix: Path, tmp_path: Path) -> None:
    parameters = tmp_path / 'own.yaml'
    parameters.write_text('/**/hnr_planner: {ros__parameters: {robot_radius: 0.3}}\n')
    words = 'autostart:=false', 'rviz_clicks:=true', f'params_file:={parameters}'
    with launched(prefix, *words) as log:
        said(log, 'unconfigured')
        client = Client()
        assert state(client) == UNCONFIGURED
        assert client.outcome_of(client.plan(pose(1, 1), pose(2, 2)))[0] is Outcome.NOT_ACTIVE
        values = client.get_parameters('rviz_clicks', 'autostart', 'robot_radius')
        assert values == [True, False, 0.3]
        assert state(client) == UNCONFIGURED
        client.close()


def topics(part: Any) -> Iterator[str]:
    """Yield the topics that a part of the layout names."""
    if isinstance(part, dict):
        for name, value in part.items():
            if name.endswith('Topic') and isinstance(value, dict):
                yield value['Value']
            else:
                yield from topics(value)
    elif isinstance(part, list):
        for item in part:
            yield from topics(item)


def test_layout_shows_what_the_node_publishes_and_takes_clicks() -> None:
    launch_file = (ROOT / 'launch' / 'planner.launch.py').read_text()
    named = set(topics(LAYOUT))
    assert {
        '/map',
        '/hnr_planner/samples',
        '/hnr_planner/markers',
        '/hnr_planner/path',
        '/initialpose',
        '/goal_pose',
    } <= named
    # Each follows the namespace.
    assert all(f"'{topic}'" in launch_file for topic in named)
