"""What is done to each mesh of a run: a stack with its controls, or a recipe that is laid around each mesh."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from uuid import uuid4

import numpy as np

from pliant.deformer import Controls, Deformer
from pliant.errors import InvalidControls, InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.keys import key_of
from pliant.scene.layer import Layer
from pliant.scene.layer_data import stack_data
from pliant.scene.recipe import Recipe
from pliant.scene.stack import Stack


class Plan(ABC):
    """Knows the stack for each mesh of a run."""

    @abstractmethod
    def stack(self, mesh: PolygonMesh, controls: Controls | None) -> Stack:
        """What deforms a mesh, with controls of the job's own or the plan's."""

    @property
    @abstractmethod
    def key(self) -> bytes:
        """Of what it does: equal in every process, and never equal where that cannot be known."""


@dataclass(frozen=True, eq=False)
class StackPlan(Plan):
    """One stack for all meshes.

    Parameters
    ----------
    layers
        The stack.
    """

    layers: Stack

    def stack(self, mesh: PolygonMesh, controls: Controls | None) -> Stack:
        return self.layers if controls is None else self.layers.moved(np.reshape(controls, -1))

    @property
    def key(self) -> bytes:
        try:
            stack_data(self.layers, {})
        except InvalidParameter:  # it holds a function, which only this process knows
            return uuid4().bytes
        return key_of(self.layers.mode, *((layer.content, layer.muted, layer.solo) for layer in self.layers))


@dataclass(frozen=True, eq=False)
class RecipePlan(Plan):
    """A recipe for all meshes.

    Parameters
    ----------
    recipe
        The recipe.
    intensity, up
        As for :meth:`pliant.scene.recipe.Recipe.stack`.
    """

    recipe: Recipe
    intensity: float = 1.0
    up: str = "z"

    def stack(self, mesh: PolygonMesh, controls: Controls | None) -> Stack:
        stack = self.recipe.stack(mesh, intensity=self.intensity, up=self.up)
        return stack if controls is None else stack.moved(np.reshape(controls, -1))

    @property
    def key(self) -> bytes:
        return key_of(dict(self.recipe.document), self.intensity, self.up)


def plan_of(deformation: Deformer | Recipe, intensity: float = 1.0, up: str = "z") -> Plan:
    """The plan that a deformer, a stack or a recipe stands for.

    Raises
    ------
    InvalidParameter
        It is none of them.
    """
    if isinstance(deformation, Recipe):
        return RecipePlan(deformation, intensity, up)
    if isinstance(deformation, Stack):
        return StackPlan(deformation)
    if isinstance(deformation, Deformer):
        return StackPlan(Stack((Layer("deformation", deformation),)))
    raise InvalidParameter(
        f"a batch applies a deformer, a stack or a recipe, not a {type(deformation).__name__} (read a recipe by "
        "read_recipe)"
    )


def checked_job_controls(controls: object) -> Controls:
    """Controls of one job as a finite array.

    Raises
    ------
    InvalidControls
        They are not finite numbers.
    """
    try:
        array = np.array(controls, np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidControls(f"the controls of a job are no array of numbers: {error}") from error
    if not np.isfinite(array).all():
        raise InvalidControls("the controls of a job must be finite")
    return array
