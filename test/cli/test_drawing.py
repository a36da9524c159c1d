"""Pictures show everything at its position, in the colour of the legend."""

import math
from pathlib import Path
from test.cli.conftest import at
from test.cli.pictures import check_picture
from test.sweeps import sweep

from hnr_planner import drawing
from hnr_planner.maps import OccupancyMap
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
import numpy as np
import pytest

COLOURS = dict(drawing.KINDS)


def colour_at(figure: Figure, point: tuple[float, float]) -> np.ndarray:
    """Return the colour (3,) of a picture's only axes at a point of the map frame."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    col, row = figure.axes[0].transData.transform(point)
    return pixels[len(pixels) - 1 - int(row), int(col), :3] / 255


@pytest.mark.parametrize('yaw', [0.0, 0.7, math.pi / 2, -3.0])
def test_cells_are_drawn_where_they_are(yaw: float) -> None:
    data = np.zeros((12, 20), dtype=np.int8)
    data[2:4, 15:19] = 100
    data[9:11, 1:4] = -1
    blocked = data != 0
    blocked[1:6, 1:4] = True
    occupancy = OccupancyMap(data, 0.5, (-7.0, 3.0, yaw))
    figure = Figure(figsize=(6, 6))
    drawing.draw_map(figure.subplots(), occupancy, blocked=blocked)
    for row, col, kind in (
        (2.5, 16.5, 'occupied'),
        (9.5, 2, 'unknown'),
        (3, 2, 'too near for the robot'),
        (8, 10, 'free'),
    ):
        found = colour_at(figure, at(occupancy, row, col))
        assert np.abs(found - to_rgb(COLOURS[kind])).max() < 0.01, kind


def test_path_and_ends_are_drawn_where_they_are(rooms: OccupancyMap) -> None:
    start, goal = at(rooms, 5, 5), at(rooms, 20, 75)
    middle = at(rooms, 20, 20)
    figure = Figure(figsize=(8, 6))
    axes = figure.subplots()
    drawing.draw_map(axes, rooms)
    drawing.draw_path(axes, [start, middle, goal])
    drawing.draw_ends(axes, start, goal)
    for point, colour in (
        (start, drawing.START),
        (goal, drawing.GOAL),
        (middle, drawing.PATH),
        (at(rooms, 20, 60), drawing.PATH),
    ):
        assert np.abs(colour_at(figure, point) - to_rgb(colour)).max() < 0.02


def test_later_samples_are_darker(rooms: OccupancyMap) -> None:
    figure = Figure(figsize=(8, 6))
    axes = figure.subplots()
    drawing.draw_map(axes, rooms)
    points = [at(rooms, 10, col) for col in (10, 20, 30)]
    drawing.draw_samples(axes, points)
    light = [colour_at(figure, point).sum() for point in points]
    assert light[0] > light[1] > light[2]


def test_cells_of_samples_are_drawn_where_they_are_and_the_last_one_counts() -> None:
    figure = Figure(figsize=(8, 6))
    axes = figure.subplots()
    drawing.draw_map(axes, OccupancyMap(np.zeros((40, 60), dtype=np.int8), 0.5))
    view = axes.get_xlim(), axes.get_ylim()
    drawing.draw_sample_cells(axes, [(20.2, 10.4), (7.8, 7.6), (20.4, 10.1)], 0.5)
    assert (axes.get_xlim(), axes.get_ylim()) == view
    for (x, y), age in (((20.25, 10.25), 1.0), ((7.75, 7.75), 0.5)):
        assert np.abs(colour_at(figure, (x, y)) - drawing.AGES(age)[:3]).max() < 0.02
        for beside in ((x - 0.5, y), (x + 0.5, y), (x, y - 0.5), (x, y + 0.5)):
            assert np.abs(colour_at(figure, beside) - 1.0).max() < 0.02


def test_view_is_fitted_to_what_is_known() -> None:
    data = np.full((100, 100), -1, dtype=np.int8)
    data[40:50, 60:80] = 0
    figure = Figure()
    axes = figure.subplots()
    drawing.draw_map(axes, OccupancyMap(data, 0.1))
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert 5.9 < left <= 6.0 and 8.0 <= right < 8.1
    assert 3.9 < low <= 4.0 and 5.0 <= high < 5.1


def test_figure_names_only_what_it_shows(rooms: OccupancyMap, tmp_path: Path) -> None:
    empty, start, goal = np.empty((0, 2)), at(rooms, 5, 5), at(rooms, 8, 75)
    plan = drawing.Plan('nothing found', empty, empty, np.empty(0, dtype=int), start, goal)
    figure = drawing.figure_of_plans(rooms, [plan, plan])
    words = {text.get_text() for text in figure.legends[0].get_texts()}
    assert words == {'free', 'occupied', 'path', 'start', 'goal'}
    drawing.save(figure, tmp_path / 'a.png')
    check_picture(tmp_path / 'a.png', drawing.START, drawing.GOAL, COLOURS['occupied'])


def test_a_map_of_which_nothing_is_known_can_be_drawn(tmp_path: Path) -> None:
    occupancy = OccupancyMap(np.full((9, 30), -1, dtype=np.int8), 0.1)
    figure = drawing.figure_of_samples(occupancy, np.empty((0, 2)), title='nothing')
    drawing.save(figure, tmp_path / 'a.png')
    check_picture(tmp_path / 'a.png')


@pytest.mark.parametrize('shape', [(4100, 30), (30, 8003), sweep((4001, 4003))])
def test_cells_of_a_large_map_are_drawn_where_they_are(shape: tuple[int, int]) -> None:
    data = np.zeros(shape, dtype=np.int8)
    rows, cols = shape
    upper = 2 * rows // 3
    data[: rows // 3, : cols // 2] = 100
    data[upper:, : cols // 2] = -1
    occupancy = OccupancyMap(data, 0.05, (1.0, 2.0, 0.0))
    figure = Figure(figsize=(6, 6))
    axes = figure.subplots()
    drawing.draw_map(axes, occupancy)
    axes.set_aspect('auto')
    (image,) = axes.images
    assert max(image.get_array().shape[:2]) <= 4000
    for row, col, kind in (
        (rows / 6, cols / 4, 'occupied'),
        (rows / 6, 3 * cols / 4, 'free'),
        (5 * rows / 6, cols / 4, 'unknown'),
    ):
        found = colour_at(figure, at(occupancy, row, col))
        assert np.abs(found - to_rgb(COLOURS[kind])).max() < 0.01, kind


def test_a_pixel_of_a_large_map_is_the_mean_of_its_cells() -> None:
    data = np.zeros((10, 8001), dtype=np.int8)
    data[:3, :3] = 100  # a block of 3 x 3 cells
    data[3, 3] = 100  # one cell of the next one
    figure = Figure()
    axes = figure.subplots()
    drawing.draw_map(axes, OccupancyMap(data, 0.05))
    pixels = np.asarray(axes.images[0].get_array())
    free, occupied = (255 * np.array(to_rgb(COLOURS[kind])) for kind in ('free', 'occupied'))
    assert pixels.shape == (4, 2667, 4)
    assert np.abs(pixels[0, 0, :3] - occupied).max() <= 1
    assert np.abs(pixels[1, 1, :3] - (8 * free + occupied) / 9).max() <= 1
    assert np.abs(pixels[-1, -1, :3] - free).max() <= 1
    assert (pixels[..., 3] == 255).all()
