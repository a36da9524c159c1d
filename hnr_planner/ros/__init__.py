"""The ROS nodes, which translate between ROS messages and the package, and decide nothing."""
