"""
The planning server without ROS: everything between a request and its response.

``PlanningServer`` is the class to use; the module ``settings`` has the table of all parameters.
"""
