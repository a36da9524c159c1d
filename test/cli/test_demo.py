"""The demo as a whole: real nodes in real processes, and none of them left."""

from collections.abc import Iterator
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from test.cli.conftest import REAL_MAPS, ROOT
from test.cli.pictures import check_picture
from test.sweeps import sweep
import uuid

from hnr_planner import drawing
import pytest

pytest.importorskip('rclpy', reason='the demo needs ROS 2')

READY_WITHIN = 240.0
#: A real map of each kind but YAML, which the test of kept nodes has, for the whole demo;
#: test_demo_parts.py has the scenes of all.
OTHER_KINDS = list({file.suffix: file for file in REAL_MAPS if file.suffix != '.yaml'}.values())


class Demo:
    """One run of the demo; a mark in the environment identifies all its processes."""

    def __init__(self, folder: Path, *arguments: object) -> None:
        """Start it in a folder."""
        self.picture = folder / 'picture.png'
        self._mark = f'HNR_TEST_MARK={uuid.uuid4().hex}'
        name, value = self._mark.split('=')
        command = [sys.executable, '-m', 'hnr_planner', 'demo', '--out', self.picture, *arguments]
        self._process = subprocess.Popen(
            [str(word) for word in command],
            cwd=folder,
            env=os.environ | {name: value, 'PYTHONPATH': str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.lines: list[str] = []

    def read_until(self, pattern: str) -> str:
        """Read lines until one matches, and return it."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.lines.append(line)
            if re.search(pattern, line):
                return line
        raise AssertionError(f'no line matched {pattern!r}:\n{"".join(self.lines)}')

    def send(self, number: signal.Signals) -> None:
        """Send a signal to the demo itself."""
        self._process.send_signal(number)

    def finish(self) -> tuple[int, str]:
        """Wait for its end; return the exit code and all that it printed."""
        rest, _ = self._process.communicate(timeout=READY_WITHIN)
        return self._process.returncode, ''.join(self.lines) + rest

    def members(self, command: str = '') -> list[int]:
        """Return the ids of the processes of this demo whose command line contains a word."""
        found = []
        for folder in Path('/proc').glob('[0-9]*'):
            try:
                marked = self._mark in (folder / 'environ').read_text(errors='replace').split('\0')
                if marked and command in (folder / 'cmdline').read_text(errors='replace'):
                    found.append(int(folder.name))
            except OSError:  # ended meanwhile
                continue
        return found

    def end(self) -> None:
        """Kill all processes that are left."""
        for pid in self.members():
            os.kill(pid, signal.SIGKILL)
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()


@pytest.fixture
def start(tmp_path: Path) -> Iterator[object]:
    """Return a function that starts the demo."""
    demos: list[Demo] = []

    def start_demo(*arguments: object) -> Demo:
        demos.append(Demo(tmp_path, *arguments))
        return demos[-1]

    yield start_demo
    for demo in demos:
        demo.end()


def check_success(demo: Demo) -> None:
    """Check that a demo solved both requests, drew its picture, and left no process."""
    code, said = demo.finish()
    assert code == 0, said
    for algorithm in ('hit_and_run', 'rrt'):
        (row,) = re.findall(rf'^{algorithm} .*$', said, re.MULTILINE)
        assert re.search(r'SOLVED +[\d,]+ +[\d.]+ ms +[\d.]+ m +([\d.]+|inf) m +free, ', row), row
    assert 'Traceback' not in said
    check_picture(demo.picture, drawing.PATH, drawing.START, drawing.GOAL)
    assert demo.members() == []


def test_default_demo(start) -> None:
    demo = start()
    demo.read_until('robot radius 0.22 m')
    check_success(demo)


@pytest.mark.sweep
@pytest.mark.parametrize('file', OTHER_KINDS, ids=lambda file: file.name)
def test_demo_on_a_real_map(start, file: Path) -> None:
    check_success(start('--map', file))


# One handler takes them all: the others are sweeps.
@pytest.mark.parametrize(
    ('moment', 'number'),
    [
        sweep('robot radius', signal.SIGINT),
        sweep('starting the map source', signal.SIGHUP),
        ('preparing', signal.SIGTERM),
    ],
)
def test_interrupted_demo_leaves_nothing(start, moment: str, number: signal.Signals) -> None:
    demo = start()
    demo.read_until(moment)
    demo.send(number)
    code, said = demo.finish()
    assert code == 130, said
    assert 'interrupted' in said and 'Traceback' not in said
    assert demo.members() == []


def test_client_that_is_ended_while_it_starts_says_nothing_of_it() -> None:
    program = """
import os, signal, sys, time
from hnr_planner.demo import client
start = client.rclpy.init

def start_and_be_ended(**settings):
    start(**settings)
    os.kill(os.getpid(), signal.SIGTERM)
    while client.rclpy.ok():
        time.sleep(0.01)

client.rclpy.init = start_and_be_ended
sys.exit(client.main(['--start', '0', '0', '--goal', '1', '1']))
"""
    done = subprocess.run(
        [sys.executable, '-c', program], cwd=ROOT, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 130, done.stderr
    assert 'Traceback' not in done.stderr


@pytest.mark.parametrize(
    ('node', 'moment'),
    [
        sweep('map_node', 'ros2 service call', name='kept'),
        pytest.param('planner_node', 'planner  preparing', id='not yet asked'),
    ],
)
def test_death_of_a_node_is_reported(start, rooms_file: Path, node: str, moment: str) -> None:
    demo = start('--keep', '--map', rooms_file)
    demo.read_until(moment)
    (pid,) = demo.members(f'hnr_planner.ros.node.{node}')
    os.kill(pid, signal.SIGKILL)
    code, said = demo.finish()
    assert code == 1
    assert re.search(r'^failed: the (map|planner) died with exit code -9', said, re.MULTILINE)
    assert demo.members() == []


def test_kept_nodes_answer_until_the_end_on_a_turned_map_whose_name_is_hard_to_quote(
    start, rooms_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / "it's: a #map.yaml"
    image = next(path for path in rooms_file.parent.iterdir() if path.suffix != '.yaml')
    file.write_text(re.sub('image: .*', f'image: {image}', rooms_file.read_text()))
    demo = start('--keep', '--map', file)
    domain = demo.read_until('export ROS_DOMAIN_ID').split('ROS_DOMAIN_ID=')[1].split()[0]
    call = demo.read_until('demo.client --start').split()
    place = {'ROS_DOMAIN_ID': domain, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    asked = subprocess.run(
        call, cwd=ROOT, env=os.environ | place, capture_output=True, text=True, timeout=60
    )
    assert asked.returncode == 0, asked.stderr
    assert asked.stdout.count('SOLVED') == 2
    assert len(demo.members()) == 3
    demo.send(signal.SIGINT)
    check_success(demo)
