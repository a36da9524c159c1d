"""
Colours that all pictures share.

The colours are those of Okabe and Ito, which people with any kind of colour vision can tell apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.colors import LinearSegmentedColormap

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Text, faint text, frames, and cells that are unknown.
INK = '#22262B'
FAINT_INK = '#6B737C'
FRAME = '#B4BAC1'
UNKNOWN = '#D3D7DB'
#: Kinds of cells: label and colour.
KINDS = (
    ('free', '#FFFFFF'),
    ('too near for the robot', '#F6E7CB'),
    ('unknown', UNKNOWN),
    ('occupied', '#2E343B'),
)
PATH = '#D55E00'
OTHER_PATH = '#E69F00'
START = '#009E73'
GOAL = '#CC79A7'
#: Colours of samples, from the first of a search (light) to the last (dark).
AGES = LinearSegmentedColormap.from_list('ages', ('#A9D8F5', '#56B4E9', '#0072B2', '#1B2A5C'))


def draw_title(axes: Axes, words: str) -> None:
    """Write a title above ``axes``, aligned with their left side."""
    axes.set_title(words, loc='left', fontsize=10.5, color=INK, pad=8)
