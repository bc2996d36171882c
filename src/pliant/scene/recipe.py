"""Recipes: deformations and motions as text that people read and write, which fit any mesh.

A recipe is TOML: tables ``[[layer]]``, each of a kind of deformer and its fields, and tables ``[[key]]``, values at
times. Angles are degrees. With ``around`` a layer is laid around the mesh that the recipe is applied to, and lengths
and places may be given as parts of that mesh, such as ``"30 %"``. With ``box``, the corners of the box that all numbers
were made for, layers are fitted to the box of the mesh.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidDeformer, InvalidParameter, UnreadableFile
from pliant.io.files import read_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip
from pliant.scene.easing import Easing
from pliant.scene.fitting import Fit
from pliant.scene.recipe_layers import keyed_values, layer_around
from pliant.scene.recipe_values import Box
from pliant.scene.stack import Stack
from pliant.space.affine import Affine
from pliant.space.placed import place

VERSION = 2
_UPRIGHT = Affine.rotation("x", -np.pi / 2)  # from z up to y up
_LARGEST = 1e300
_HEAD = ("pliant", "title", "about", "box", "mode", "duration", "fps", "ending", "layer", "key")


@dataclass(frozen=True, eq=False)
class Recipe:
    """A stack, and how it moves, before it meets a mesh.

    Parameters
    ----------
    document
        The recipe as plain data: what its TOML says.
    name
        What errors call it.

    Raises
    ------
    InvalidParameter
        A version that is not known, no layers, or an entry that recipes do not have.
    """

    document: Mapping[str, Any]
    name: str = "recipe"
    layers: tuple[Mapping[str, Any], ...] = field(init=False)
    keys: tuple[Mapping[str, Any], ...] = field(init=False)

    def __post_init__(self) -> None:
        version = self.document.get("pliant", VERSION)
        if not isinstance(version, int) or version < 1:
            raise InvalidParameter(f"{self.name}: its version is {version!r}, which no recipe has")
        if version > VERSION:
            raise InvalidParameter(
                f"{self.name}: it is of version {version}; this pliant reads up to {VERSION}: update"
            )
        for entry in self.document:
            if entry not in _HEAD:
                raise InvalidParameter(f"{self.name}: recipes have no {entry!r}; they have: {', '.join(_HEAD)}")
        for entry in ("duration", "fps"):
            if not _is_number(self.document.get(entry, 1)):
                raise InvalidParameter(f"{self.name}: its {entry} is {self.document[entry]!r}; a number is needed")
        object.__setattr__(self, "layers", self._tables("layer"))
        object.__setattr__(self, "keys", self._tables("key"))
        if not self.layers:
            raise InvalidParameter(f"{self.name}: it has no [[layer]]: there is nothing to do")

    @property
    def title(self) -> str:
        """What people call it."""
        return str(self.document.get("title", self.name))

    @property
    def about(self) -> str:
        """What it does, in a sentence."""
        return str(self.document.get("about", ""))

    @property
    def moves(self) -> bool:
        """Whether it has keys."""
        return bool(self.keys)

    def stack(self, mesh: PolygonMesh, *, intensity: float = 1.0, up: str = "z") -> Stack:
        """The stack, laid around a mesh.

        Parameters
        ----------
        mesh
            The mesh.
        intensity
            How far the deformation goes: 0 = not at all, 1 = as the recipe says; factors are taken to this power.
        up
            The axis that points up in the mesh, ``"z"`` or ``"y"``; recipes are written for z.

        Raises
        ------
        InvalidParameter
            A layer that is not understood; recipe and layer are named.
        """
        if up not in ("y", "z") or not np.isfinite(intensity):
            raise InvalidParameter(f"up is 'y' or 'z', and the intensity finite; given: {up!r} and {intensity}")
        upright = mesh if up == "z" else _UPRIGHT.inverted()(mesh)
        try:
            fit = self._fit(upright)
            layers = [layer_around(data, upright, float(intensity), fit) for data in self.layers]
            if up == "y":
                layers = [layer.changed(deformer=_turned(layer.deformer)) for layer in layers]
            return Stack(tuple(layers), self.document.get("mode", "compose"))
        except (InvalidParameter, InvalidDeformer) as error:
            raise InvalidParameter(f"{self.name}: {error}") from error

    def clip(
        self,
        mesh: PolygonMesh,
        *,
        intensity: float = 1.0,
        duration: float | None = None,
        fps: float | None = None,
        up: str = "z",
    ) -> Clip:
        """The clip, laid around a mesh.

        Parameters
        ----------
        mesh, intensity, up
            As for :meth:`stack`.
        duration
            Seconds; the keys are stretched to fit. None = as the recipe says.
        fps
            Frames a second; None = as the recipe says.

        Raises
        ------
        InvalidParameter
            A layer or a key that is not understood.
        """
        last = max((key["time"] for key in self.keys if _is_number(key.get("time"))), default=1.0)
        own = float(self.document.get("duration", last or 1))
        wanted = own if duration is None else float(duration)
        upright = mesh if up == "z" else _UPRIGHT.inverted()(mesh)
        stack = self.stack(upright, intensity=intensity)
        rate = float(self.document.get("fps", 24.0) if fps is None else fps)
        clip = Clip(upright, stack, wanted, rate, ending=self.document.get("ending", "once"))
        for layer, time, values, easing in self._keyed(stack, upright, float(intensity)):
            clip = clip.key(layer, time * wanted / own, values, easing)
        return clip if up == "z" else clip.on(mesh, self.stack(mesh, intensity=intensity, up=up))

    def _keyed(
        self, stack: Stack, mesh: PolygonMesh, intensity: float
    ) -> Iterator[tuple[str, float, dict[str, Any], Easing]]:
        fit = self._fit(mesh)
        around = {data["name"] for data in self.layers if "around" in data}
        for place_, data in enumerate(self.keys):
            layer, time = data.get("layer"), data.get("time")
            if not isinstance(layer, str) or not _is_number(time):
                raise InvalidParameter(f"{self.name}: key {place_} needs a layer, a word, and a time, a number")
            try:
                yield (
                    layer,
                    float(data["time"]),
                    keyed_values(data, stack[layer], mesh, intensity, None if layer in around else fit),
                    data.get("easing", "linear"),
                )
            except InvalidParameter as error:
                raise InvalidParameter(f"{self.name}: {error}") from error

    def _fit(self, mesh: PolygonMesh) -> Fit | None:
        """From the box that the recipe's numbers were made for to that of a mesh; None where it names no box."""
        if "box" not in self.document:
            return None
        try:
            low, high = np.array(self.document["box"], np.float64).reshape(2, 3)
        except (TypeError, ValueError, OverflowError) as error:
            raise InvalidParameter(f"{self.name}: its box is no [[x, y, z], [x, y, z]], low corner and high") from error
        if not np.isfinite([low, high]).all() or (high < low).any():
            raise InvalidParameter(f"{self.name}: its box from {low.tolist()} to {high.tolist()} is none")
        return Fit(Box(low, high), Box.of(mesh))

    def _tables(self, name: str) -> tuple[Mapping[str, Any], ...]:
        tables = self.document.get(name, [])
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise InvalidParameter(f"{self.name}: {name!r} must be tables: write [[{name}]]")
        return tuple(tables)


def read_recipe(path: Path | str) -> Recipe:
    """The recipe in a TOML file.

    Parameters
    ----------
    path
        The file; the page on scenes says what may stand in it.

    Raises
    ------
    UnreadableFile
        It is not there, is no TOML, or no recipe.
    """
    data = read_bytes(path)
    try:
        return Recipe(tomllib.loads(data.decode()), Path(path).stem)
    except UnicodeDecodeError as error:
        raise UnreadableFile(path, "it is no UTF-8 text", "check what it is", byte=error.start) from error
    except tomllib.TOMLDecodeError as error:
        raise UnreadableFile(path, f"it is no TOML: {error}", "correct the place named") from error
    except RecursionError as error:
        raise UnreadableFile(path, "it is nested too deeply to be a recipe") from error
    except InvalidParameter as error:
        raise UnreadableFile(path, str(error)) from error


def _is_number(value: Any) -> bool:
    """Whether it is a number that a computer can hold: TOML's may be of any length."""
    return isinstance(value, int | float) and abs(value) < _LARGEST


def _turned(deformer: Any) -> SpaceDeformer:
    """A deformer made for z up, for a mesh with y up."""
    if not isinstance(deformer, SpaceDeformer):
        raise InvalidParameter("a recipe that edits a surface knows its mesh: leave out up")
    return place(deformer, _UPRIGHT)
