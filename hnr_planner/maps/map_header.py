"""
Headers of maps for map_server: the YAML file beside an image, its keys read and checked.

Keys, modes and what counts as a number or a flag are those of Nav2's map_server.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from hnr_planner.maps.errors import MapFileError
from hnr_planner.maps.file_kinds import HEAD, IMAGES, kind_of, with_article
from hnr_planner.maps.yaml_text import (
    as_file_name,
    as_flag,
    as_number,
    Mapping,
    read_document,
    shown,
    Value,
    YamlError,
)

#: How grey values become occupancies.
MODES = ('trinary', 'scale', 'raw')
#: Keys that a map must have.
REQUIRED = ('image', 'resolution', 'origin', 'negate', 'occupied_thresh', 'free_thresh')


class MapHeader(NamedTuple):
    """
    Checked values of the YAML file of a map.

    ``image`` is the path of the image, ``resolution`` the side of a cell [m], ``origin`` the pose
    (x, y, yaw) of the outer corner of cell [0, 0] in the map frame [m, m, rad]; ``repeated`` has
    the keys that occur more than once. The other fields enter the formulas of ``map_server``.
    """

    image: Path
    mode: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    repeated: tuple[str, ...] = ()


def read_header(path: Path) -> MapHeader:
    """
    Read the YAML file of a map, and check its keys; the image is not read.

    Raises
    ------
    MapFileError
        The file cannot be read, or a key is missing or breaks its rule.

    """
    mapping = _read_mapping(path)
    fields = _Fields(path, mapping)
    for key in REQUIRED:
        fields.get(key)
    return MapHeader(
        image=path.parent / fields.file_name('image'),  # an absolute name wins over the folder
        mode=fields.mode(),
        resolution=fields.resolution(),
        origin=fields.origin(),
        negate=fields.flag('negate'),
        occupied_thresh=fields.share('occupied_thresh'),
        free_thresh=fields.share('free_thresh'),
        repeated=mapping.repeated,
    )


def _read_mapping(path: Path) -> Mapping:
    """Return the mapping that a YAML file holds; raise MapFileError where it holds none."""
    try:
        with path.open('rb') as file:
            head = file.read(HEAD)
            _refuse_other_files(path, head)
            document = read_document(head + file.read())
    except OSError as error:
        raise MapFileError.about(path, f'cannot be opened ({error.strerror or error})') from None
    except YamlError as error:
        raise MapFileError.about(path, f'is not YAML: {error}') from error
    if not isinstance(document, Mapping):
        raise MapFileError.about(
            path, f'must be a YAML mapping (key: value), but holds {shown(document)}'
        )
    return document


def _refuse_other_files(path: Path, head: bytes) -> None:
    """
    Raise MapFileError where a file's first bytes show that it is no YAML, but an image, say.

    For an image the message names the YAML files of the same name beside it.
    """
    kind = kind_of(head)
    if kind is None:
        return
    reason = f'is {with_article(kind)}, not the YAML file of a map'
    if kind in IMAGES:
        reason += ': give the YAML file that names it'
        beside = [path.with_suffix(suffix) for suffix in ('.yaml', '.yml')]
        reason += ''.join(f', perhaps {file}' for file in beside if file.is_file())
    raise MapFileError.about(path, reason)


class _Fields:
    """
    Values of one YAML file, each checked against its rule.

    Every public method raises MapFileError where the key is missing (a missing mode is trinary),
    or where its value breaks the rule.
    """

    def __init__(self, path: Path, mapping: Mapping) -> None:
        self._path = path
        self._values = mapping.values

    def get(self, key: str) -> Value:
        if key not in self._values:
            raise MapFileError.about(self._path, f'the key {key} is missing')
        return self._values[key]

    def file_name(self, key: str) -> str:
        name = as_file_name(self.get(key))
        if name is None:
            raise self._broken(key, "must be a file's name")
        return name

    def mode(self) -> str:
        mode = self._values.get('mode', 'trinary')
        if not isinstance(mode, str) or mode.lower() not in MODES:
            raise self._broken('mode', f'must be one of {", ".join(MODES)}')
        return mode.lower()

    def resolution(self) -> float:
        value = as_number(self.get('resolution'))
        if value is None or value <= 0:
            raise self._broken('resolution', 'must be a finite number > 0')
        return value

    def share(self, key: str) -> float:
        value = as_number(self.get(key))
        if value is None or not 0 <= value <= 1:
            raise self._broken(key, 'must be a number in 0..1')
        return value

    def flag(self, key: str) -> bool:
        value = as_flag(self.get(key))
        if value is None:
            raise self._broken(key, 'must be an integer or a boolean, such as 0 or false')
        return value

    def origin(self) -> tuple[float, float, float]:
        value = self.get('origin')
        items = value if isinstance(value, list) else []
        numbers = [number for item in items if (number := as_number(item)) is not None]
        if len(items) != 3 or len(numbers) != 3:
            raise self._broken('origin', 'must be three finite numbers [x, y, yaw]')
        x, y, yaw = numbers
        return x, y, yaw

    def _broken(self, key: str, rule: str) -> MapFileError:
        return MapFileError.about(self._path, f'{key}: {rule}, not {shown(self._values[key])}')
