"""The profile for Fast DDS that the launch file uses: room for large clouds, and all arrives."""

from pathlib import Path
from test.ros.harness import Client, grid_message, node_process, pose, two_rooms
from xml.etree import ElementTree

from hnr_planner.ros.messages.samples import LAYOUT
from hnr_planner.server.parameters.settings import DEFAULTS
import pytest
import rclpy

PROFILE = Path(__file__).parents[2] / 'config' / 'fastdds.xml'
SHARED_MEMORY = Path('/dev/shm')


def segment_size() -> int:
    """Return the size of the shared memory in the profile."""
    sizes = [e.text for e in ElementTree.parse(PROFILE).iter() if e.tag.endswith('segment_size')]
    (size,) = sizes
    return int(size or 0)


def test_several_largest_clouds_fit() -> None:
    assert segment_size() > 10 * DEFAULTS.samples_max * LAYOUT.itemsize


def test_node_with_the_profile_has_that_room_and_is_heard_by_one_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if 'fastrtps' not in rclpy.get_rmw_implementation_identifier():
        pytest.skip('the profile is for Fast DDS')
    before = set(SHARED_MEMORY.iterdir())
    monkeypatch.setenv('FASTRTPS_DEFAULT_PROFILES_FILE', str(PROFILE))
    with node_process('planner_node', tmp_path / 'log') as process:
        monkeypatch.delenv('FASTRTPS_DEFAULT_PROFILES_FILE')
        made = set(SHARED_MEMORY.iterdir()) - before
        assert any(path.stat().st_size >= segment_size() for path in made if path.exists())
        client = Client()
        try:
            client.publish_map(grid_message(two_rooms()))
            process.wait_for('map received')
            path = client.plan(pose(0.5, 0.6), pose(4.5, 0.7))
            assert len(path.poses) > 2
            assert client.stamped(client.clouds, path).width > 0
        finally:
            client.close()
