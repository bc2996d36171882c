"""``pl.studio.show``: the studio from a script, whose edits come back."""

from __future__ import annotations

import sys
from pathlib import Path

from pliant.deformer import Deformer
from pliant.mesh import PolygonMesh
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.serving.launching import Launch, launch


class Studio:
    """A studio that is open beside the program.

    Parameters
    ----------
    launched
        Where it listens.
    """

    def __init__(self, launched: Launch) -> None:
        self._launch = launched

    @property
    def url(self) -> str:
        """The address, with its key: for this machine's browser."""
        return self._launch.url

    @property
    def scene(self) -> Scene | None:
        """What is shown now; None where the document was closed."""
        return self._launch.session.scene

    @property
    def stack(self) -> Stack:
        """What deforms the shape now."""
        scene = self.scene
        return Stack() if scene is None else scene.stack

    def wait(self) -> Stack:
        """Until the studio ends (Ctrl-C); gives the last stack."""
        try:
            self._launch.wait()
        except KeyboardInterrupt:
            self.close()
        return self.stack

    def close(self) -> None:
        """End the studio."""
        self._launch.stop()

    def __repr__(self) -> str:
        return f"Studio({self.url})"


def show(
    mesh: PolygonMesh | Scene,
    stack: Stack | Deformer | None = None,
    *,
    name: str = "shape",
    port: int | None = None,
    root: Path | str | None = None,
    browser: bool = True,
    wait: bool | None = None,
) -> Studio:
    """Open the studio on a mesh, and the browser on the studio.

    Parameters
    ----------
    mesh
        The shape, or a whole scene.
    stack
        What deforms it: a stack, or one deformer.
    name
        What the document is called.
    port
        Where to listen on this machine; None = any port that is free.
    root
        The folder whose files the page may open; None = none.
    browser
        Whether to open one.
    wait
        Whether to return only when the studio ends; None = where the program is not interactive.

    Returns
    -------
    Studio
        Its ``stack`` is what people have made of it, at any time.

    Raises
    ------
    MissingExtra
        The extra 'studio' is not installed.
    """
    scene = mesh if isinstance(mesh, Scene) else Scene(mesh, as_stack(stack))
    launched = launch(scene, name, port=port, root=None if root is None else Path(root))
    launched.start()
    studio = Studio(launched)
    print(f"pliant studio: {launched.url}", file=sys.stderr)  # noqa: T201 -- its key is told nowhere else
    if browser:
        launched.open_browser()
    if wait or (wait is None and not _interactive()):
        studio.wait()
    return studio


def as_stack(stack: Stack | Deformer | None) -> Stack:
    """A stack of what was given: nothing, a deformer, a stack."""
    if stack is None:
        return Stack()
    return stack if isinstance(stack, Stack) else Stack((Layer(type(stack).__name__, stack),))


def _interactive() -> bool:
    return hasattr(sys, "ps1") or "IPython" in sys.modules
