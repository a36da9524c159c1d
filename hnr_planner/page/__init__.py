"""
HTML pages that show a map, how searches on it unfold, and their paths.

``write.write_page`` makes a page of one request, a file that needs no server and loads nothing.
``compose.live_page`` makes the page that ``hnr_planner.watch`` serves, which shows a running node.
Both have the same style and scripts.
"""
