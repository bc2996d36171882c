"""The studio in a cell of a notebook; what is edited there comes back as a stack."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pliant.deformer import Deformer
from pliant.errors import MissingExtra
from pliant.mesh import PolygonMesh
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.serving.frames import MalformedFrame
from pliant.studio.serving.server import client_folder
from pliant.studio.session import Session
from pliant.studio.showing import as_stack

try:
    import anywidget
    import traitlets
except ImportError as error:
    raise MissingExtra("the studio in a notebook", "studio") from error


class Widget(anywidget.AnyWidget):
    """An editor in a cell.

    Parameters
    ----------
    mesh
        The shape, or a whole scene.
    stack
        What deforms it: a stack, or one deformer.
    height
        Of the cell's output, in pixels.
    """

    height = traitlets.Int(620).tag(sync=True)

    def __init__(self, mesh: PolygonMesh | Scene, stack: Stack | Deformer | None = None, *, height: int = 620) -> None:
        import pliant.studio.commands  # noqa: F401 -- registers what pages can ask for

        folder: Path = client_folder()
        self._esm = (folder / "widget.js").read_text(encoding="utf-8")
        self._css = (folder / "widget.css").read_text(encoding="utf-8")
        super().__init__(height=height)
        scene = mesh if isinstance(mesh, Scene) else Scene(mesh, as_stack(stack))
        self._session = Session(scene, "shape")
        self.on_msg(self._receive)

    @property
    def scene(self) -> Scene:
        """What is shown now."""
        return self._session.required

    @property
    def stack(self) -> Stack:
        """What deforms the shape now."""
        return self.scene.stack

    def _receive(self, _: Any, content: Any, buffers: list[Any]) -> None:
        """A message of the page. The notebook's own thread runs the command: its channel is not for others."""
        if isinstance(content, dict) and content.get("hello"):
            page = _Page(self)
            self._session.clients.clear()
            self._session.join(page)
            return
        if self._session.clients and buffers:
            try:
                self._session.handle(self._session.clients[0], bytes(buffers[0]))
            except MalformedFrame:
                return


class _Page:
    """The page behind a widget."""

    def __init__(self, widget: Widget) -> None:
        self._widget = widget

    def send(self, data: bytes) -> None:
        self._widget.send({"frame": True}, [data])
