"""Every example runs from a clone, is short, and draws one picture that is not empty."""

from collections.abc import Iterator
from pathlib import Path
import re
import runpy
import sys
from test.sweeps import sweep

from hnr_planner.core.kernels import modes
import matplotlib
from matplotlib import pyplot as plt
import numpy as np
import pytest

matplotlib.use('agg')
ROOT = Path(__file__).resolve().parents[1]
#: The client of the node is run with a node, in test/ros.
EXAMPLES = sorted(set(ROOT.glob('examples/*.py')) - {ROOT / 'examples' / 'ask_the_node.py'})
#: What an example prints, where it prints something that could be wrong; the others are sweeps.
PRINTS = {
    'alternatives': r'4 of 4 paths',
    'arm_by_an_oracle': r'SOLVED',
    'clearance': r'clearance=0.0: 10\.\d+ m.*\nclearance=0.8: 1[23]\.\d+ m',
    'exact_and_certified': r'found 4\d\.\d+ m, no path is shorter than 42\.\d+ m',
    'parking': r'SOLVED',
    'plan_on_a_map': r'SOLVED',
    'points_of_a_polytope': r'converged',
    'roadmap': r'Roadmap\(',
    'robot_with_inertia': r'SOLVED',
    'stuck_chain': r'not converged',
}


def test_there_are_at_least_twelve_and_each_is_short() -> None:
    files = sorted(ROOT.glob('examples/*.py'))
    assert len(files) >= 12
    assert {file.stem for file in files} >= set(PRINTS)
    for file in files:
        assert 15 <= len(file.read_text().splitlines()) <= 45, file.name


@pytest.fixture
def interpreted() -> Iterator[None]:
    """Compile nothing, as in the gallery: each example takes a few seconds at most."""
    before = modes.mode()
    modes.set_mode(modes.Mode.INTERPRETED.value)
    yield
    modes.set_mode(before.value)


@pytest.mark.usefixtures('interpreted')
@pytest.mark.parametrize(
    'file',
    [file if file.stem in PRINTS else sweep(file) for file in EXAMPLES],
    ids=lambda file: file.stem,
)
def test_an_example_runs_and_draws_one_picture(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, 'argv', [str(file)])
    monkeypatch.setattr(plt, 'show', lambda: None)
    plt.close('all')
    runpy.run_path(str(file), run_name='__main__')
    (number,) = plt.get_fignums()
    figure = plt.figure(number)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]
    plt.close('all')
    assert len(np.unique(pixels.reshape(-1, 4), axis=0)) > 50
    assert re.match(PRINTS.get(file.stem, ''), capsys.readouterr().out)
