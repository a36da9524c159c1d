"""What holds for every test: set before the first message class is imported."""

import os

# Without these checks a field of the wrong type goes out as garbage, silently.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
# No test talks to another machine.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
