"""Pictures are made for subscribers that are there, and late ones get the last of them."""

from pathlib import Path
from test.ros.harness import Client, grid_message, node_process, pose, two_rooms
from test.ros.soak.callers import callers

from nav_msgs.srv import GetPlan


def test_picture_of_a_request_that_nobody_watched_comes_with_the_first_subscriber(
    tmp_path: Path,
) -> None:
    with node_process('planner_node', tmp_path / 'log') as planner, callers(1) as (caller,):
        publisher = Client()
        publisher.publish_map(grid_message(two_rooms()))
        planner.wait_for('map received')
        publisher.close()
        request = GetPlan.Request(start=pose(0.5, 0.6), goal=pose(4.5, 0.7))
        for _ in range(2):
            path = caller.ask(request).path
        late = Client()
        try:
            assert late.stamped(late.clouds, path).width > 0
            assert late.stamped(late.markers, path).markers
            assert len(late.clouds) == len(late.markers) == 1, 'no picture of the first request'
        finally:
            late.close()
