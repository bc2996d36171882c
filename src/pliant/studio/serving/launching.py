"""Launching the studio: a port, a key, a server, a browser."""

from __future__ import annotations

import socket
import sys
import webbrowser
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from pliant.errors import InvalidParameter, MissingExtra, PliantError
from pliant.studio.autosave import Autosave, state_folder

if TYPE_CHECKING:
    import uvicorn

    from pliant.scene.scene import Scene
    from pliant.studio.session import Session

USUAL_PORT = 8477
_SWITCH = 1e-3  # seconds that a thread may hold the interpreter while others wait: there are answers among them


class PortInUse(PliantError):
    """Another program listens there."""


@dataclass
class Launch:
    """A studio that listens.

    Parameters
    ----------
    session
        What it edits.
    url
        Where it is, with its key.
    port
        The port.
    """

    session: Session
    url: str
    port: int
    _server: uvicorn.Server = field(repr=False)
    _socket: socket.socket = field(repr=False)
    _thread: Thread | None = field(default=None, repr=False)

    def run(self) -> None:
        """Serve until interrupted."""
        sys.setswitchinterval(_SWITCH)
        try:
            self._server.run(sockets=[self._socket])
        finally:
            self.session.end()

    def start(self) -> None:
        """Serve on a thread of its own."""
        self._thread = Thread(target=self.run, name="pliant-studio-server", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End."""
        self._server.should_exit = True
        if self._thread is not None:
            self._thread.join(timeout=10)

    def wait(self) -> None:
        """Until it ends."""
        if self._thread is not None:
            self._thread.join()

    def open_browser(self) -> bool:
        """Show it; False where no browser is found."""
        try:
            return webbrowser.open(self.url)
        except webbrowser.Error:
            return False


def launch(
    scene: Scene | None = None,
    name: str = "",
    *,
    port: int | None = None,
    root: Path | None = None,
    autosave: Path | None = None,
) -> Launch:
    """Make a studio that listens on this machine only.

    Parameters
    ----------
    scene
        What to show; None = the start page.
    name
        What the document is called.
    port
        Where to listen; None = the usual port, or any that is free.
    root
        The folder whose files pages may open; None = none.
    autosave
        The folder for unsaved work; None = the user's own.

    Raises
    ------
    MissingExtra
        The extra 'studio' is not installed.
    NoClient
        The page has not been built.
    PortInUse
        Another program listens at the port asked for.
    """
    try:
        import uvicorn

        from pliant.studio.serving.guard import Secret
        from pliant.studio.serving.server import MOST_MESSAGE, make_app
    except ImportError as error:
        raise MissingExtra("the studio", "studio") from error
    import pliant.studio.commands  # noqa: F401 -- registers what pages can ask for
    from pliant.studio.session import Session

    listening = _listen(port)
    number = int(listening.getsockname()[1])
    secret = Secret()
    session = Session(scene, name, root, Autosave(autosave or state_folder()))
    session.submit(warm_up)
    config = uvicorn.Config(
        make_app(session, secret, f"pliant_studio_{number}"),
        log_level="warning",
        ws="websockets-sansio",
        ws_max_size=MOST_MESSAGE,
        ws_per_message_deflate=False,
        lifespan="off",
        timeout_graceful_shutdown=2,
        server_header=False,
    )
    url = f"http://127.0.0.1:{number}/?token={secret.token}"
    return Launch(session, url, number, uvicorn.Server(config), listening)


def warm_up() -> None:
    """Compile what the first drag would wait for."""
    import numpy as np

    from pliant.mesh import PolygonMesh
    from pliant.numerics.ragged import Ragged
    from pliant.scene.layer import Layer
    from pliant.scene.stack import Stack
    from pliant.space.bspline_ffd import BSplineFFD
    from pliant.studio.seen.drawn import DrawnMesh

    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = PolygonMesh(corners, Ragged.of(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])))
    lattice = BSplineFFD.around(mesh)
    drag = Stack((Layer("warm", lattice),)).bind(mesh).drag_layer("warm")
    moved = lattice.controls.copy()
    moved[0, 0, 0] += 0.1
    touched = drag.update(moved, [(0, 0, 0)])
    DrawnMesh(mesh).moved(drag.points, touched)


def _listen(port: int | None) -> socket.socket:
    """A socket on this machine's own address: nobody else can connect."""
    if port is not None and not 0 <= port < 65536:
        raise InvalidParameter(f"there is no port {port}")
    for number in (port,) if port is not None else (USUAL_PORT, 0):
        listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind(("127.0.0.1", number))
        except OSError as error:
            listening.close()
            if number == port:
                raise PortInUse(f"port {port} is in use: give another with --port, or leave it out") from error
            continue
        listening.listen(128)  # who comes before the server runs waits for it
        listening.set_inheritable(True)
        return listening
    raise PortInUse("no port is free")
