"""The session: one scene with its history, and the pages that look at it.

All that changes it runs on one thread, a command at a time, so that nothing has to be locked: a command is a small
function of the registry. A drag is begin, previews, commit: one entry of the history. What a drag touches goes to the
page that drags in the answer, to the others as an event.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.scene.pictures import pictures_folder
from pliant.scene.scene import Scene
from pliant.studio.autosave import Autosave
from pliant.studio.dragging import Dragging
from pliant.studio.examples.samples import samples_folder
from pliant.studio.history import Entry, History
from pliant.studio.jobs import Jobs
from pliant.studio.modes.posing import keyed, within
from pliant.studio.request import Client
from pliant.studio.seen.catalogue import catalogue
from pliant.studio.seen.stage import Stage
from pliant.studio.seen.state import scene_state
from pliant.studio.serving.answering import Answer
from pliant.studio.serving.files import Uploads
from pliant.studio.serving.frames import Frame

_READERS = 4  # commands that are answered beside the session at once


class Session:
    """A scene that people edit.

    Parameters
    ----------
    scene
        What to begin with; None = the start page.
    name
        What the document is called.
    root
        The folder whose files pages may open; None = no folder.
    autosave
        Where unsaved work is kept; None = nowhere.
    """

    def __init__(
        self, scene: Scene | None = None, name: str = "", root: Path | None = None, autosave: Autosave | None = None
    ) -> None:
        self.root = None if root is None else root.resolve()
        self.autosave = autosave
        self.uploads = Uploads()
        self.history: History | None = None
        self.stage: Stage | None = None
        self.dragging: Dragging | None = None
        self.name, self.revision, self.saved = name, 0, 0
        self.time, self.recording = 0.0, False  # the playhead, in seconds, and whether edits set keys there
        self.locked: dict[str, set[int]] = {}
        self.beside: dict[str, Any] = {}  # what modes keep beside the scene, by their names: forgotten with it
        self.clients: list[Client] = []
        self.jobs = Jobs(self)
        self.worker = ThreadPoolExecutor(1, "pliant-studio")
        self.readers = ThreadPoolExecutor(_READERS, "pliant-studio-reader")
        self._alone = ExitStack()  # small systems are solved by the dozen: several BLAS threads wait for one another
        self.worker.submit(self._alone.enter_context, one_blas_thread())
        if scene is not None:
            self.begin(scene, name)

    @property
    def scene(self) -> Scene | None:
        """The scene as it stands at the time that is shown; None on the start page."""
        return None if self.stage is None else self.stage.scene

    @property
    def required(self) -> Scene:
        """The scene that is shown.

        Raises
        ------
        InvalidParameter
            Nothing is open.
        """
        if self.scene is None:
            raise InvalidParameter("nothing is open: open a mesh first")
        return self.scene

    @property
    def shown(self) -> Stage:
        """What the pages show of the scene."""
        assert self.required is not None
        assert self.stage is not None
        return self.stage

    def join(self, client: Client) -> None:
        """A page has come: tell it all."""
        self.clients.append(client)
        client.send(Frame({"event": "hello", "catalogue": catalogue(self)}).encode())
        self._tell_scene([client])
        if self.stage is not None:
            client.send(self.stage.mesh_frame().encode())
        self.jobs.tell_fold([client])

    def leave(self, client: Client) -> None:
        """A page has gone; what it was dragging goes back."""
        if client in self.clients:
            self.clients.remove(client)
        if self.dragging is not None and self.dragging.client is client:
            self.drop_drag()

    def handle(self, client: Client, data: bytes) -> None:
        """Run the command of a frame, and answer it: all its steps on this thread.

        Raises
        ------
        MalformedFrame
            The bytes are no command.
        """
        answer = Answer(self, client, data)
        while answer.step is not None:
            answer.step()

    def as_it_stands(self) -> Session:
        """What a command that only reads is given, while others go on editing; nothing is being dragged in it."""
        found = copy(self)
        found.dragging, found.stage = None, copy(self.stage)
        return found

    def begin(self, scene: Scene | Stage, name: str, key: str = "open") -> None:
        """Show another scene, with a history of its own; as a stage where it has been evaluated already."""
        self.drop_drag()
        stage = scene if isinstance(scene, Stage) else Stage(scene)
        self.history, self.stage = History(Entry(stage.given, key, name)), stage
        self.name, self.locked, self.beside = name, {}, {}
        self.time, self.recording = 0.0, False
        self.revision += 1
        self.saved = self.revision
        self._tell_scene(self.clients)
        self.broadcast(self.stage.mesh_frame())
        self.jobs.look_for_folds()

    def close(self) -> None:
        """Back to the start page."""
        self.drop_drag()
        self.history = self.stage = None
        self.name, self.beside = "", {}
        self.revision += 1
        self.saved = self.revision
        if self.autosave is not None:
            self.autosave.forget()
        self.broadcast(Frame({"event": "hello", "catalogue": catalogue(self)}))
        self._tell_scene(self.clients)

    def commit(self, scene: Scene, key: str, subject: str = "") -> None:
        """Show a scene that has been made of the present one, as a new entry of the history."""
        assert self.history is not None
        scene = keyed(self.required, scene, self.time, self.recording)
        time = within(scene, self.time)
        self.shown.show(scene, time)  # where this fails, nothing has happened
        self.time = time
        self.history.push(Entry(scene, key, subject))
        self.changed()

    def go(self, position: int) -> None:
        """Show another entry of the history."""
        assert self.required is not None
        assert self.history is not None
        self.drop_drag()
        if self.history.go(position):
            self.time = within(self.history.scene, self.time)
            self.shown.show(self.history.scene, self.time)
            self.changed()

    def go_to(self, time: float) -> None:
        """Show the scene at another time: no change, and no entry of the history."""
        scene = self.required
        self.drop_drag()
        self.shown.show(scene, time)
        self.time = time
        moved = self.shown.moved_frame()
        if moved is not None:
            self.broadcast(moved)
        self._tell_scene(self.clients)
        self.jobs.look_for_folds()

    def changed(self) -> None:
        """Tell everybody what is shown now, and keep it safe."""
        self.revision += 1
        moved = self.shown.moved_frame()
        if moved is not None:
            self.broadcast(moved)
        self._tell_scene(self.clients)
        if self.autosave is not None:
            self.autosave.keep(self.required, self.name)
        self.jobs.look_for_folds()

    def drop_drag(self) -> None:
        """Give up a drag: the shape goes back to where it was."""
        if self.dragging is not None:
            self.dragging = None
            self.show_again()

    def show_again(self) -> None:
        """Show the scene as it is known now; while somebody drags in it, when that ends."""
        if self.dragging is not None or self.stage is None:
            return
        self.stage.show(self.stage.given, self.time)
        moved = self.stage.moved_frame()
        if moved is not None:
            self.broadcast(moved)

    def broadcast(self, frame: Frame, leave_out: Client | None = None) -> None:
        """Send an event to all pages, or to all but one."""
        if not self.clients or (leave_out is not None and self.clients == [leave_out]):
            return
        data = frame.encode()
        for client in self.clients:
            if client is not leave_out:
                client.send(data)

    def tell_scene(self) -> None:
        """Tell everybody what the scene consists of."""
        self._tell_scene(self.clients)

    def submit(self, work: Callable[..., Any], *arguments: Any) -> Any:
        """Do something on the session's thread; gives its future."""
        return self.worker.submit(work, *arguments)

    def end(self) -> None:
        """Stop working; unsaved work stays where it is kept."""
        self.jobs.end()
        self.readers.shutdown(wait=True, cancel_futures=True)
        self.worker.shutdown(wait=True, cancel_futures=True)
        self._alone.close()
        if self.autosave is not None:
            self.autosave.finish()
        self.uploads.remove()

    def locked_points(self, layer: str) -> NDArray[np.uint32]:
        """The control points of a layer that nobody may move."""
        return np.array(sorted(self.locked.get(layer, ())), np.uint32)

    def may_read(self, path: Path) -> bool:
        """Whether a file that a mesh refers to may be shown: of an upload, of the studio's folder, or a sample's."""
        folders = [self.uploads.folder, self.root, samples_folder(), pictures_folder()]
        found = path.resolve()
        return any(folder is not None and found.is_relative_to(folder.resolve()) for folder in folders)

    def _tell_scene(self, clients: list[Client]) -> None:
        data = Frame({"event": "scene", "scene": scene_state(self)}).encode()
        for client in clients:
            client.send(data)
