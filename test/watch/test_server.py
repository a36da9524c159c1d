"""The server of the page, over real HTTP and real WebSockets, without ROS."""

import asyncio
from collections.abc import Awaitable, Callable
import json
import re
from test.watch.reader import read
from typing import Any

from hnr_planner.watch import hub as hub_module
from hnr_planner.watch.hub import Hub, Viewer
from hnr_planner.watch.server import application, Planning
from hnr_planner.watch.wire import pack
import numpy as np
import pytest
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest, HTTPResponse
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.websocket import websocket_connect, WebSocketClientConnection

TOKEN = 'a-token_of-16-and-more'
PATIENCE = 20.0


class Site:
    """A server for a test, and what a browser would do with it."""

    def __init__(self, token: str | None = None, plan: Planning | None = None) -> None:
        self.watched: list[bool] = []
        self.hub = Hub(self.watched.append)
        sockets = bind_sockets(0, '127.0.0.1')
        self.host = f'127.0.0.1:{sockets[0].getsockname()[1]}'
        HTTPServer(application(self.hub, 'robot', token, plan)).add_sockets(sockets)

    async def get(self, path: str = '/', **headers: str) -> HTTPResponse:
        request = HTTPRequest(f'http://{self.host}{path}', headers=headers, follow_redirects=False)
        return await AsyncHTTPClient().fetch(request, raise_error=False)

    async def connect(self, path: str = '/live', **headers: str) -> WebSocketClientConnection:
        request = HTTPRequest(f'ws://{self.host}{path}', headers=headers)
        return await asyncio.wait_for(websocket_connect(request), PATIENCE)

    async def refusal(self, path: str = '/live', **headers: str) -> int:
        with pytest.raises(HTTPClientError) as refused:
            await self.connect(path, **headers)
        return refused.value.code


async def receive(page: WebSocketClientConnection) -> tuple[dict[str, Any], list[np.ndarray]]:
    message = await asyncio.wait_for(page.read_message(), PATIENCE)
    assert isinstance(message, bytes)
    return read(message)


async def until(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds, or fail."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.01)


def ask(page: WebSocketClientConnection, **request: Any) -> None:
    page.write_message(json.dumps(request))


def serving(*arguments: Any) -> Callable[[Callable[[Site], Awaitable[None]]], None]:
    """Run a coroutine on a site of its own."""

    def run(steps: Callable[[Site], Awaitable[None]]) -> None:
        async def main() -> None:
            await steps(Site(*arguments))

        asyncio.run(main())

    return run


def test_the_page_runs_nothing_but_its_own_script() -> None:
    @serving()
    async def steps(site: Site) -> None:
        response = await site.get()
        assert response.code == 200
        policy = response.headers['Content-Security-Policy']
        assert "default-src 'none'" in policy and 'unsafe' not in policy
        page = response.body.decode()
        assert not re.search(r'(src|href)=|@import|url\(', page)
        assert response.headers['Cache-Control'] == 'no-store'
        assert (await site.get('/elsewhere')).code == 404


@pytest.mark.parametrize('host', ['evil.example', 'evil.example:8000', 'x'])
def test_a_name_that_was_made_to_point_here_is_refused(host: str) -> None:
    @serving()
    async def steps(site: Site) -> None:
        assert (await site.get(Host=host)).code == 403
        assert await site.refusal(Host=host, Origin=f'http://{host}') == 403


def test_pages_of_other_sites_are_refused() -> None:
    @serving()
    async def steps(site: Site) -> None:
        for origin in ('http://evil.example', 'null', f'http://{site.host}1', 'http://127.0.0.1'):
            assert await site.refusal(Origin=origin) == 403
        page = await site.connect(Origin=f'http://{site.host}')
        page.close()


def test_without_the_token_nothing_is_served() -> None:
    @serving(TOKEN)
    async def steps(site: Site) -> None:
        cookie = f'hnr_planner_{site.host.rpartition(":")[2]}'
        for path, headers in (
            ('', {}),
            ('?token=', {}),
            (f'?token={TOKEN[:-1]}', {}),
            ('', {'Cookie': f'{cookie}=wrong'}),
            ('', {'Cookie': f'token={TOKEN}'}),
        ):
            refused = await site.get(f'/{path}', **headers)
            assert refused.code == 401 and TOKEN not in refused.body.decode()
            assert await site.refusal(f'/live{path}', **headers) == 401
        assert site.watched == []


def test_the_token_of_the_address_becomes_a_cookie() -> None:
    @serving(TOKEN)
    async def steps(site: Site) -> None:
        first = await site.get(f'/?token={TOKEN}')
        assert first.code == 302 and first.headers['Location'] == '/'
        words = first.headers['Set-Cookie']
        assert 'HttpOnly' in words and 'SameSite=Lax' in words
        cookie = words.partition(';')[0]
        page = await site.get(Cookie=cookie)
        assert page.code == 200 and TOKEN not in page.body.decode()
        (await site.connect(Cookie=cookie, Origin=f'http://{site.host}')).close()
        # The right token opens nothing to another site.
        assert await site.refusal(Cookie=cookie, Origin='http://evil.example') == 403


def test_who_comes_later_gets_what_others_see_at_once() -> None:
    @serving()
    async def steps(site: Site) -> None:
        first = await site.connect()
        points = np.arange(6, dtype=np.float32).reshape(3, 2)
        site.hub.put('search', pack('search', {'why': 'no "<path>"'}, [points, points[:1]]))
        site.hub.put('map', pack('map', {}, [np.arange(5, dtype=np.uint8)]))
        site.hub.put('map', pack('map', {'newer': True}))
        second = await site.connect()
        for page in (first, second):
            header, arrays = await receive(page)
            assert header['why'] == 'no "<path>"'
            assert [array.tolist() for array in arrays] == [[0, 1, 2, 3, 4, 5], [0, 1]]
        assert (await receive(second))[0]['newer']
        site.hub.forget('search')
        third = await site.connect()
        assert (await receive(third))[0]['kind'] == 'map'
        for page in (first, second, third):
            page.close()


def test_there_is_listening_while_somebody_looks() -> None:
    @serving()
    async def steps(site: Site) -> None:
        assert site.watched == []
        pages = [await site.connect() for _ in range(2)]
        assert site.watched == [True]
        for page in pages:
            page.close()
        await until(lambda: len(site.watched) > 1)
        assert site.watched == [True, False]


def test_a_page_too_many_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hub_module, 'MOST_VIEWERS', 2)

    @serving()
    async def steps(site: Site) -> None:
        pages = [await site.connect() for _ in range(2)]
        assert await site.refusal() == 503
        pages[0].close()


def test_a_slow_page_misses_messages_and_holds_nobody_up() -> None:
    async def main() -> None:
        hub = Hub(lambda _: None)
        slow, quick = Viewer(), Viewer()
        for viewer in (slow, quick):
            hub.enter(viewer)
        for number in range(1000):
            hub.put('search', b'search %d' % number)
            hub.put('map', b'map %d' % number)
            assert await quick.get() == b'search %d' % number
            assert await quick.get() == b'map %d' % number
        assert [await slow.get(), await slow.get()] == [b'search 999', b'map 999']
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(slow.get(), 0.01)

    asyncio.run(main())


def test_a_page_to_look_at_plans_nothing() -> None:
    @serving()
    async def steps(site: Site) -> None:
        page = await site.connect()
        ask(page, kind='plan', start=[1, 2], goal=[3, 4])
        header, _ = await receive(page)
        assert header['kind'] == 'refused' and '--allow-requests' in header['why']


def test_a_click_plans_one_request_at_a_time() -> None:
    asked: list[tuple] = []

    def plan(*request: Any) -> None:
        asked.append(request)

    @serving(None, plan)
    async def steps(site: Site) -> None:
        page, other = await site.connect(), await site.connect()
        ask(page, kind='plan', start=[1, 2.5], goal=[-3, 4])
        ask(page, kind='plan', start=[1, 2], goal=[3, 4])
        assert 'still runs' in (await receive(page))[0]['why']
        ask(other, kind='plan', start=[5, 6], goal=[7, 8])
        await until(lambda: len(asked) == 2)
        assert [request[:2] for request in asked] == [
            ((1.0, 2.5), (-3.0, 4.0)),
            ((5.0, 6.0), (7.0, 8.0)),
        ]
        asked[0][2]('the node has ended')
        assert (await receive(page))[0]['why'] == 'the node has ended'
        ask(page, kind='plan', start=[1, 2], goal=[3, 4])
        await until(lambda: len(asked) == 3)


@pytest.mark.parametrize(
    'message',
    [
        'not JSON',
        '[]',
        '{}',
        '{"kind": "cancel", "start": [1, 2], "goal": [3, 4]}',
        '{"kind": "plan", "start": [1, 2]}',
        '{"kind": "plan", "start": [1, 2, 3], "goal": [3, 4]}',
        '{"kind": "plan", "start": [1, null], "goal": [3, 4]}',
        '{"kind": "plan", "start": [1, NaN], "goal": [3, 4]}',
        '{"kind": "plan", "start": [1, 1e300], "goal": [3, 4]}',
        '[' * 4000,
    ],
)
def test_what_is_no_request_is_refused(message: str) -> None:
    @serving(None, lambda *_: pytest.fail('planned'))
    async def steps(site: Site) -> None:
        page = await site.connect()
        page.write_message(message)
        assert 'not one for a plan' in (await receive(page))[0]['why']


def test_a_message_that_is_far_too_long_ends_its_connection() -> None:
    @serving(None, lambda *_: pytest.fail('planned'))
    async def steps(site: Site) -> None:
        page = await site.connect()
        page.write_message('1' * 100_000)
        assert await asyncio.wait_for(page.read_message(), PATIENCE) is None
