"""The image of a map for the page: its cells, large maps, maps that change."""

from io import BytesIO
import json
import queue
from test.watch.reader import read

from hnr_planner.drawing import cell_kinds
from hnr_planner.maps import OccupancyMap
from hnr_planner.watch import map_images
from hnr_planner.watch.map_images import map_message, MapImages
import numpy as np
from PIL import Image
import pytest

VALUES = np.array([-1, 0, 30, 100], dtype=np.int8)


def random_map(seed: int, shape: tuple[int, int] = (30, 41)) -> OccupancyMap:
    data = np.random.default_rng(seed).choice(VALUES, size=shape)
    return OccupancyMap(data, 0.05, (1.0, -2.0, 0.3), 'map')


def test_each_pixel_is_a_cell_and_the_first_row_is_row_0() -> None:
    occupancy = random_map(1)
    header, (png,) = read(map_message(occupancy))
    assert header['kind'] == 'map'
    assert header['map']['resolution'] == 0.05 and header['map']['origin'] == [1.0, -2.0, 0.3]
    image = Image.open(BytesIO(png.tobytes()))
    assert np.array_equal(np.asarray(image), cell_kinds(occupancy))
    json.dumps(header)


def test_a_pixel_of_a_large_map_is_the_highest_kind_of_its_block(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(map_images, 'LARGEST_SIDE', 14)
    occupancy = random_map(2)
    header, (png,) = read(map_message(occupancy))
    pixels = np.asarray(Image.open(BytesIO(png.tobytes())))
    assert pixels.shape == (10, 14)  # blocks of 3 cells
    assert header['map']['resolution'] == pytest.approx(0.15)
    kinds = cell_kinds(occupancy)
    for row in range(10):
        for col in range(14):
            first_row, first_col = 3 * row, 3 * col
            block = kinds[first_row:, first_col:][:3, :3]
            assert pixels[row, col] == block.max()


def test_a_map_is_sent_once_and_again_when_it_was_forgotten() -> None:
    sent: queue.Queue[bytes] = queue.Queue()
    images = MapImages(sent.put)
    one, same, other = random_map(3), random_map(3), random_map(4)
    images.put(one)
    first = sent.get(timeout=20.0)
    images.put(same)
    with pytest.raises(queue.Empty):
        sent.get(timeout=0.2)
    images.put(other)
    assert sent.get(timeout=20.0) != first
    images.forget()
    images.put(other)
    sent.get(timeout=20.0)
