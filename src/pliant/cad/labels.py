"""What a CAD file says of shapes beside their geometry: names, colours, layers, and which compounds are assemblies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from pliant.cad.kernel import kernel, parts_of


@dataclass(frozen=True)
class Label:
    """What is said of one shape within a part.

    Parameters
    ----------
    kind
        Of the shape: ``"compound"``, ``"solid"``, ``"shell"``, ``"face"``, ``"edge"``...
    index
        Which of its kind it is in the whole part. A deformation keeps the order.
    name
        What it, or the product that it is one of, is called.
    instance
        What it is called where it is mounted.
    color
        (4,) red, green, blue, alpha, 0 to 1 in linear light; None = not said.
    layers
        The names of layers that it lies on.
    assembly
        Whether what the compound holds are parts mounted into it.
    """

    kind: str
    index: int
    name: str = ""
    instance: str = ""
    color: tuple[float, ...] | None = None
    layers: tuple[str, ...] = ()
    assembly: bool = False

    def __bool__(self) -> bool:
        return bool(self.name or self.instance or self.color or self.layers or self.assembly)


def plain(labels: Iterable[Label]) -> list[dict[str, Any]]:
    """Labels as JSON holds them."""
    return [asdict(label) for label in labels]


def labels_of(data: list[dict[str, Any]]) -> tuple[Label, ...]:
    """Labels from what JSON held."""
    return tuple(
        Label(**{**each, "color": each["color"] and tuple(each["color"]), "layers": tuple(each["layers"])})
        for each in data
    )


class Places:
    """Where shapes stand among those of their kind in a whole, and back.

    Parameters
    ----------
    whole
        A shape.
    """

    def __init__(self, whole: Any) -> None:
        self._whole = whole
        self._shapes: dict[str, list[Any]] = {}
        self._indices: dict[str, dict[int, list[int]]] = {}

    def index(self, kind: str, shape: Any) -> int | None:
        """Which of its kind a shape is; None where it is not in the whole."""
        shapes = self._all(kind)
        if kind not in self._indices:
            by_hash: dict[int, list[int]] = {}
            for i, each in enumerate(shapes):
                by_hash.setdefault(hash(each), []).append(i)
            self._indices[kind] = by_hash
        return next((i for i in self._indices[kind].get(hash(shape), ()) if shapes[i].IsSame(shape)), None)

    def shape(self, label: Label) -> Any | None:
        """The shape that a label is of; None where there is none."""
        found = self._all(label.kind)
        return found[label.index] if 0 <= label.index < len(found) else None

    def _all(self, kind: str) -> list[Any]:
        if kind not in self._shapes:
            self._shapes[kind] = _compounds(self._whole) if kind == "compound" else parts_of(self._whole, kind)
        return self._shapes[kind]


def _compounds(shape: Any) -> list[Any]:
    """A shape and what is in it, as far as they are compounds."""
    if kind_of(shape) != "compound":
        return []
    found, inside = [shape], kernel("TopoDS").TopoDS_Iterator(shape)
    while inside.More():
        found += _compounds(inside.Value())
        inside.Next()
    return found


def kind_of(shape: Any) -> str:
    """What kind of shape it is, as :func:`pliant.cad.kernel.parts_of` calls it."""
    name: str = shape.ShapeType().name
    return name.removeprefix("TopAbs_").lower()
