"""Changes of a stack that pages ask for: names that are free, fields of a deformer."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter, PliantError
from pliant.scene.kinds import kind_of
from pliant.scene.layer import Layer
from pliant.scene.stack import Stack
from pliant.space.placed import Placed


def free_name(name: str, taken: Iterable[str]) -> str:
    """The name, or with the first number that makes it another than those taken."""
    known = set(taken)
    number = 2
    found = name
    while found in known:
        found, number = f"{name} {number}", number + 1
    return found


def with_layer(stack: Stack, name: str, deformer: Deformer) -> tuple[Stack, str]:
    """The stack with one more layer on top, and what that is called."""
    found = free_name(name, stack.names)
    return stack.append(Layer(found, deformer)), found


def with_fields(deformer: Deformer, fields: Mapping[str, Any]) -> Deformer:
    """A deformer with some of its fields exchanged; of one that is placed, the fields of the tool.

    Raises
    ------
    InvalidParameter
        A field that it has not, or a value that it does not take.
    """
    if isinstance(deformer, Placed):
        tool = with_fields(deformer.deformer, fields)
        assert isinstance(tool, SpaceDeformer)
        return Placed(tool, deformer.frame)
    known = {field.name: field for field in kind_of(deformer).fields}
    for name in fields:
        if name not in known:
            raise InvalidParameter(f"there is no field {name!r}; there are: {', '.join(known)}")
    values = {name: tuple(value) if isinstance(value, list) else value for name, value in fields.items()}
    try:
        changed: Deformer = dataclasses.replace(deformer, **values)  # type: ignore[type-var]
    except PliantError:
        raise
    except (TypeError, ValueError, ArithmeticError) as error:
        raise InvalidParameter(f"{', '.join(fields)} cannot be set: {error}") from error
    return changed
