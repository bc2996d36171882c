"""Shape models as layers: found, built on the shape from a kernel, fitted to a target with all that this moves."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.basis import Floats
from pliant.shape.conditioned_model import ConditionedModel
from pliant.shape.kernel_text import parse_kernel
from pliant.shape.model import ShapeModel
from pliant.space.affine import Affine
from pliant.studio.seen.spaces import space_map

NAME, POSE = "Shape model", "Pose"
MOST_NUMBERS = 64_000_000  # of the fields of a model that is built here: half a gigabyte
MOST_FIELDS = 1000


def model_layer(stack: Stack, name: str) -> ConditionedModel:
    """The shape model of a layer.

    Raises
    ------
    InvalidParameter
        There is no such layer, or it holds something else.
    """
    deformer = stack[name].deformer
    if not isinstance(deformer, ConditionedModel):
        raise InvalidParameter(f"layer {name!r} is no shape model: open one, or build one from a kernel")
    return deformer


def layers_above(stack: Stack, name: str) -> SpaceDeformer:
    """What the layers above a model do to space: from where it puts landmarks to where they are seen.

    Raises
    ------
    NotDifferentiable
        One of them edits the surface.
    """
    heard = stack.active
    return space_map(Stack(tuple(layer for layer in stack.layers[stack.index(name) + 1 :] if layer in heard)))


def model_scene(model: ShapeModel) -> Scene:
    """The scene of a model: its reference, and the model at its mean."""
    shown = replace(model, reference=bare(model.reference))
    return Scene(model.reference, Stack((Layer(NAME, ConditionedModel(shown)),)))


def built(mesh: PolygonMesh, kernel: str, rank: int, method: Literal["cholesky", "nystrom"]) -> ConditionedModel:
    """A model around a mesh, from a kernel as text.

    Raises
    ------
    InvalidParameter
        A text that is no kernel, or more fields than there is room for.
    """
    count = len(mesh.points)
    most = min(MOST_FIELDS, MOST_NUMBERS // max(count, 1))
    if not 1 <= rank <= most:
        raise InvalidParameter(f"a model of {count:,} points has 1 to {most} fields here; asked for {rank}")
    return ConditionedModel(ShapeModel.from_kernel(bare(mesh), parse_kernel(kernel), rank=rank, method=method))


def bare(mesh: PolygonMesh) -> PolygonMesh:
    """Points and faces alone: what a model needs of its reference."""
    return PolygonMesh(mesh.points, mesh.faces, lines=mesh.lines)


def fitted_stack(stack: Stack, name: str, coefficients: Floats, pose: Floats) -> Stack:
    """The stack whose model has coefficients, without landmarks, and is moved by a (4, 4) pose.

    The pose is a layer of its own, right above the model's.
    """
    model = model_layer(stack, name).model
    found = stack.replace(name, deformer=ConditionedModel(model, coefficients, noise=model_layer(stack, name).noise))
    above = f"{POSE} of {name}"
    if above in stack.names:
        return found.replace(above, deformer=Affine(pose))
    if np.array_equal(pose, np.eye(4)):
        return found
    return found.insert(found.index(name) + 1, Layer(above, Affine(pose)))


def prior_coefficients(shape: ConditionedModel, given: Floats) -> Floats:
    """(k,) the model's own coefficients of a shape that is told by those of what landmarks leave open."""
    if not len(np.asarray(shape.vertices)):
        return given
    return shape.model.coefficients(shape.posterior().instance(given))
