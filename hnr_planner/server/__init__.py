"""
What a planning server decides, free of ROS: from requests to responses.

``PlanningServer`` is the way in; ``settings`` is the one table of parameters.
"""
