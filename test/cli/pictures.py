"""The check that a file is a picture in the expected colours."""

from pathlib import Path

from matplotlib.colors import to_rgb
import numpy as np
from PIL import Image


def check_picture(file: Path, *colours: str) -> None:
    """Check that a file is a PNG of reasonable size with many colours, these among them."""
    with Image.open(file) as image:
        assert image.format == 'PNG'
        width, height = image.size
        assert 600 < width < 4000 and 300 < height < 4000
        pixels = np.asarray(image.convert('RGB'), dtype=np.int32).reshape(-1, 3)
    codes, counts = np.unique(pixels @ (1 << 16, 1 << 8, 1), return_counts=True)
    assert len(codes) > 50
    shown = np.stack((codes >> 16, codes >> 8 & 255, codes & 255), axis=1)
    for colour in colours:
        wanted = np.round(np.array(to_rgb(colour)) * 255)
        assert counts[np.abs(shown - wanted).max(axis=1) <= 2].sum() > 20, colour
