"""Plan paths on occupancy maps by Hit-and-Run and RRT: a ROS 2 node and the library under it."""

__version__ = '0.1.0'
