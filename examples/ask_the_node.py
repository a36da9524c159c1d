"""
Ask the node, and read the reason
=================================

A ROS client: it calls ``~/plan``, and where the path is empty it prints why. It needs a running
``planner_node``, which ``hnr-planner demo --keep`` starts; the picture is from such a run.

.. image:: /_static/ask_the_node.png
"""

# sphinx_gallery_thumbnail_path = '_static/ask_the_node.png'
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, Pose, PoseStamped
from hnr_planner.drawing import draw_map, draw_path
from hnr_planner.ros.messages.maps import map_from_message
from matplotlib import pyplot as plt
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile

rclpy.init()
node, grids, outcomes = rclpy.create_node('client'), [], []
latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(OccupancyGrid, 'map', grids.append, latched)
node.create_subscription(DiagnosticArray, 'hnr_planner/outcome', outcomes.append, latched)
client = node.create_client(GetPlan, 'hnr_planner/plan')
client.wait_for_service()
figure, axes = plt.subplots(figsize=(8, 6))
start = PoseStamped(pose=Pose(position=Point(x=3.0, y=22.0)))
for goal in (Point(x=34.0, y=5.0), Point(x=-50.0, y=0.0)):  # the second lies outside the map
    request = GetPlan.Request(start=start, goal=PoseStamped(pose=Pose(position=goal)))
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future)
    answer = future.result().plan
    while answer.header.stamp not in (stamps := [each.header.stamp for each in outcomes]):
        rclpy.spin_once(node)
    (status,) = outcomes[stamps.index(answer.header.stamp)].status
    why = {item.key: item.value for item in status.values}['why']
    print(f'({goal.x:g}, {goal.y:g}): {len(answer.poses)} poses, {status.message}: {why}')
    draw_path(axes, [(each.pose.position.x, each.pose.position.y) for each in answer.poses])
while not grids:
    rclpy.spin_once(node)
draw_map(axes, map_from_message(grids[-1]))
plt.show()
