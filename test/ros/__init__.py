"""Tests of the nodes; messages check their fields here, so no wrong number type goes unseen."""

import os

# Read when the first message type is imported, in this process and in each of its children.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
