"""Read a map file of either kind, chosen by its suffix."""

from __future__ import annotations

from pathlib import Path

from hnr_planner.maps.map_server import load_map_server
from hnr_planner.maps.moving_ai import load_moving_ai
from hnr_planner.maps.occupancy import OccupancyMap


def load_map(path: str | Path) -> OccupancyMap:
    """
    Read a map from a file.

    Parameters
    ----------
    path : str or Path
        A ``.map`` file of the Moving AI benchmarks, or (any other suffix) the YAML file of a
        map_server map, which names its image relative to its own folder or absolutely.

    Raises
    ------
    MapFileError
        The file or its image cannot be read, or a key is missing or out of range. The message
        is one line that names the file, the key and the value.

    Warns
    -----
    MapFileWarning
        A key of the YAML file occurs repeatedly: the first value counts, as for Nav2.

    """
    path = Path(path)
    return load_moving_ai(path) if is_moving_ai(path) else load_map_server(path)


def is_moving_ai(path: str | Path) -> bool:
    """
    Return whether a file is taken for a map of the Moving AI benchmarks.

    Only the suffix decides: ``.map`` in lower or upper case. The file need not exist.
    """
    return Path(path).suffix.lower() == '.map'
