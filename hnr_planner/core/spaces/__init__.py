"""Spaces: open, bounded sets of free points, with tests of membership and chords."""

from hnr_planner.core.spaces.ball import BallSpace
from hnr_planner.core.spaces.box import BoxSpace
from hnr_planner.core.spaces.callbacks import OracleError
from hnr_planner.core.spaces.difference import DifferenceSpace
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.mapped import MappedSpace
from hnr_planner.core.spaces.oracle import OracleSpace
from hnr_planner.core.spaces.polygon.polygon_space import PolygonSpace
from hnr_planner.core.spaces.polytope.polytope_space import PolytopeSpace
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
from hnr_planner.core.spaces.product import ProductSpace
from hnr_planner.core.spaces.rounded import RoundedSpace
from hnr_planner.core.spaces.sheared import ShearedSpace
from hnr_planner.core.spaces.space import Chord, Space
from hnr_planner.core.spaces.union import UnionSpace

__all__ = [
    'BallSpace',
    'BoxSpace',
    'Chord',
    'DifferenceSpace',
    'GridSpace',
    'MappedSpace',
    'OracleError',
    'OracleSpace',
    'PolygonSpace',
    'PolytopeSpace',
    'PoseSpace',
    'ProductSpace',
    'RoundedSpace',
    'ShearedSpace',
    'Space',
    'UnionSpace',
]
