"""The kinds of deformers: one registry, from which options, forms, recipes and files are made.

It is found by looking at the classes: a deformer that is new in its one file stands in it.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter, PliantError
from pliant.mesh import PolygonMesh
from pliant.scene.fields import Field, arguments_of, fields_of, plain
from pliant.scene.rooms import deformer_classes, known_as
from pliant.scene.values import Arrays, encode_fields, make

MOST_CONTROLS = 1_000_000  # of what is laid by a description: one that asks for more asks for the whole machine
_COUNTS = {"shape", "patches"}


class Description(NamedTuple):
    """A deformer as plain data: what :func:`build` takes.

    Parameters
    ----------
    kind
        The name of its kind.
    fields
        What JSON holds, by name; ``{"array": name}`` stands for an array put aside.
    arrays
        Those arrays.
    """

    kind: str
    fields: dict[str, Any]
    arrays: Arrays


@dataclass(frozen=True)
class Kind:
    """A kind of deformer.

    Parameters
    ----------
    name
        As in ``"bspline-ffd"``.
    cls
        Its class.
    """

    name: str
    cls: type[Deformer]

    @property
    def summary(self) -> str:
        """What it does, in a line."""
        return plain((inspect.getdoc(self.cls) or "").partition("\n")[0])

    @property
    def space(self) -> bool:
        """Whether it is a map of space; else it needs a mesh, or as many points as it was made for."""
        return issubclass(self.cls, SpaceDeformer)

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        """What it is made of; the numbers that move it first."""
        return fields_of(self.cls)

    @cached_property
    def makers(self) -> dict[str, tuple[Field, ...]]:
        """The ways to lay it around a shape, such as ``around``, and what each can be told."""
        found = {}
        for name, maker in inspect.getmembers(self.cls, inspect.ismethod):
            if not name.startswith("_") and next(iter(inspect.signature(maker).parameters), "") == "target":
                found[name] = arguments_of(maker, self.cls)
        return found

    def around(self, target: PolygonMesh, fields: Mapping[str, Any] | None = None, maker: str = "around") -> Deformer:
        """One at rest around a shape.

        Parameters
        ----------
        target
            The shape.
        fields
            What to tell the maker, as values.
        maker
            One of :attr:`makers`.

        Raises
        ------
        InvalidParameter
            No such maker, or something that it cannot be told.
        """
        if maker not in self.makers:
            ways = ", ".join(self.makers) or "none: it is made from its fields"
            raise InvalidParameter(f"a {self.name} is not made by {maker!r}; ways to lay one around a shape: {ways}")
        known, given = [field.name for field in self.makers[maker]], dict(fields or {})
        for name in given:
            if name not in known:
                raise InvalidParameter(f"{maker} of a {self.name} knows no {name!r}; it knows: {', '.join(known)}")
        try:
            for name in _COUNTS & set(given):
                if np.prod(np.asarray(given[name], np.float64)) > MOST_CONTROLS:
                    raise InvalidParameter(f"a {self.name} of {given[name]} has more than {MOST_CONTROLS:,} controls")
            laid: Deformer = getattr(self.cls, maker)(target, **given)
        except PliantError:
            raise
        except (TypeError, ValueError, LookupError) as error:
            raise InvalidParameter(f"no {self.name} can be laid with {given}: {error}") from error
        return laid


def all_kinds() -> dict[str, Kind]:
    """Every kind of deformer that there is, by name: pliant's, and those that the running program has defined."""
    return {name: Kind(name, cls) for name, cls in deformer_classes().items()}


def kind_of(deformer: Deformer) -> Kind:
    """The kind of a deformer.

    Raises
    ------
    InvalidParameter
        It is a private one, or one that is no record of its fields.
    """
    name = known_as(type(deformer))
    if name is None:
        raise InvalidParameter(
            f"a {type(deformer).__name__} is no kind of deformer that data can describe: make it a frozen dataclass"
        )
    return Kind(name, type(deformer))


def describe(deformer: Deformer) -> Description:
    """A deformer as plain data: its kind, its fields, and large arrays aside.

    Raises
    ------
    InvalidParameter
        Something in it is a function, which no data can hold.
    """
    arrays: Arrays = {}
    kind = kind_of(deformer)
    return Description(kind.name, encode_fields(deformer, arrays, ""), arrays)


def build(kind: str, fields: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]] | None = None) -> Deformer:
    """The deformer that :func:`describe` described.

    Raises
    ------
    InvalidParameter
        An unknown kind or field, an array that is missing.
    InvalidDeformer
        Values that the deformer refuses.
    """
    known = deformer_classes()
    if kind not in known:
        raise InvalidParameter(f"there is no kind of deformer {kind!r}; there are: {', '.join(known)}")
    built: Deformer = make(known[kind], fields, arrays or {})
    return built
