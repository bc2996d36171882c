"""The server: a page, its files, and one WebSocket a page, whose frames go to the session."""

from __future__ import annotations

import asyncio
import time
from concurrent.futures import Executor
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from starlette.applications import Starlette
from starlette.requests import Request as HTTPRequest
from starlette.responses import FileResponse, RedirectResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from pliant.errors import PliantError
from pliant.studio.serving.answering import SMALL, Answer
from pliant.studio.serving.frames import MalformedFrame
from pliant.studio.serving.guard import Guard, Secret
from pliant.studio.session import Session

MOST_MESSAGE = 4 << 20  # bytes; files come in pieces
_MOST_PAGES = 16
_MOST_WAITING = 512 << 20  # bytes that a page may be behind
_RATE, _BURST = 400.0, 1200.0  # messages a second, and how many at once
_MALFORMED, _FLOOD, _SLOW, _MANY = 1007, 1008, 1013, 1013


class NoClient(PliantError):
    """The files of the page are not there."""


def client_folder() -> Path:
    """Where the page's files are.

    Raises
    ------
    NoClient
        They have not been built.
    """
    folder = Path(__file__).parents[1] / "client"
    if not (folder / "index.html").is_file():
        raise NoClient(
            "the studio's page has not been built: this is a clone without it. Install it again with network access "
            "(pip install -e .), or build it: cd studio-client && npm ci && npm run build"
        )
    return folder


def make_app(session: Session, secret: Secret, cookie_name: str, hosts: tuple[str, ...] = ()) -> Guard:
    """The application of a session, guarded."""
    folder = client_folder()

    async def page(request: HTTPRequest) -> Response:
        if "token" not in request.query_params:
            return FileResponse(folder / "index.html", headers={"cache-control": "no-store"})
        rest = {key: value for key, value in request.query_params.items() if key != "token"}
        answer = RedirectResponse(f"/?{urlencode(rest)}" if rest else "/", 303)
        answer.set_cookie(cookie_name, secret.cookie, httponly=True, samesite="strict", path="/")
        return answer

    async def alive(_: HTTPRequest) -> Response:
        return Response(status_code=204, headers={"cache-control": "no-store"})

    async def socket(websocket: WebSocket) -> None:
        await Page(session, websocket).talk()

    routes = [
        Route("/", page),
        Route("/alive", alive),
        WebSocketRoute("/socket", socket),
        Mount("/assets", StaticFiles(directory=folder / "assets")),
    ]
    return Guard(Starlette(routes=routes), secret, cookie_name, hosts)


class Page:
    """A page that is connected: frames in, one at a time; frames out, in order."""

    def __init__(self, session: Session, websocket: WebSocket) -> None:
        self._session, self._socket = session, websocket
        self._loop = asyncio.get_running_loop()
        self._outgoing: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._behind = 0
        self._allowance = Allowance(_RATE, _BURST)

    def send(self, data: bytes) -> None:
        """Queue a frame; called on the session's thread."""
        try:
            self._loop.call_soon_threadsafe(self._enqueue, data)
        except RuntimeError:  # the server has ended
            return

    async def talk(self) -> None:
        """Answer until the page goes."""
        await self._socket.accept()
        if len(self._session.clients) >= _MOST_PAGES:
            await self._socket.close(_MANY, "too many pages")
            return
        sender = asyncio.create_task(self._deliver())
        await self._on_session(self._session.join, self)
        try:
            await self._listen()
        except (WebSocketDisconnect, RuntimeError):
            pass  # it has gone
        finally:
            await self._on_session(self._session.leave, self)
            sender.cancel()

    async def _listen(self) -> None:
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            if not self._allowance.take():
                await self._socket.close(_FLOOD, "too many messages")
                return
            data = message.get("bytes")
            try:
                if data is None:
                    raise MalformedFrame("frames are bytes")
                await self._answer(data)
            except MalformedFrame as error:
                await self._socket.close(_MALFORMED, str(error)[:100])
                return

    async def _answer(self, data: bytes) -> None:
        """Step by step, each where it belongs: what is small is decoded here."""
        answer = Answer(self._session, self, data)
        if len(data) <= SMALL and answer.step is not None:
            answer.step()
        while answer.step is not None:
            pool = self._session.readers if answer.beside else self._session.worker
            if not await self._on(pool, answer.step):
                return

    async def _deliver(self) -> None:
        while (data := await self._outgoing.get()) is not None:
            await self._socket.send_bytes(data)
            self._behind -= len(data)

    def _enqueue(self, data: bytes) -> None:
        self._behind += len(data)
        if self._behind > _MOST_WAITING:
            self._loop.create_task(self._socket.close(_SLOW, "too far behind"))
            return
        self._outgoing.put_nowait(data)

    async def _on_session(self, work: Any, *arguments: Any) -> None:
        await self._on(self._session.worker, work, *arguments)

    async def _on(self, pool: Executor, work: Any, *arguments: Any) -> bool:
        """Whether it was done: not where the session has ended."""
        try:
            await self._loop.run_in_executor(pool, work, *arguments)
        except RuntimeError:
            return False
        return True


class Allowance:
    """So many messages a second, and a number of them at once: what floods is told apart from what is quick."""

    def __init__(self, rate: float, burst: float) -> None:
        self._rate, self._burst, self._left, self._then = rate, burst, burst, time.monotonic()

    def take(self) -> bool:
        """One message; False where there have been too many."""
        now = time.monotonic()
        self._left = min(self._burst, self._left + (now - self._then) * self._rate)
        self._then = now
        self._left -= 1
        return self._left >= 0
