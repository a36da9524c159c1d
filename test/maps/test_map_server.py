"""Pixels of a map_server map become occupancies as Nav2 defines them."""

import math
from pathlib import Path

from hnr_planner.maps import load_map, OccupancyMap, save_map
import numpy as np
from PIL import Image
import pytest

from .conftest import MapWriter

EVERY_GREY = np.arange(256, dtype=np.uint8).reshape(16, 16)


def values(path: Path) -> list[list[int]]:
    """Return the cells of a map, the top row of the image first."""
    return load_map(path).data[::-1].tolist()


def test_last_row_of_the_image_is_the_first_of_the_grid(write_map: MapWriter) -> None:
    loaded = load_map(write_map([[0, 254, 254], [254, 254, 205]]))
    assert loaded.data.tolist() == [[0, 0, -1], [100, 0, 0]]
    assert loaded.data.dtype == np.int8
    assert loaded.data.flags.c_contiguous


@pytest.mark.parametrize('negate', [0, 1, True, False])
def test_trinary_of_every_grey(write_map: MapWriter, negate: int) -> None:
    expected = []
    for v in range(256):
        n = v / 255
        occ = n if negate else 1 - n
        expected.append(0 if occ <= 0.196 else 100 if occ >= 0.65 else -1)
    grid = values(write_map(EVERY_GREY, negate=negate, mode='trinary'))
    assert np.ravel(grid).tolist() == expected
    assert {-1, 0, 100} == set(expected)


@pytest.mark.parametrize('negate', [0, 1])
def test_scale_of_every_grey(write_map: MapWriter, negate: int) -> None:
    free, occupied = 0.196, 0.65
    expected = []
    for v in range(256):
        n = v / 255
        occ = n if negate else 1 - n
        between = round(100 * (occ - free) / (occupied - free))
        expected.append(0 if occ <= free else 100 if occ >= occupied else between)
    grid = values(write_map(EVERY_GREY, negate=negate, mode='scale'))
    assert np.ravel(grid).tolist() == expected
    assert len(set(expected)) > 50


@pytest.mark.parametrize('negate', [0, 1])
def test_raw_of_every_grey(write_map: MapWriter, negate: int) -> None:
    grid = values(write_map(EVERY_GREY, negate=negate, mode='raw'))
    assert np.ravel(grid).tolist() == [v if v <= 100 else -1 for v in range(256)]


def test_mode_is_trinary_unless_given_and_may_be_in_capitals(write_map: MapWriter) -> None:
    assert values(write_map([[128]])) == [[-1]]
    assert values(write_map([[128]], mode='Scale')) == [[67]]


@pytest.mark.parametrize(('grey', 'occupancy'), [(0, 100), (255, 0), (51, 100), (204, 0)])
def test_thresholds_belong_to_the_ends(write_map: MapWriter, grey: int, occupancy: int) -> None:
    exact = {'occupied_thresh': 1 - 51 / 255, 'free_thresh': 1 - 204 / 255}
    assert values(write_map([[grey]], **exact)) == [[occupancy]]


@pytest.mark.parametrize('mode', ['trinary', 'scale'])
@pytest.mark.parametrize(('occupied', 'free'), [(0.2, 0.8), (0.5, 0.5), (0, 1)])
def test_free_wins_where_thresholds_overlap(
    write_map: MapWriter, mode: str, occupied: float, free: float
) -> None:
    thresholds = {'occupied_thresh': occupied, 'free_thresh': free}
    loaded = load_map(write_map(EVERY_GREY, mode=mode, **thresholds))
    occ = 1 - EVERY_GREY[::-1] / 255
    assert np.array_equal(loaded.data, np.where(occ <= free, 0, 100))


def test_customary_unknown_grey_depends_on_free_thresh(write_map: MapWriter) -> None:
    assert values(write_map([[205]], free_thresh=0.196)) == [[-1]]
    assert values(write_map([[205]], free_thresh=0.25)) == [[0]]


@pytest.mark.parametrize(('mode', 'occupancy'), [('trinary', -1), ('scale', -1), ('raw', 0)])
def test_transparent_pixels_are_unknown_except_in_raw(
    write_map: MapWriter, mode: str, occupancy: int
) -> None:
    pixels = np.array([[[0, 0, 0, 254], [0, 0, 0, 0], [0, 0, 0, 255]]], np.uint8)
    opaque = 0 if mode == 'raw' else 100
    assert values(write_map(pixels, mode=mode)) == [[occupancy, occupancy, opaque]]


def test_yaw_and_place_of_the_origin_are_kept(write_map: MapWriter) -> None:
    loaded = load_map(write_map(origin=[-1.5, 2, 0.7], resolution=1))
    assert loaded.origin == (-1.5, 2.0, 0.7)
    assert loaded.resolution == 1.0


def test_numbers_may_be_written_without_a_dot(write_map: MapWriter) -> None:
    path = write_map()
    text = path.read_text().replace('resolution: 0.05', 'resolution: 5e-2')
    path.write_text(text.replace('origin:\n- 0.0', 'origin:\n- -1e-05'))
    assert load_map(path).resolution == 0.05
    assert load_map(path).origin[0] == -1e-05


def test_image_may_be_named_absolutely_or_from_the_yaml_folder(
    write_map: MapWriter, tmp_path: Path
) -> None:
    path = write_map()
    other = tmp_path / 'deeper' / 'map.yaml'
    other.parent.mkdir()
    for name in (str(tmp_path / 'map.png'), '../map.png'):
        other.write_text(path.read_text().replace('map.png', name))
        assert load_map(str(other)).data.tolist() == [[100]]


def test_saved_map_is_read_back_exactly(tmp_path: Path) -> None:
    data = np.random.default_rng(1).choice([-1, 0, 100], (31, 17)).astype(np.int8)
    saved = OccupancyMap(data, 1 / 30, (-0.1, 1e-05, math.pi / 3))
    save_map(saved, tmp_path / 'saved.yaml')
    loaded = load_map(tmp_path / 'saved.yaml')
    assert np.array_equal(loaded.data, saved.data)
    assert (loaded.resolution, loaded.origin) == (saved.resolution, saved.origin)


@pytest.mark.parametrize('value', [-1, 0, 100])
def test_saved_map_may_hold_one_value_only(tmp_path: Path, value: int) -> None:
    save_map(OccupancyMap(np.full((2, 3), value, np.int8), 0.05), tmp_path / 'flat.yaml')
    assert load_map(tmp_path / 'flat.yaml').data.tolist() == [[value] * 3] * 2


def test_map_that_is_not_trinary_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match='-1, 0 and 100 only, not 50'):
        save_map(OccupancyMap(np.array([[0, 50]], np.int8), 0.05), tmp_path / 'grey.yaml')
    assert list(tmp_path.iterdir()) == []


def test_colour_counts_as_the_mean_of_its_channels(write_map: MapWriter) -> None:
    # Not the weighted luminance: pure blue would be nearly black then.
    pixels = np.array([[[0, 0, 255], [255, 0, 0], [30, 60, 91]]], np.uint8)
    assert values(write_map(pixels, mode='raw')) == [[85, 85, 60]]
    assert values(write_map(pixels, occupied_thresh=2 / 3 + 1e-9)) == [[-1, -1, 100]]


def test_image_modes_agree(write_map: MapWriter) -> None:
    grey = Image.fromarray(EVERY_GREY)
    expected = values(write_map(grey))
    for mode in ('LA', 'RGB', 'RGBA', 'P'):
        assert values(write_map(grey.convert(mode))) == expected
