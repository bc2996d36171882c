"""Stack: layers of deformers in order. Every edit gives another stack, so that undoing one is keeping the old."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from dataclasses import replace as exchanged
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import (
    Controls,
    Deformer,
    MeshDeformer,
    SpaceDeformer,
    Target,
    carry_corners,
    checked_controls,
)
from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.mesh import CornerValues, Points, PolygonMesh, as_points
from pliant.numerics.maps.normals import carry_normals
from pliant.scene.layer import Layer
from pliant.scene.stack_binding import StackBinding
from pliant.surface.shading import shading_normals

Mode = Literal["compose", "add"]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stack(Deformer):
    """Layers in order, the first first.

    A layer that is a map of space is evaluated where the layers below have put the points. One that edits a surface
    stays bound to the shape at rest; its displacements are turned as the layers below have turned the surface.

    Its controls are those of all its layers, flattened and put one after another: (p,).

    Parameters
    ----------
    layers
        With different names. None at all is the identity.
    mode
        ``"compose"``: each layer deforms the result of those below. ``"add"``: each deforms the shape at rest, and
        their displacements are summed.

    Raises
    ------
    InvalidParameter
        Two layers of one name, something that is no layer, an unknown mode.
    """

    layers: tuple[Layer, ...] = ()
    mode: Mode = "compose"

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        if self.mode not in ("compose", "add"):
            raise InvalidParameter(f"a stack's mode is 'compose' or 'add', not {self.mode!r}")
        for layer in self.layers:
            if not isinstance(layer, Layer):
                raise InvalidParameter(f"a stack holds layers, not a {type(layer).__name__}: wrap it in Layer(name, …)")
        for name in self.names:
            if self.names.count(name) > 1:
                raise InvalidParameter(f"two layers are called {name!r}: rename one")

    def __len__(self) -> int:
        return len(self.layers)

    def __iter__(self) -> Iterator[Layer]:
        return iter(self.layers)

    def __getitem__(self, name: str) -> Layer:
        return self.layers[self.index(name)]

    @property
    def names(self) -> tuple[str, ...]:
        """What the layers are called, in order."""
        return tuple(layer.name for layer in self.layers)

    @property
    def active(self) -> tuple[Layer, ...]:
        """The layers that do something: not muted, solo where one is, an envelope that is not zero."""
        heard = [layer for layer in self.layers if not layer.muted]
        alone = [layer for layer in heard if layer.solo]
        return tuple(layer for layer in alone or heard if layer.envelope != 0.0)

    def index(self, name: str) -> int:
        """Where a layer stands.

        Parameters
        ----------
        name
            Of the layer.

        Raises
        ------
        InvalidParameter
            There is none of that name.
        """
        if name not in self.names:
            raise InvalidParameter(f"there is no layer {name!r}; there are: {', '.join(self.names) or 'none'}")
        return self.names.index(name)

    def replace(self, name: str, **changes: Any) -> Self:
        """The stack with some fields of a layer exchanged, as in ``replace("twist", muted=True)``.

        Parameters
        ----------
        name
            Of the layer.
        changes
            Fields of :class:`Layer`.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        return self._exchanged(name, self[name].changed(**changes))

    def insert(self, index: int, layer: Layer) -> Self:
        """The stack with one more layer before the one at ``index``; negative ones count from the end.

        Parameters
        ----------
        index
            Its place, 0 being the first that deforms.
        layer
            With a name that no other has.

        Raises
        ------
        InvalidParameter
            Another layer has its name.
        """
        layers = list(self.layers)
        layers.insert(index, layer)
        return self._with(layers)

    def append(self, layer: Layer) -> Self:
        """The stack with one more layer on top.

        Parameters
        ----------
        layer
            With a name that no other has.

        Raises
        ------
        InvalidParameter
            Another layer has its name.
        """
        return self._with((*self.layers, layer))

    def move(self, name: str, index: int) -> Self:
        """The stack with a layer at another place: ``index`` among all of them, 0 being the first.

        Parameters
        ----------
        name
            Of the layer.
        index
            Among all of them; negative ones count from the end.

        Raises
        ------
        InvalidParameter
            No such layer, or no such place.
        """
        if not -len(self) <= index < len(self):
            raise InvalidParameter(f"there is no place {index} among {len(self)} layers")
        layers = list(self.layers)
        layer = layers.pop(self.index(name))
        layers.insert(index % len(self), layer)
        return self._with(layers)

    def remove(self, name: str) -> Self:
        """The stack without a layer.

        Parameters
        ----------
        name
            Of the layer.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        at = self.index(name)
        return self._with((*self.layers[:at], *self.layers[at + 1 :]))

    def rename(self, name: str, new: str) -> Self:
        """The stack with another name for a layer.

        Parameters
        ----------
        name, new
            What it is called, and will be.

        Raises
        ------
        InvalidParameter
            There is no such layer, or another has the new name.
        """
        return self._exchanged(name, self[name].changed(name=new))

    def in_mode(self, mode: Mode) -> Self:
        """The same layers, composed or added.

        Parameters
        ----------
        mode
            ``"compose"`` or ``"add"``.

        Raises
        ------
        InvalidParameter
            It is neither.
        """
        return exchanged(self, mode=mode)

    def _exchanged(self, name: str, layer: Layer) -> Self:
        at = self.index(name)
        return self._with((*self.layers[:at], layer, *self.layers[at + 1 :]))

    def _with(self, layers: Iterable[Layer]) -> Self:
        return exchanged(self, layers=tuple(layers))

    @property
    def rest(self) -> Controls:
        """(p,) all rest controls; not known without a mesh where a layer edits a surface."""
        return flat([layer.deformer.rest for layer in self.layers])

    @property
    def controls(self) -> Controls:
        """(p,) all controls."""
        return flat([layer.deformer.controls for layer in self.layers])

    def moved(self, controls: ArrayLike) -> Self:
        """The same layers with (p,) other controls."""
        shapes = [controls_shape(layer.deformer) for layer in self.layers]
        sizes = [int(np.prod(shape)) for shape in shapes]
        parts = np.split(checked_controls(controls, (sum(sizes),)), np.cumsum(sizes)[:-1])
        return self._with(
            layer.moved(part.reshape(shape)) for layer, part, shape in zip(self.layers, parts, shapes, strict=True)
        )

    def bind(self, target: Target) -> StackBinding:
        """Evaluate every layer, and keep what it depends on.

        Raises
        ------
        InvalidTarget
            A mask of another length, bare points under a layer that needs a mesh.
        """
        return StackBinding(self, target)

    def _deformed(self, target: Target) -> Points:
        return self.bind(target).result

    def jacobian(self, points: ArrayLike) -> Floats:
        """(n, 3, 3) the derivative of the map at (n, 3) points, by the chain rule.

        Raises
        ------
        NotDifferentiable
            An active layer is masked by vertices, or edits a surface: the stack is then no map of space.
        """
        here = as_points(points)
        base, product = here, np.tile(np.eye(3), (len(here), 1, 1))
        for layer in self.active:
            if not isinstance(layer.deformer, SpaceDeformer) or layer.mask is not None:
                why = "is masked by vertices" if layer.in_space else "edits a surface"
                raise NotDifferentiable(f"layer {layer.name!r} {why}: the stack is no map of space (mute it)")
            at = base if self.mode == "add" else here
            own = layer.envelope * (layer.deformer.jacobian(at) - np.eye(3))
            if self.mode == "add":
                product = product + own
            else:
                product = product + own @ product
                here = here + layer.envelope * (layer.deformer._deformed(here) - here)
        return product

    def _normals(self, mesh: PolygonMesh, points: Points) -> Points | CornerValues | None:
        """By the Jacobian where there is one, else from the faces."""
        if mesh.normals is None and "normals" not in mesh.vertex_attributes:
            return None
        try:
            jacobian = self.jacobian(mesh.points)
        except NotDifferentiable:
            return shading_normals(mesh, points)
        if mesh.normals is None:
            return carry_normals(jacobian, np.asarray(mesh.vertex_attributes["normals"], np.float64))
        return carry_corners(jacobian, mesh.normals, mesh.faces.flat)


def controls_shape(deformer: Deformer) -> tuple[int, ...]:
    """The shape of a deformer's controls, also where a surface deformer does not know where they rest."""
    if not isinstance(deformer, MeshDeformer):
        return deformer.rest.shape
    handle = np.asarray(getattr(deformer, "handle", ()))
    return (int(handle.sum()) if handle.dtype == bool else len(handle)), 3


def flat(arrays: Iterable[Controls]) -> Controls:
    """(p,) arrays one after another."""
    return np.concatenate([np.zeros(0), *(np.asarray(array, np.float64).reshape(-1) for array in arrays)])
