"""Maps: files of map_server and of the Moving AI benchmarks, and maps that we generate."""

from hnr_planner.maps.building import building
from hnr_planner.maps.errors import MapFileError
from hnr_planner.maps.loading import load_map
from hnr_planner.maps.map_server import save_map
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
from hnr_planner.maps.spiral import Spiral, spiral

__all__ = [
    'FREE',
    'OCCUPIED',
    'UNKNOWN',
    'MapFileError',
    'OccupancyMap',
    'Spiral',
    'building',
    'load_map',
    'save_map',
    'spiral',
]
