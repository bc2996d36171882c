"""The model of a 3MF package (3MF Core Specification 1.3): objects, what they are made of, and where they are built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats.format import Source

Matrix = NDArray[np.float64]
_MOST = 50_000_000  # vertices; components may repeat an object without end


@dataclass(eq=False)
class Item:
    """An object: vertices and triangles of its own, or other objects, each with its (4, 3) matrix for row vectors."""

    name: str
    material: tuple[str, int]
    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)
    painted: list[tuple[str, int]] = field(default_factory=list)
    parts: list[tuple[str, Matrix]] = field(default_factory=list)


@dataclass(eq=False)
class Model:
    """What a model says; ``materials`` are names and RGB of each group."""

    items: dict[str, Item] = field(default_factory=dict)
    built: list[tuple[str, Matrix]] = field(default_factory=list)
    materials: dict[str, list[tuple[str, tuple[float, float, float]]]] = field(default_factory=dict)
    others: dict[str, None] = field(default_factory=dict)

    def placed(self, source: Source) -> Iterator[tuple[Item, Matrix]]:
        """Each object with vertices where it is built.

        Raises
        ------
        UnreadableFile
            An object that is not there, that is a part of itself, or that is repeated beyond reason.
        """
        waiting: list[tuple[str, Matrix, tuple[str, ...]]] = [
            (name, matrix, (name,)) for name, matrix in reversed(self.built)
        ]
        total = 0
        while waiting:
            name, matrix, above = waiting.pop()
            if name not in self.items:
                raise source.unreadable(f"object {name!r} is built and not there", "export the file again")
            item = self.items[name]
            total += len(item.vertices) + 1
            if total > _MOST or len(waiting) > _MOST or len(above) > 64:
                raise source.unreadable("components repeat each other without end", "export the file again")
            if item.vertices:
                yield item, matrix
            for part, local in reversed(item.parts):
                waiting.append(
                    (part, np.vstack([local[:3] @ matrix[:3], local[3] @ matrix[:3] + matrix[3]]), (*above, part))
                )


def parsed(source: Source, text: bytes) -> Model:
    """What the XML of a model says.

    Raises
    ------
    UnreadableFile
        No XML, entities of its own, or values that are no numbers.
    UnsupportedFormat
        Parts in other files.
    """
    model = Model()
    current = [Item("", ("", 0))]
    group: list[Any] = []

    def begin(tag: str, said: dict[str, str]) -> None:
        word, item = tag.rpartition(":")[2], current[0]
        if word == "vertex":
            item.vertices.append((float(said["x"]), float(said["y"]), float(said["z"])))
        elif word == "triangle":
            item.triangles.append((int(said["v1"]), int(said["v2"]), int(said["v3"])))
            item.painted.append((said.get("pid", item.material[0]), int(said.get("p1", item.material[1]))))
        elif word == "object":
            current[0] = Item(said.get("name", ""), (said.get("pid", ""), int(said.get("pindex", 0))))
            model.items[said["id"]] = current[0]
        elif word in ("component", "item"):
            if any(name.endswith(":path") for name in said):
                raise UnsupportedFormat(f"{source.name}: 3MF whose parts are in other files; export it as one model")
            (item.parts if word == "component" else model.built).append((said["objectid"], _matrix(said)))
        elif word == "basematerials":
            group[:] = [model.materials.setdefault(said["id"], [])]
        elif word == "base" and group:
            group[0].append((said["name"], _color(said["displaycolor"])))
        elif word in (
            "colorgroup",
            "texture2d",
            "texture2dgroup",
            "multiproperties",
            "compositematerials",
            "beamlattice",
        ):
            model.others[f"3MF's {word}"] = None

    def refuse(*_: Any) -> None:
        raise ValueError("the XML declares entities of its own")

    parser = expat.ParserCreate()
    parser.StartElementHandler = begin
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError, KeyError, IndexError) as error:
        cause = f"the model, line {parser.CurrentLineNumber}: {type(error).__name__}: {error}"
        raise source.unreadable(cause[:200], "export the file again") from error
    return model


def _matrix(said: dict[str, str]) -> Matrix:
    values = np.array(said.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split(), np.float64)
    if values.shape != (12,) or not np.isfinite(values).all():
        raise ValueError("a transform needs twelve finite numbers")
    return values.reshape(4, 3)


def _color(word: str) -> tuple[float, float, float]:
    red, green, blue = (int(word[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return red, green, blue
