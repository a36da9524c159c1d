"""Put map and searches into the page."""

from __future__ import annotations

import base64
from collections.abc import Sequence
import html
from importlib.resources import files
from io import BytesIO
import json
import math
from pathlib import Path
from string import Template
from typing import Any, NamedTuple

from hnr_planner.core import GridSpace, PlanResult
from hnr_planner.drawing import cell_kinds, KINDS, known_box
from hnr_planner.maps import OccupancyMap
from matplotlib.colors import to_rgb
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

#: Okabe and Ito's colours, which people with any kind of colour vision can tell apart.
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9')
#: More samples of a search than these are left out: the page would be slow.
MOST_SAMPLES = 60_000


class Shown(NamedTuple):
    """
    A search on the page: its path as it was found, and the result whose path is shortened.

    Both have the same seed, so the same samples. ``asked`` is whether it is shown from the start.
    """

    found: PlanResult
    result: PlanResult
    asked: bool


def write_page(
    file: Path,
    title: str,
    occupancy: OccupancyMap,
    space: GridSpace,
    start: ArrayLike,
    goal: ArrayLike,
    searches: Sequence[Shown],
    *,
    goal_radius: float = 0.0,
    robot_radius: float = 0.0,
) -> None:
    """
    Write the page.

    Parameters
    ----------
    file : Path
        Where to.
    title : str
        Its heading, such as the name of the map.
    occupancy, space
        The map, and the space that the robot has on it.
    start, goal : (2,)
        Ends of the request [m].
    searches : sequence of Shown
        At least one, at most as many as there are ``COLOURS``.
    goal_radius, robot_radius : float
        Those of the request [m], to be shown.

    """
    data = {
        'map': _map(occupancy, space),
        'start': np.asarray(start, dtype=float).tolist(),
        'goal': np.asarray(goal, dtype=float).tolist(),
        'goal_radius': goal_radius,
        'robot_radius': robot_radius,
        'seed': searches[0].result.seed,
        'searches': [
            _search(space, shown, colour)
            for shown, colour in zip(searches, COLOURS[: len(searches)], strict=True)
        ],
    }
    folder = files(__package__)
    page = Template((folder / 'page.html').read_text(encoding='utf-8')).substitute(
        title=html.escape(title),
        style=(folder / 'page.css').read_text(encoding='utf-8'),
        script=(folder / 'page.js').read_text(encoding='utf-8'),
        # Nothing in the data may end the script element that holds it.
        data=json.dumps(data).replace('<', '\\u003c'),
    )
    file.write_text(page, encoding='utf-8')


def _map(occupancy: OccupancyMap, space: GridSpace) -> dict[str, Any]:
    """Return the map as an image of its cells, row 0 first, and its place."""
    image = Image.fromarray(cell_kinds(occupancy, space.blocked).astype(np.uint8), mode='P')
    colours = np.round(255 * np.array([to_rgb(colour) for _, colour in KINDS]))
    image.putpalette(colours.astype(np.uint8).tobytes())
    written = BytesIO()
    image.save(written, 'PNG', optimize=True)
    return {
        'image': 'data:image/png;base64,' + base64.b64encode(written.getvalue()).decode(),
        'resolution': occupancy.resolution,
        'origin': list(occupancy.origin),
        'box': known_box(occupancy).tolist(),
    }


def _search(space: GridSpace, shown: Shown, colour: str) -> dict[str, Any]:
    """Return what the page needs of a search."""
    found, result = shown.found, shown.result
    samples, parents = found.samples[:MOST_SAMPLES], found.parents[:MOST_SAMPLES]
    return {
        'name': result.planner,
        'colour': colour,
        'asked': shown.asked,
        'status': result.status.name,
        'message': result.message,
        'iterations': found.iterations,
        'left_out': len(found.samples) - len(samples),
        'samples': _packed(samples, np.float32),
        'parents': _packed(parents, np.int32),
        'chords': _packed(_chords(space, result.planner, samples, parents), np.float32),
        'found': found.path.tolist(),
        'found_length': _finite(found.length),
        'path': result.path.tolist(),
        'length': _finite(result.length),
    }


def _chords(
    space: GridSpace, planner: str, samples: NDArray, parents: NDArray
) -> NDArray[np.float64]:
    """Return the ends (k, 4) of the chord that each sample was drawn on; roots have none."""
    if not planner.startswith('hit_and_run'):
        return np.empty((0, 4))
    ends = np.zeros((len(samples), 4))
    for k in np.flatnonzero(parents >= 0):
        x, u = samples[parents[k]], samples[k] - samples[parents[k]]
        chord = space.chord(x, u)
        ends[k] = np.concatenate([x + chord.lower * u, x + chord.upper * u])
    return ends


def _packed(array: NDArray, kind: type[np.generic]) -> str:
    """Return an array as the browser reads it: little-endian, base64."""
    little = np.dtype(kind).newbyteorder('<')
    return base64.b64encode(np.ascontiguousarray(array, dtype=little).tobytes()).decode()


def _finite(length: float) -> float | None:
    return length if math.isfinite(length) else None
