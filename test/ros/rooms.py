"""Two rooms, turned and moved in the frame of the map, and a way from one to the other."""

from functools import partial
from test.ros.harness import from_corner, two_rooms

RESOLUTION, ORIGIN = 0.05, (-2.0, 1.0, 0.4)
DATA = two_rooms()
in_map = partial(from_corner, ORIGIN)
START, GOAL = in_map(0.5, 0.6), in_map(4.5, 0.7)
