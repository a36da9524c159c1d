"""Write a map and searches on it into an HTML page."""

from __future__ import annotations

import base64
from collections.abc import Sequence
import math
from pathlib import Path
from typing import Any, NamedTuple

from hnr_planner.core.planning.registry import PLANNERS
from hnr_planner.core.planning.result import PlanResult
from hnr_planner.core.spaces import GridSpace, PoseSpace
from hnr_planner.drawing import cell_kinds
from hnr_planner.maps import OccupancyMap
from hnr_planner.page.compose import request_page
from hnr_planner.page.map_image import map_data, map_image
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Okabe and Ito's colours, which people with any kind of colour vision can tell apart.
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9')
#: Most samples of a search that are shown; with more the page would be slow.
MOST_SAMPLES = 60_000
#: Sentence about each planner, and about what else may have made the path of auto.
ABOUT = {entry.name: f'{entry.summary[:1].upper()}{entry.summary[1:]}.' for entry in PLANNERS} | {
    'polyanya': 'The shortest path. Found by auto, the samples are those of the search before it.',
    'flood_fill': 'The path of a flood fill; the samples are those of the trees beside it.',
}


class Shown(NamedTuple):
    """
    A search on the page: its result, and whether it is shown at first.

    Attributes
    ----------
    result : PlanResult
        The result of the search.
    asked : bool
        Whether the search is shown when the page opens.

    """

    result: PlanResult
    asked: bool


def write_page(
    file: Path,
    title: str,
    occupancy: OccupancyMap,
    space: GridSpace | PoseSpace,
    start: ArrayLike,
    goal: ArrayLike,
    searches: Sequence[Shown],
    *,
    goal_radius: float = 0.0,
    simplify: bool = True,
    options: Sequence[str] = (),
) -> None:
    """
    Write an HTML page that shows one request and the searches for it.

    Parameters
    ----------
    file : Path
        The HTML file to write.
    title : str
        Heading of the page, such as the name of the map.
    occupancy, space
        The map, and the robot's free space on it: of points, or of the poses of a footprint.
    start, goal : (2,) or (3,)
        Start and goal of the request in the map frame: points [m], or poses [m, m, rad].
    searches : sequence of Shown
        At least one, at most as many as there are ``COLOURS``.
    goal_radius : float
        Radius of the goal region around the goal [m], which the page draws.
    simplify : bool
        Whether the searches were asked to shorten their paths.
    options : sequence of str
        Further options of the request, as phrases.

    """
    footprint = space.footprint if isinstance(space, PoseSpace) else np.empty((0, 2))
    blocked = space.grid.uninflated if isinstance(space, PoseSpace) else space.blocked
    kinds = cell_kinds(occupancy, blocked)
    data = {
        'map': map_data(occupancy, kinds) | {'image': _data_url(map_image(kinds))},
        'start': np.asarray(start, dtype=float).tolist(),
        'goal': np.asarray(goal, dtype=float).tolist(),
        'goal_radius': goal_radius,
        'footprint': footprint.tolist(),
        'simplify': simplify,
        'options': list(options),
        'searches': [
            _search(space, shown, colour)
            for shown, colour in zip(searches, COLOURS[: len(searches)], strict=True)
        ],
    }
    file.write_text(request_page(title, data), encoding='utf-8')


def _data_url(image: bytes) -> str:
    """Return a URL that holds a PNG image."""
    return f'data:image/png;base64,{base64.b64encode(image).decode()}'


def _search(space: GridSpace | PoseSpace, shown: Shown, colour: str) -> dict[str, Any]:
    """Return the page's data of one search, drawn in ``colour``; lengths are in metres."""
    result = shown.result
    samples, parents = result.samples[:MOST_SAMPLES], result.parents[:MOST_SAMPLES]
    notes = []
    if len(samples) < len(result.samples):
        notes.append(f'only the first {len(samples):,} samples are shown')
    if isinstance(space, PoseSpace):
        # Steps and the first path are curves, which the page does not draw.
        chords, found = np.empty((0, 4)), np.empty((0, 2))
        path = _poses(result, space.grid.resolution)
    else:
        chords = _chords(space, result.planner, samples, parents)
        found, path = path_as_found(result), result.path
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
        'samples': _packed(samples[:, :2], np.float32),
        'parents': _packed(parents, np.int32),
        'chords': _packed(chords, np.float32),
        'found': found.tolist(),
        'found_length': result.first_solution.length if result.first_solution else None,
        'path': path.tolist(),
        'others': [path.tolist() for path in result.others],
        'length': result.length if math.isfinite(result.length) else None,
    }


def _poses(result: PlanResult, spacing: float) -> NDArray[np.float64]:
    """
    Return poses (n, 3) along a path of poses, ``spacing`` [m, rad] apart; none without a path.

    Their yaws change by no whole turns, so that the page can interpolate them.
    """
    poses = result.poses(spacing) if len(result.path) else result.path.copy()
    poses[:, 2] = np.unwrap(poses[:, 2])
    return poses


def path_as_found(result: PlanResult) -> NDArray[np.float64]:
    """
    Return the path (m, 2) [m] that the search on the page found first, before shortening.

    The array is (0, 2) where no path was found, and where a vertex of the first path between its
    ends is not among the samples of the result: then another search has found that path, as
    ``optimize_for`` may bring about.
    """
    first, nothing = result.first_solution, np.empty((0, 2))
    if first is None:
        return nothing
    samples = set(map(tuple, result.samples.tolist()))
    is_along = all(tuple(vertex) in samples for vertex in first.path[1:-1].tolist())
    return first.path if is_along else nothing


def _chords(
    space: GridSpace, planner: str, samples: NDArray, parents: NDArray
) -> NDArray[np.float64]:
    """
    Return the ends (x, y, x, y) [m] of the chord that each sample was drawn on.

    The array is (k, 4) for k samples, with zeros for roots of trees, which have no chord. It is
    (0, 4) for planners other than Hit-and-Run.
    """
    if not planner.startswith('hit_and_run'):
        return np.empty((0, 4))
    ends = np.zeros((len(samples), 4))
    for k in np.flatnonzero(parents >= 0):
        x, u = samples[parents[k]], samples[k] - samples[parents[k]]
        chord = space.chord(x, u)
        ends[k] = np.concatenate([x + chord.lower * u, x + chord.upper * u])
    return ends


def _packed(array: NDArray, kind: type[np.generic]) -> str:
    """Return an array's elements as text for the browser: type ``kind``, little-endian, base64."""
    little = np.dtype(kind).newbyteorder('<')
    return base64.b64encode(np.ascontiguousarray(array, dtype=little).tobytes()).decode()
