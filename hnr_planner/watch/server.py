"""The HTTP and WebSocket server of the page."""

from __future__ import annotations

import asyncio
import base64
from collections.abc import Callable
from contextlib import suppress
import hashlib
import json
import math
import re
from typing import Any
from urllib.parse import urlsplit

from hnr_planner.page.compose import live_page
from hnr_planner.watch.access import is_own_name, is_token
from hnr_planner.watch.hub import Hub, Viewer
from hnr_planner.watch.wire import pack
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

#: Largest message from a page [bytes].
LARGEST_MESSAGE = 4096
#: Time [s] from one sign of life that is asked of a page to the next.
PING_INTERVAL = 10.0
#: Largest coordinate of a click [m].
FARTHEST = 1e9

#: A point (x, y) [m] in the map's frame.
Point = tuple[float, float]
#: Plans from one point to another; calls the function with an empty text at the end of the
#: request, or else with the reason why nobody has been asked.
Planning = Callable[[Point, Point, Callable[[str], None]], None]


def application(hub: Hub, title: str, token: str | None, plan: Planning | None) -> Application:
    """
    Return the application that serves the page and the messages for it.

    Parameters
    ----------
    hub : Hub
        What pages are to see.
    title : str
        Heading of the page.
    token : str, optional
        What a browser has to know, as ``?token=``; None for no token.
    plan : callable, optional
        Plans where a page was clicked; None where pages are to look at only.

    """
    state: dict[str, Any] = {
        'live': True,
        'requests': plan is not None,
        'map': None,
        'start': None,
        'goal': None,
        'goal_radius': 0.0,
        'footprint': [],
        'simplify': True,
    }
    page = live_page(title, state)
    access = {'token': token}
    return Application(
        [
            ('/', _Page, access | {'page': page, 'policy': _policy(page)}),
            ('/live', _Live, access | {'hub': hub, 'plan': plan}),
        ],
        websocket_max_message_size=LARGEST_MESSAGE,
        websocket_ping_interval=PING_INTERVAL,
        log_function=lambda _handler: None,  # addresses may have the token in them
    )


def _policy(page: str) -> str:
    """Return the content security policy of a page: nothing runs but the page's own script."""
    script, style = (
        base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        for name in ('script', 'style')
        for text in re.findall(f'<{name}>(.*?)</{name}>', page, re.DOTALL)
    )
    return (
        f"default-src 'none'; script-src 'sha256-{script}'; style-src 'sha256-{style}'; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


class _Guarded(RequestHandler):
    """A handler that answers only who names this machine, and has the token if there is one."""

    token: str | None

    def prepare(self) -> None:
        """Refuse a request with another Host than this machine's, or without the token."""
        if not is_own_name(self.request.host):
            raise HTTPError(403, reason='Not a name of this machine')
        given = (self.get_query_argument('token', None), self.get_cookie(self.cookie))
        if self.token is not None and not any(is_token(item, self.token) for item in given):
            raise HTTPError(401, reason='No token, or a wrong one')

    @property
    def cookie(self) -> str:
        """Name of the cookie that holds the token: cookies of all ports of a host are shared."""
        return f'hnr_planner_{urlsplit(f"//{self.request.host}").port or 80}'

    def write_error(self, status_code: int, **_more: Any) -> None:
        """Write the reason of a refusal as text."""
        self.set_header('Content-Type', 'text/plain; charset=utf-8')
        self.finish(f'{status_code}: {self._reason}\n')


class _Page(_Guarded):
    """The page itself."""

    def initialize(self, token: str | None, page: str, policy: str) -> None:
        """Take the token, the page and its content security policy."""
        self.token, self._html, self._policy = token, page, policy

    def get(self) -> None:
        """Send the page, or move a token from the address into a cookie and ask to load again."""
        if self.token is not None and self.get_query_argument('token', None) is not None:
            self.set_cookie(self.cookie, self.token, httponly=True, samesite='Lax')
            self.redirect('/')
            return
        self.set_header('Content-Security-Policy', self._policy)
        self.set_header('X-Content-Type-Options', 'nosniff')
        self.set_header('Referrer-Policy', 'no-referrer')
        self.set_header('Cache-Control', 'no-store')
        self.finish(self._html)


class _Live(_Guarded, WebSocketHandler):
    """
    The messages for one page, and the requests from it.

    Tornado refuses connections from pages of another origin.
    """

    def initialize(self, token: str | None, hub: Hub, plan: Planning | None) -> None:
        """Take the token, the hub, and what plans."""
        self.token, self._hub, self._plan = token, hub, plan
        self._viewer = Viewer()
        self._is_planning = False
        self._sending: asyncio.Task[None] | None = None

    def prepare(self) -> None:
        """Refuse a viewer too many, besides what all handlers refuse."""
        super().prepare()
        if self._hub.is_full:
            raise HTTPError(503, reason='Too many pages are open')

    def open(self, *_args: str, **_more: str) -> None:
        """Begin to send messages."""
        self._hub.enter(self._viewer)
        self._sending = asyncio.get_running_loop().create_task(self._send())

    async def _send(self) -> None:
        """Send messages one by one: the next is chosen when the page has taken the last."""
        with suppress(WebSocketClosedError):
            while True:
                await self.write_message(await self._viewer.get(), binary=True)

    def on_message(self, message: str | bytes) -> None:
        """Plan as the page asks, or say why not."""
        why = self._begin(message)
        if why:
            self._refuse(why)

    def on_close(self) -> None:
        """End the sending of messages."""
        if self._sending is not None:
            self._sending.cancel()
            self._hub.leave(self._viewer)

    def _begin(self, message: str | bytes) -> str:
        """Begin to plan; return why not where that is refused, else an empty text."""
        if self._plan is None:
            return 'this page is to look at only: it is served without --allow-requests'
        try:
            start, goal = _ends(message)
        except (ValueError, KeyError, TypeError, RecursionError):
            return 'the request is not one for a plan between two points'
        if self._is_planning:
            return 'the last request still runs'
        self._is_planning = True
        self._plan(start, goal, self._end)
        return ''

    def _end(self, why: str) -> None:
        self._is_planning = False
        if why:
            self._refuse(why)

    def _refuse(self, why: str) -> None:
        self._viewer.put('refused', pack('refused', {'why': why}))


def _ends(message: str | bytes) -> tuple[Point, Point]:
    """Return start and goal of a page's request; raise an exception where it has none."""
    request = json.loads(message)
    if request['kind'] != 'plan':
        raise ValueError(request['kind'])
    start, goal = (_point(request[name]) for name in ('start', 'goal'))
    return start, goal


def _point(value: Any) -> Point:
    x, y = (float(number) for number in value)
    if not all(math.isfinite(number) and abs(number) <= FARTHEST for number in (x, y)):
        raise ValueError(value)
    return x, y
