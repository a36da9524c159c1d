"""Section: planning in n dimensions beside OMPL in C++, and walks in unions of many boxes."""

from benchmarks.dimensions.section import dimensions

__all__ = ['dimensions']
