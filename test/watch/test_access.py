"""Who may look: addresses, tokens, and the names by which a browser asks for the page."""

import socket

from hnr_planner.watch.access import check_access, is_own_name, is_token, WatchError
import pytest

TOKEN = 'a-token_of-16-and-more'


@pytest.mark.parametrize('host', ['127.0.0.1', '127.3.2.1', '::1', 'localhost'])
def test_this_machine_needs_no_token(host: str) -> None:
    check_access(host, None)
    check_access(host, TOKEN)


@pytest.mark.parametrize('host', ['0.0.0.0', '::', '', '192.168.1.7', 'robot', 'localhost.evil'])
def test_other_machines_need_one(host: str) -> None:
    with pytest.raises(WatchError, match='other machines: give a --token'):
        check_access(host, None)
    check_access(host, TOKEN)


@pytest.mark.parametrize('token', ['', 'short', 'x' * 15, 'sixteen letters;', f'{TOKEN}\n'])
@pytest.mark.parametrize('host', ['127.0.0.1', '0.0.0.0'])
def test_a_token_that_is_short_or_unfit_is_refused(host: str, token: str) -> None:
    with pytest.raises(WatchError, match='at least 16'):
        check_access(host, token)


OWN = socket.gethostname()


@pytest.mark.parametrize(
    'host',
    ['127.0.0.1:8000', '[::1]:8000', 'localhost', 'LOCALHOST:1', '10.0.0.5:80', f'{OWN}:8000'],
)
def test_addresses_and_own_names_are_beyond_doubt(host: str) -> None:
    assert is_own_name(host)


@pytest.mark.parametrize(
    'host',
    ['evil.example:8000', 'localhost.evil.example', '127.0.0.1.evil.example', '', '[::1', 'a:b'],
)
def test_names_of_sites_are_not(host: str) -> None:
    assert not is_own_name(host)


def test_only_the_whole_token_is_right() -> None:
    assert is_token(TOKEN, TOKEN)
    for given in (None, '', TOKEN[:-1], f'{TOKEN} ', TOKEN.upper(), '\u00e9'):
        assert not is_token(given, TOKEN)
