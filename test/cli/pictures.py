"""What a picture must be, whatever it shows."""

from pathlib import Path

from matplotlib.colors import to_rgb
import numpy as np
from PIL import Image


def check_picture(file: Path, *colours: str) -> None:
    """Check that a file is a PNG of a sane size, with many colours, and those named among them."""
    with Image.open(file) as image:
        assert image.format == 'PNG'
        width, height = image.size
        assert 600 < width < 4000 and 300 < height < 4000
        pixels = np.asarray(image.convert('RGB')).reshape(-1, 3)
    assert len(np.unique(pixels, axis=0)) > 50
    for colour in colours:
        wanted = np.round(np.array(to_rgb(colour)) * 255)
        assert (np.abs(pixels - wanted).max(axis=1) <= 2).sum() > 20, colour
