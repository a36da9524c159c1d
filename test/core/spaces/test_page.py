"""The page for the reader with a set of their own: its code runs, and does what it says."""

from pathlib import Path
import re

from hnr_planner.core import Space
import numpy as np
import pytest

PAGE = Path(__file__).resolve().parents[3] / 'docs' / 'spaces.md'


@pytest.mark.interpreted
def test_the_code_of_the_page_runs():
    code = '\n'.join(re.findall(r'```python\n(.*?)```', PAGE.read_text(), re.DOTALL))
    names: dict[str, object] = {}
    exec(compile(code, str(PAGE), 'exec'), names)
    built = {type(value).__name__ for value in names.values() if isinstance(value, Space)}
    assert built == set(re.findall(r'\b(\w+Space)\b', PAGE.read_text()))
    points, path = np.asarray(names['points']), np.asarray(names['path'])
    assert points.shape == (4, 1000, 3)
    away = [np.linalg.norm(points - c, axis=-1) for c in ((1, 0.5, 0.5), (0, 0, 0))]
    assert (away[0] > 0.4).all() and (away[1] > 0.3).all()
    assert len(path) > 2
    np.testing.assert_array_equal(path[[0, -1]], [(0.1, 0.5, 0.5), (1.9, 0.5, 0.5)])
    np.testing.assert_allclose(np.asarray(names['chord']), (-0.1, 0.5), atol=1e-12)
