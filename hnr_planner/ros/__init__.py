"""The ROS nodes: they translate between messages and the library, and do nothing else."""
