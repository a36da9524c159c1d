"""Spaces: open, bounded sets of free points that answer for points and chords."""

from hnr_planner.core.spaces.grid import GridSpace
from hnr_planner.core.spaces.space import Chord, Space

__all__ = ['Chord', 'GridSpace', 'Space']
