"""Access to the page: the address that is served, the token, and the name in a request."""

from __future__ import annotations

import hmac
from ipaddress import ip_address
import re
import socket
from urllib.parse import urlsplit

from hnr_planner.core.errors import HnrError

#: The form of a token: long enough that nobody guesses it, and fit for a URL and a cookie.
TOKEN = re.compile(r'[A-Za-z0-9_-]{16,}')


class WatchError(HnrError, ValueError):
    """The page cannot be served as it was asked for; the message says why."""


def check_access(host: str, token: str | None) -> None:
    """
    Check that the page would not be open to whoever can reach it.

    Parameters
    ----------
    host : str
        Address or name that the page is to be served on.
    token : str, optional
        What a browser has to know; None for no token.

    Raises
    ------
    WatchError
        When the token has another form than ``TOKEN``, or when there is none and other machines
        could reach ``host``.

    """
    if token is not None and not TOKEN.fullmatch(token):
        raise WatchError('the token must have at least 16 letters, digits, - or _')
    if token is None and not is_loopback(host):
        raise WatchError(
            f'{host} can be reached from other machines: give a --token that browsers have to '
            'know, or serve 127.0.0.1 and reach it through ssh -L'
        )


def is_loopback(host: str) -> bool:
    """Return whether only this machine can reach an address or name."""
    if host == 'localhost':
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def is_own_name(host: str) -> bool:
    """
    Return whether a Host header, such as ``robot.local:8000``, names this machine beyond doubt.

    Addresses do, ``localhost`` does, and the machine's own name, alone or in ``.local``. Any other
    name may be that of a site which made it point here, so that its scripts could read the page.
    """
    try:
        parts = urlsplit(f'//{host}')
        name, _ = parts.hostname or '', parts.port
    except ValueError:  # a bracket too few, or a port that is no number
        return False
    own = socket.gethostname().lower()
    short = own.partition('.')[0]
    if name in {'localhost', own, short, f'{short}.local'}:
        return True
    try:
        ip_address(name)
    except ValueError:
        return False
    return True


def is_token(given: str | None, token: str) -> bool:
    """Return whether the right token was given; the time it takes tells nothing about it."""
    return given is not None and hmac.compare_digest(given.encode(), token.encode())
