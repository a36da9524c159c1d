"""
Ask the node, and read the reason
=================================

A ROS client: it calls ``~/plan``, and where the path is empty it prints why. It needs ROS 2 and a
running ``planner_node``; so there is no picture here.
"""

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, Pose, PoseStamped
from nav_msgs.srv import GetPlan
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Header

rclpy.init()
node = rclpy.create_node('client')
outcomes = {}
latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(
    DiagnosticArray,
    'hnr_planner/outcome',
    lambda message: outcomes.update({str(message.header.stamp): message.status[0]}),
    latched,
)
client = node.create_client(GetPlan, 'hnr_planner/plan')
client.wait_for_service()


def pose(x, y):
    return PoseStamped(
        header=Header(frame_id='map'), pose=Pose(position=Point(x=float(x), y=float(y)))
    )


for goal in ((34, 5), (-50, 0)):  # the second lies outside the map
    future = client.call_async(GetPlan.Request(start=pose(3, 22), goal=pose(*goal)))
    rclpy.spin_until_future_complete(node, future)
    answer = future.result().plan
    while (stamp := str(answer.header.stamp)) not in outcomes:
        rclpy.spin_once(node)
    why = {item.key: item.value for item in outcomes[stamp].values}['why']
    print(f'{goal}: {len(answer.poses)} poses, {outcomes[stamp].message}: {why}')
rclpy.shutdown()
