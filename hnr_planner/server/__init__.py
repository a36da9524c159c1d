"""
The planning server without ROS: everything between a request and its response.

``PlanningServer`` is the class to use. A request passes the folders ``requests`` (is it well
formed?), ``map`` (is there a map?), ``planning`` (the search), ``routes`` (is the last path kept?)
and ``responses``; ``validity`` checks the path again when the map changes. ``parameters`` has the
table of all parameters.
"""
