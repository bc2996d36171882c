"""Stack: layers of deformers in order, as one deformer."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import replace as exchanged
from math import prod
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Deformer, SpaceDeformer, Target, carry_corners, checked_controls
from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.mesh import CornerValues, Points, PolygonMesh, as_points
from pliant.numerics.maps.normals import carry_normals
from pliant.scene.layer_controls import controls_shape, flat, parts
from pliant.scene.layers import Layers
from pliant.scene.stack_binding import StackBinding
from pliant.surface.shading import shading_normals

Mode = Literal["compose", "add"]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stack(Layers, Deformer):
    """Layers in order, the first first. Every edit gives another stack.

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

    mode: Mode = "compose"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.mode not in ("compose", "add"):
            raise InvalidParameter(f"a stack's mode is 'compose' or 'add', not {self.mode!r}")

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
        given = parts(checked_controls(controls, (sum(map(prod, shapes)),)), shapes)
        return self._with(layer.moved(part) for layer, part in zip(self.layers, given, strict=True))

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
