"""Small map files, written as a person would write them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
import pytest
import yaml

MapWriter = Callable[..., Path]

HEADER = {
    'image': 'map.png',
    'resolution': 0.05,
    'origin': [0.0, 0.0, 0.0],
    'negate': 0,
    'occupied_thresh': 0.65,
    'free_thresh': 0.196,
}


@pytest.fixture
def write_map(tmp_path: Path) -> MapWriter:
    """
    Return a function that writes a map and returns its YAML file.

    It takes the image (an array, an Image, or the bytes of the file) and changes of ``HEADER``; a
    key given as None is left out.
    """

    def write(image: Any = ((0,),), /, **changes: Any) -> Path:
        header = {key: value for key, value in (HEADER | changes).items() if value is not None}
        path = tmp_path / str(header.get('image', 'map.png'))
        if isinstance(image, bytes):
            path.write_bytes(image)
        elif isinstance(image, Image.Image):
            image.save(path)
        else:
            Image.fromarray(np.asarray(image, np.uint8)).save(path)
        yaml_path = tmp_path / 'map.yaml'
        yaml_path.write_text(yaml.safe_dump(header))
        return yaml_path

    return write
