"""Maps: files of map_server and of the Moving AI benchmarks, and generated maps."""

from hnr_planner.maps.building import building
from hnr_planner.maps.corridor import Corridor
from hnr_planner.maps.errors import MapFileError, MapFileWarning
from hnr_planner.maps.loading import is_moving_ai, load_map
from hnr_planner.maps.map_server import save_map
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
from hnr_planner.maps.spiral import spiral
from hnr_planner.maps.two_turns import serpentine, zigzag

__all__ = [
    'FREE',
    'OCCUPIED',
    'UNKNOWN',
    'Corridor',
    'MapFileError',
    'MapFileWarning',
    'OccupancyMap',
    'building',
    'is_moving_ai',
    'load_map',
    'save_map',
    'serpentine',
    'spiral',
    'zigzag',
]
