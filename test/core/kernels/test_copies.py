"""Copies between arrays: all of the elements, into views too, in both tiers."""

from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import interpreted
import numpy as np
import pytest


@pytest.mark.parametrize('tier', [lambda kernel: kernel, interpreted])
def test_copies_are_complete_and_touch_nothing_else(tier):
    rows, source = np.zeros((4, 3)), np.arange(6.0).reshape(2, 3)
    tier(copy_into)(rows[1], source[0])
    tier(copy_rows)(rows[2:], source)
    assert rows.tolist() == [[0, 0, 0], [0, 1, 2], [0, 1, 2], [3, 4, 5]]
