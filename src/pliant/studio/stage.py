"""What the pages show: the evaluated stack, the mesh as it is drawn, and which points they have not been told of."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls
from pliant.mesh import Points
from pliant.scene.scene import Scene
from pliant.scene.stack_binding import StackBinding
from pliant.studio.drawn import DrawnMesh
from pliant.studio.frames import Frame

_numbers = itertools.count(1)


class Stage:
    """A scene, evaluated and drawn.

    Parameters
    ----------
    scene
        The scene.
    """

    def __init__(self, scene: Scene) -> None:
        self.id = next(_numbers)
        self.scene = scene
        self.drawn = DrawnMesh(scene.mesh)
        self.binding: StackBinding = scene.stack.bind(scene.mesh)
        self.told: Points = np.array(self.binding.result)

    def show(self, scene: Scene) -> None:
        """Evaluate another stack on the same mesh."""
        self.binding = self.binding.updated(scene.stack)
        self.scene = scene

    def controls(self, layer: str) -> Controls:
        """Where the controls of a layer are."""
        deformer = self.scene.stack[layer].deformer
        return deformer.controls if self.scene.stack[layer].in_space else self.binding.bound(layer).controls

    def mesh_frame(self) -> Frame:
        """All that a page needs to draw the mesh as it is now."""
        self.told = np.array(self.binding.result)
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
        now = self.binding.result
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
