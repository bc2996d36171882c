"""One layer of a stack, evaluated: what it was given, what it made of it, and the key of all that it depends on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.deformer import Binding, Controls, Target
from pliant.errors import InvalidControls
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.scene.cache import Cache
from pliant.scene.keys import key_of
from pliant.scene.layer import Layer, blended, column
from pliant.scene.turning import turned


@dataclass(frozen=True, eq=False)
class Step:
    """A layer that has been evaluated.

    Parameters
    ----------
    layer
        The layer.
    key
        Of all that ``points`` depend on.
    place
        Of what a binding of the layer depends on: its structure, and where it is bound.
    at
        (n, 3) what the deformer deforms: the shape at rest, or the result below.
    below, points
        (n, 3) before and after the layer; read-only.
    """

    layer: Layer
    key: bytes
    place: bytes
    at: Points
    below: Points
    points: Points


@dataclass(frozen=True, eq=False)
class Ground:
    """What a stack stands on.

    Parameters
    ----------
    target
        The shape at rest: what surface layers are bound to.
    base
        (n, 3) where its points are before the first layer.
    key
        Of both.
    moved
        Whether they differ.
    """

    target: Target
    base: Points
    key: bytes
    moved: bool

    @property
    def rest(self) -> Points:
        """(n, 3) the shape at rest."""
        return as_points(self.target)


class Evaluator:
    """Evaluates layers, and remembers what it has evaluated and bound."""

    def __init__(self, ground: Ground, cache: Cache, added: bool, exact: bool = False) -> None:
        self._ground, self._cache, self._added, self._exact = ground, cache, added, exact

    def step(self, layer: Layer, below: Points, below_key: bytes) -> Step:
        """The layer on (n, 3) points whose key is known."""
        key = key_of("step", layer.content, below_key, self._added)
        found: Step | None = self._cache.get(key)
        if found is not None:
            return found if found.layer is layer else Step(layer, key, found.place, found.at, below, found.points)
        layer.fits(len(below))
        at, at_key = self._place(layer, below, below_key)
        place = key_of("place", layer.structure, at_key)
        near = None if self._exact else self.near(layer)
        points = self._result(layer, at, place, below, below_key, near)
        points.flags.writeable = False
        if near is not None:  # what stands on it must not be taken for the answer either
            return Step(layer, key_of("near", key, near), place, at, below, points)
        step = Step(layer, key, place, at, below, points)
        self._cache.put(key, step, points.nbytes)
        return step

    def binding(self, step: Step) -> Binding:
        """The step's deformer, bound to what it deforms; bound once."""
        return self._bound(step.layer, step.at, step.place)

    def has_bound(self, layer: Layer) -> bool:
        """Whether a layer that edits the surface is bound to the shape at rest."""
        return not layer.in_space and self._cache.get(key_of("place", layer.structure, b"rest")) is not None

    def near(self, layer: Layer) -> Points | None:
        """(n, 3) what stands for the image of a layer that edits the surface, until that is computed."""
        found: Points | None = None if layer.in_space else self._cache.get(key_of("near", layer.content))
        return found

    def suppose(self, layer: Layer, image: Points | None) -> None:
        """Let (n, 3) points stand for a layer's image; None = nothing any more."""
        if image is not None:
            image = np.array(image)
            image.flags.writeable = False
        self._cache.put(key_of("near", layer.content), image, 0 if image is None else image.nbytes)

    def _place(self, layer: Layer, below: Points, below_key: bytes) -> tuple[Points, bytes]:
        if not layer.in_space:
            return self._ground.rest, b"rest"
        return (self._ground.base, self._ground.key) if self._added else (below, below_key)

    def _result(
        self, layer: Layer, at: Points, place: bytes, below: Points, below_key: bytes, near: Points | None
    ) -> Points:
        if at is below:
            image = self._image(layer, at, place) if near is None else near.copy()
            return blended(below, image, layer.strength)
        key = key_of("displacement", layer.content, place)
        displacement = self._cache.get(key) if near is None else column(layer.strength) * (near - at)
        if displacement is None:
            displacement = self._image(layer, at, place)
            displacement -= at
            displacement *= column(layer.strength)
            self._cache.put(key, displacement, displacement.nbytes)
        if self._added or below_key == b"rest" or not isinstance(self._ground.target, PolygonMesh):
            return np.asarray(below + displacement)
        return carried(self._ground.target, below, displacement)

    def _image(self, layer: Layer, at: Points, place: bytes) -> Points:
        """The deformer's image, the caller's own; bound where it has been asked for at this place before."""
        if layer.in_space and self._cache.get(place) is None and self._first_time(place):
            image = layer.deformer._deformed(at)
            return image.copy() if image is at or not image.flags.writeable else image
        binding = self._bound(layer, at, place)
        return binding.deform(controls_of(layer, binding))

    def _first_time(self, place: bytes) -> bool:
        seen = key_of("seen", place)
        known = self._cache.get(seen) is not None
        self._cache.put(seen, True)
        return not known

    def _bound(self, layer: Layer, at: Points, place: bytes) -> Binding:
        found: Binding | None = self._cache.get(place)
        if found is None:
            found = layer.deformer.bind(at if layer.in_space else self._ground.target)
            self._cache.put(place, found, 4 * at.nbytes)
        return found


def controls_of(layer: Layer, binding: Binding) -> Controls:
    """Where the controls of a layer are; at rest where only the binding knows."""
    try:
        return layer.deformer.controls
    except InvalidControls:
        return binding.rest


def carried(mesh: PolygonMesh, below: Points, displacement: Points) -> Points:
    """Points moved by displacements of the shape at rest, which turn as the surface has turned."""
    vertices = np.flatnonzero(displacement.any(axis=1))
    points = below.copy()
    points[vertices] += np.einsum("nij,nj->ni", turned(mesh, below, vertices), displacement[vertices])
    return points
