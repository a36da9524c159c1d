"""
An HTML page that shows the map, how searches unfold, and their paths.

The page is one file that needs no server and loads nothing: ``write_page`` writes the data, the
style and the scripts into it.
"""

from hnr_planner.page.write import Shown, write_page

__all__ = ['Shown', 'write_page']
