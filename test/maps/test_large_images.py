"""Large images are read within the memory that they need, and refused only without it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import resource
import subprocess
import sys
from test.sweeps import sweep
import warnings

from hnr_planner.maps import load_map, MapFileError
from hnr_planner.maps.memory import available_memory, in_words
import numpy as np
from PIL import Image
import pytest

from .conftest import MapWriter

#: Load a map; print its shape, its occupied cells and the peak of memory beyond the start [MiB].
PROGRAM = """
import resource, sys
from hnr_planner.maps import load_map
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
data = load_map(sys.argv[1]).data
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(*data.shape, (data == 100).sum(), (after - before) // 1024)
"""


@contextmanager
def address_space(n_bytes: float) -> Iterator[None]:
    """Limit this process to so many more bytes while the block runs."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path('/proc/self/statm').read_text().split()[0])
    limit = pages * resource.getpagesize() + int(n_bytes)
    resource.setrlimit(resource.RLIMIT_AS, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.parametrize(('magic', 'row_bytes'), [(b'P5', 13_500), sweep(b'P4', 1_688)])
def test_a_map_beyond_the_limit_for_attacks_is_read(
    write_map: MapWriter, tmp_path: Path, magic: bytes, row_bytes: int
) -> None:
    side = 13_500
    path = write_map(b'', image='map.pgm')
    head = magic + b' %d %d\n' % (side, side) + (b'255\n' if magic == b'P5' else b'')
    with (tmp_path / 'map.pgm').open('wb') as file:
        file.write(head + bytes(10 * row_bytes))
        file.truncate(len(head) + side * row_bytes)  # zeros, which take no space on the disk
    done = subprocess.run(
        [sys.executable, '-W', 'error', '-c', PROGRAM, str(path)],
        capture_output=True, text=True, timeout=300, check=True,
    )  # fmt: skip
    rows, cols, occupied, peak = map(int, done.stdout.split())
    assert (rows, cols) == (side, side)
    assert occupied == (
        side * side if magic == b'P5' else 0
    )  # 0 is black in a PGM, white in a PBM
    assert peak < 2 * side * side / 2**20 + 100


def test_an_image_of_100_million_pixels_gives_no_warning(write_map: MapWriter) -> None:
    path = write_map(Image.new('1', (10_000, 10_000), 1))
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        assert not load_map(path).data.any()


def test_too_little_memory_is_named_with_what_is_needed(write_map: MapWriter) -> None:
    path = write_map(Image.new('1', (10_000, 10_000), 1))
    with address_space(1e8), pytest.raises(MapFileError) as caught:
        load_map(path)
    text = str(caught.value)
    assert 'has 10,000 x 10,000 pixels: reading it takes 255 MiB of memory, and ' in text
    assert text.endswith(' MiB are available')


def test_an_image_larger_than_any_memory_is_refused_at_once(write_map: MapWriter) -> None:
    path = write_map(b'P5\n6000000 6000000\n255\n', image='map.pgm')
    with pytest.raises(MapFileError, match=r'6,000,000 x 6,000,000 pixels: reading it takes \d+'):
        load_map(path)


def test_available_memory_falls_with_the_limit_of_the_address_space() -> None:
    unlimited = available_memory()
    assert unlimited > 5e7
    with address_space(5e7):
        assert available_memory() == pytest.approx(5e7, abs=1e7)


def test_memory_in_words() -> None:
    assert in_words(5 * 2**20) == '5 MiB'
    assert in_words(1.25 * 2**30) == '1.2 GiB'


def test_memory_of_a_made_map_is_not_shared_with_the_image(write_map: MapWriter) -> None:
    loaded = load_map(write_map(np.zeros((5, 5), np.uint8)))
    assert loaded.data.flags.owndata and loaded.data.flags.writeable
