"""From a part to a document of the kernel: compounds that are assemblies mount what they hold."""

from __future__ import annotations

from typing import Any

from pliant.cad.document import Document
from pliant.cad.kernel import kernel
from pliant.cad.labels import Label, Places, kind_of


def document_of(shape: Any, labels: tuple[Label, ...]) -> Document:
    """A document that holds a shape and what is said of it."""
    filling = _Filling(shape, labels)
    filling.put(shape)
    filling.document.shapes.UpdateAssemblies()
    return filling.document


class _Filling:
    def __init__(self, whole: Any, labels: tuple[Label, ...]) -> None:
        self.document = Document()
        places = Places(whole)
        self._said = [(shape, label) for label in labels if (shape := places.shape(label)) is not None]

    def put(self, shape: Any) -> tuple[Any, Label | None]:
        """Add a shape with all that it holds: where it is now, and what is said of it as a whole."""
        tool, label = self.document.shapes, self._of(shape)
        if label is None or not label.assembly:
            return self._put_alone(shape, label), label
        at = tool.NewShape()
        self.document.set_name(at, label.name)
        parts = kernel("TopoDS").TopoDS_Iterator(shape)
        while parts.More():
            inner, said = self.put(parts.Value())
            component = tool.AddComponent(at, inner, kernel("TopLoc").TopLoc_Location())
            if said is not None:
                self.document.set_name(component, said.instance or said.name)
            parts.Next()
        return at, label

    def _put_alone(self, shape: Any, label: Label | None) -> Any:
        at = self.document.shapes.AddShape(shape, False)
        if label is not None:
            self._say(at, label)
        inside = Places(shape)
        for part, said in self._said:
            if not part.IsSame(shape) and inside.index(said.kind, part) is not None:
                self._say(self.document.shapes.AddSubShape(at, part), said)
        return at

    def _say(self, at: Any, label: Label) -> None:
        self.document.set_name(at, label.name)
        if label.color is not None:
            self.document.set_color(at, label.color, label.kind)
        for layer in label.layers:
            self.document.set_layer(at, layer)

    def _of(self, shape: Any) -> Label | None:
        kind = kind_of(shape)
        return next((label for part, label in self._said if label.kind == kind and part.IsSame(shape)), None)
