"""Who may talk to the studio: this machine's browser, from the page that the studio itself has served.

A random token of each launch is exchanged for a cookie that no script can read and no other site can send. Host must be
a name of this machine, which stops rebinding of names; Origin must be the very page, which stops other pages; both are
asked of every request, and a WebSocket without an Origin is refused.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")

_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": _POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "x-frame-options": "DENY",
}


@dataclass(frozen=True)
class Secret:
    """What a launch of the studio knows and nobody else.

    Parameters
    ----------
    token
        Stands in the address that is printed; good for getting a cookie.
    cookie
        The cookie's value.
    """

    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(32))

    def is_token(self, given: str) -> bool:
        """Whether this is the token."""
        return secrets.compare_digest(given.encode(), self.token.encode())

    def is_cookie(self, given: str) -> bool:
        """Whether this is the cookie's value."""
        return secrets.compare_digest(given.encode(), self.cookie.encode())


class Guard:
    """Refuses whatever is not the studio's own page, before anything else sees it.

    Parameters
    ----------
    app
        What is guarded.
    secret
        The launch's.
    cookie_name
        Differs between studios of one machine, which share cookies.
    hosts
        Names under which the studio may be addressed, beside those of this machine.
    """

    def __init__(self, app: ASGIApp, secret: Secret, cookie_name: str, hosts: tuple[str, ...] = ()) -> None:
        self._app, self._secret, self._name = app, secret, cookie_name
        self._hosts = {*LOOPBACK, *hosts}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        refused = self._refusal(scope)
        if refused is None:
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": refused[1]})
        else:
            await PlainTextResponse(refused[1], refused[0])(scope, receive, _with_headers(send))

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Status and reason; None where the request is in order."""
        headers = Headers(scope=scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if _name_of(host) not in self._hosts:
            return 421, "this studio has another name"
        if origin is not None and _host_of(origin) != host.lower():
            return 403, "another page asked"
        if scope["type"] == "websocket" and origin is None:
            return 403, "a page must say where it comes from"
        connection = HTTPConnection(scope)
        if self._secret.is_cookie(connection.cookies.get(self._name, "")):
            return None
        entering = scope["type"] == "http" and scope["path"] == "/" and scope["method"] == "GET"
        if entering and self._secret.is_token(connection.query_params.get("token", "")):
            return None
        return 401, "open the address that pliant studio printed: it holds a key"


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sending


def _name_of(host: str) -> str:
    """A host without its port."""
    name, _, port = host.lower().rpartition(":")
    return name if name and port.isdecimal() else host.lower()


def _host_of(origin: str) -> str:
    """Host and port of an origin; empty where it is none of the web."""
    try:
        parts = urlsplit(origin.lower())
    except ValueError:
        return ""
    return parts.netloc if parts.scheme in ("http", "https") else ""
