"""Put a page together from its template, style, scripts and data."""

from __future__ import annotations

from collections.abc import Sequence
import html
from importlib.resources import files
import json
from string import Template
from typing import Any

#: Scripts that all pages share, in the order in which they run.
SHARED = ('searches.js', 'drawing.js', 'view.js', 'page.js')
#: Paragraph at the top of the panel of a page of one request.
INTRODUCTION = (
    '<p>Planners look for a path from <span id="from">&#9679;</span> to '
    '<span id="to">&#9733;</span> by sampling the free space at random.</p>'
)


def request_page(title: str, data: dict[str, Any]) -> str:
    """Return the page, as HTML, of one request whose ``data`` the page holds."""
    return _page(title, INTRODUCTION, ['page.css'], [*SHARED, 'request.js'], data)


def live_page(title: str, data: dict[str, Any]) -> str:
    """Return the page, as HTML, that gets what it shows by a WebSocket; ``data`` is its state."""
    panel = _text('live.html')
    return _page(title, panel, ['page.css', 'live.css'], [*SHARED, 'live.js'], data)


def _page(
    title: str, panel: str, styles: Sequence[str], scripts: Sequence[str], data: dict[str, Any]
) -> str:
    return Template(_text('page.html')).substitute(
        title=html.escape(title),
        panel=panel,
        style='\n'.join(map(_text, styles)),
        script='\n'.join(map(_text, scripts)),
        # Nothing in the data may end the script element that holds it.
        data=json.dumps(data).replace('<', '\\u003c'),
    )


def _text(name: str) -> str:
    """Return the text of a file of this package."""
    return (files(__package__) / name).read_text(encoding='utf-8')
