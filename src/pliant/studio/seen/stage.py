"""What the pages show: the stack at a moment, evaluated; the mesh as drawn; which points they have not been told of."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls
from pliant.mesh import Points
from pliant.scene.clip import intensified
from pliant.scene.scene import Scene
from pliant.scene.stack_binding import StackBinding
from pliant.studio.modes.posing import posed
from pliant.studio.seen.drawn import DrawnMesh
from pliant.studio.serving.frames import Frame

_numbers = itertools.count(1)


class Stage:
    """A scene, evaluated and drawn.

    Parameters
    ----------
    scene
        The scene; from then on as it stands at the time shown.
    time
        In seconds.

    Attributes
    ----------
    given, scene
        The scene as it was given, and as it stands at the time shown.
    """

    _on_motion = False

    def __init__(self, scene: Scene, time: float = 0.0) -> None:
        self.id = next(_numbers)
        self.given, self.scene = scene, posed(scene, time)
        self.drawn = DrawnMesh(scene.mesh)
        self.binding = self._bound(self.scene, None, time)
        self.told: Points = np.array(self.points)

    def show(self, scene: Scene, time: float = 0.0) -> None:
        """Evaluate another stack, or another time, on the same mesh."""
        shown = posed(scene, time)
        binding = self._bound(shown, self.binding, time)
        vars(self).update(given=scene, scene=shown, binding=binding)  # at once: readers copy them together

    @property
    def points(self) -> Points:
        """(n, 3) where the points are shown, read-only."""
        clip = self.scene.clip
        return self.binding.result if clip is None else intensified(self.binding, clip.intensity)

    def at(self, time: float) -> Points:
        """(n, 3) where the points are at another time, which is not shown for it."""
        clip = self.scene.clip
        if clip is None:
            return self.points
        return intensified(self.binding.updated(clip.stack_at(time), clip.base_at(time)), clip.intensity)

    def _bound(self, scene: Scene, binding: StackBinding | None, time: float) -> StackBinding:
        """The posed stack, evaluated: with what is known of the binding before, where that stood on the same ground."""
        clip = scene.clip
        base = None if clip is None else clip.base_at(time)
        if binding is None or (base is None and self._on_motion):
            binding = scene.stack.bind(scene.mesh)
        self._on_motion = base is not None
        return binding.updated(scene.stack, base)

    def controls(self, layer: str) -> Controls:
        """Where the controls of a layer are."""
        deformer = self.scene.stack[layer].deformer
        return deformer.controls if self.scene.stack[layer].in_space else self.binding.bound(layer).controls

    def mesh_frame(self) -> Frame:
        """All that a page needs to draw the mesh as it is now."""
        self.told = np.array(self.points)
        head = {
            "event": "mesh",
            "id": self.id,
            "count": len(self.told),
            "parts": self.drawn.parts,
            "materials": self.drawn.materials,
        }
        return Frame(head, self.drawn.arrays(self.told))

    def moved_frame(self) -> Frame | None:
        """The points that are elsewhere than the pages have been told, exactly; None where there are none."""
        now = self.points
        chosen = np.flatnonzero((now != self.told).any(axis=1))
        if not len(chosen):
            return None
        self.told = np.array(now)
        everything = 2 * len(chosen) > len(now)
        which = np.arange(len(now)) if everything else chosen
        arrays: dict[str, NDArray[Any]] = {
            "positions": now[which].astype(np.float32),
            "normals": self.drawn.normals(now, which),
        }
        if not everything:
            arrays["index"] = which.astype(np.uint32)
        return Frame({"event": "points", "all": everything}, arrays)
