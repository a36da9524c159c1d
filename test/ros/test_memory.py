"""Memory of a real node: what a large map took is given back when a small one comes."""

from pathlib import Path
from test.ros.harness import Client, grid_message, NodeProcess, points_of, pose, two_rooms, until

#: Cells of a side of the large map.
SIDE = 4000


def resident(planner: NodeProcess) -> int:
    """Return the bytes of memory that a process occupies."""
    status = Path(f'/proc/{planner.popen.pid}/status').read_text()
    (line,) = (line for line in status.splitlines() if line.startswith('VmRSS'))
    return 1024 * int(line.split()[1])


def plan_on(client: Client, planner: NodeProcess, side: int, resolution: float) -> None:
    """Publish a map of some cells of some size [m], and plan a path across it."""
    client.publish_map(grid_message(two_rooms(side, side, side // 4), resolution))
    until(lambda: f'of {resolution:g} m' in planner.log, 'the map')
    far = (side - 20) * resolution
    assert len(points_of(client.plan(pose(0.5, 0.6), pose(far, 0.7)))) > 2


def test_large_map_leaves_little_behind(client: Client, planner: NodeProcess) -> None:
    client.set_parameters(time_limit=600.0)
    plan_on(client, planner, 200, 0.05)
    before = resident(planner)
    for number in range(2):
        plan_on(client, planner, SIDE, 0.051 + 1e-4 * number)
        large = resident(planner)
        assert large - before > 5 * SIDE**2, 'the map and its space'
        plan_on(client, planner, 200, 0.052 + 1e-4 * number)
    # DDS keeps one buffer of the size of the largest message.
    until(lambda: resident(planner) - before < 3 * SIDE**2, 'memory that is given back')
