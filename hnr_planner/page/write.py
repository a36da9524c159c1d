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
from hnr_planner.core.lengths import path_length
from hnr_planner.drawing import cell_kinds, KINDS, known_box
from hnr_planner.maps import OccupancyMap
from hnr_planner.page.found import found_path
from matplotlib.colors import to_rgb
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

#: Okabe and Ito's colours, which people with any kind of colour vision can tell apart.
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9')
#: More samples of a search than these are left out: the page would be slow.
MOST_SAMPLES = 60_000
#: In the order in which the page reads them.
SCRIPTS = ('searches.js', 'drawing.js', 'view.js', 'page.js')
#: What each planner does, for a newcomer.
ABOUT = {
    'hit_and_run': 'Hit-and-Run walks: a line through the newest sample in a random direction, '
    'and the next sample anywhere on its free part, the chord.',
    'rrt': 'RRT grows a tree: its vertex nearest to a random point is extended towards that '
    'point, up to the first obstacle.',
    'hit_and_run_connect': 'Two trees grow from start and goal by steps of Hit-and-Run: of a few '
    'random directions the longest free one. They end when they see each other.',
    'rrt_connect': 'Two trees grow from start and goal towards random points, and after each step '
    'towards each other, until they meet.',
}


class Shown(NamedTuple):
    """
    A search on the page.

    Attributes
    ----------
    result : PlanResult
        What came of it.
    asked : bool
        Whether it is shown from the start.
    notes : sequence of str
        What else is to be said about it, such as a wish that the planner cannot take.

    """

    result: PlanResult
    asked: bool
    notes: Sequence[str] = ()


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
    simplify: bool = True,
    wishes: Sequence[str] = (),
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
    goal_radius : float
        That of the request [m], to be drawn.
    simplify : bool
        Whether the paths were to be shortened.
    wishes : sequence of str
        What else was asked for, in words.

    """
    kinds = cell_kinds(occupancy, space.blocked)
    data = {
        'map': _map(occupancy, kinds),
        'kinds': [KINDS[kind] for kind in np.unique(kinds)],
        'start': np.asarray(start, dtype=float).tolist(),
        'goal': np.asarray(goal, dtype=float).tolist(),
        'goal_radius': goal_radius,
        'simplify': simplify,
        'wishes': list(wishes),
        'searches': [
            _search(space, shown, found_path(shown.result, goal, goal_radius), colour)
            for shown, colour in zip(searches, COLOURS[: len(searches)], strict=True)
        ],
    }
    folder = files(__package__)
    page = Template((folder / 'page.html').read_text(encoding='utf-8')).substitute(
        title=html.escape(title),
        style=(folder / 'page.css').read_text(encoding='utf-8'),
        script='\n'.join((folder / name).read_text(encoding='utf-8') for name in SCRIPTS),
        # Nothing in the data may end the script element that holds it.
        data=json.dumps(data).replace('<', '\\u003c'),
    )
    file.write_text(page, encoding='utf-8')


def _map(occupancy: OccupancyMap, kinds: NDArray[np.int8]) -> dict[str, Any]:
    """Return the map as an image of its cells' kinds, row 0 first, and its place."""
    image = Image.fromarray(kinds.astype(np.uint8), mode='P')
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


def _search(
    space: GridSpace, shown: Shown, found: NDArray[np.float64], colour: str
) -> dict[str, Any]:
    """Return what the page needs of a search, and of the path as it was found."""
    result = shown.result
    samples, parents = result.samples[:MOST_SAMPLES], result.parents[:MOST_SAMPLES]
    notes = list(shown.notes)
    if len(samples) < len(result.samples):
        notes.append(f'only the first {len(samples):,} samples are shown')
    return {
        'name': result.planner,
        'about': ABOUT.get(result.planner, ''),
        'notes': notes,
        'colour': colour,
        'asked': shown.asked,
        'status': result.status.name,
        'message': result.message,
        'iterations': result.iterations,
        'elapsed': result.elapsed,
        'samples': _packed(samples, np.float32),
        'parents': _packed(parents, np.int32),
        'chords': _packed(_chords(space, result.planner, samples, parents), np.float32),
        'found': found.tolist(),
        'found_length': path_length(found) if len(found) else None,
        'path': result.path.tolist(),
        'others': [path.tolist() for path in result.others],
        'length': result.length if math.isfinite(result.length) else None,
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
