"""
A page to look at a search with: the map, how the search unfolds, and the paths, in one file.

The page needs no server and loads nothing: ``write_page`` puts the data, the style and the script
into one HTML file.
"""

from hnr_planner.page.write import Shown, write_page

__all__ = ['Shown', 'write_page']
