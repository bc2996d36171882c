"""From a document of the kernel to one shape and its labels: assemblies become compounds, each part where it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from pliant.cad.document import Document, each, labels
from pliant.cad.kernel import kernel, settled
from pliant.cad.labels import Label, Places, kind_of

_UNKEPT = {  # tool and method that list what a deformed part has no place for
    "dimensions and tolerances": ("DimTolTool_s", "GetDimensionLabels"),
    "geometric tolerances": ("DimTolTool_s", "GetGeomToleranceLabels"),
    "data of dimensions": ("DimTolTool_s", "GetDatumLabels"),
    "materials": ("MaterialTool_s", "GetMaterialLabels"),
    "views": ("ViewTool_s", "GetViewLabels"),
    "notes": ("NotesTool_s", "GetNotes"),
    "visual materials": ("VisMaterialTool_s", "GetMaterials"),
}


@dataclass
class _Walk:
    """What has been found of a document so far; labels have no index yet."""

    document: Document
    said: list[tuple[Any, Label]] = field(default_factory=list)
    seen: list[Any] = field(default_factory=list)
    repeated: int = 0

    def shape(self, at: Any, place: Any, inherited: tuple[float, ...] | None = None) -> Any:
        """The shape of a label where it is, and all that it holds."""
        document, tool = self.document, self.document.shapes
        product = kernel("TDF").TDF_Label()
        if not tool.GetReferredShape_s(at, product):
            product = at
        color = document.color(at) or (document.color(product) if product is not at else None) or inherited
        instance = document.name(at) if product is not at else ""
        own = Label("", 0, document.name(product), instance, None, document.layers_of(product))
        if tool.IsAssembly_s(product):
            made, parts = _compound(), labels()
            tool.GetComponents_s(product, parts)
            for part in each(parts):
                kernel("BRep").BRep_Builder().Add(
                    made, self.shape(part, place.Multiplied(tool.GetLocation_s(part)), color)
                )
            self.said.append((made, replace(own, assembly=True)))
            return made
        self.repeated += any(product.IsEqual(other) for other in self.seen)
        self.seen.append(product)
        made = tool.GetShape_s(product).Moved(place)
        self.said.append((made, replace(own, color=color)))
        within = labels()
        tool.GetSubShapes_s(product, within)
        for part in each(within):
            said = Label("", 0, document.name(part), "", document.color(part), document.layers_of(part))
            if said:
                self.said.append((tool.GetShape_s(part).Moved(place), said))
        return made


def contents(document: Document) -> tuple[Any, tuple[Label, ...], tuple[str, ...]]:
    """The shape of a document, what is said of it, and what is not kept.

    Returns
    -------
    tuple
        A shape, of which each part is where it is without being told; its labels; one sentence a loss. No shape: None.
    """
    walk, roots = _Walk(document), labels()
    document.shapes.GetFreeShapes(roots)
    nowhere = kernel("TopLoc").TopLoc_Location()
    found = [walk.shape(root, nowhere.Multiplied(document.shapes.GetLocation_s(root))) for root in each(roots)]
    if not found:
        return None, (), ()
    whole = found[0]
    if len(found) > 1:
        whole = _compound()
        for shape in found:
            kernel("BRep").BRep_Builder().Add(whole, shape)
        walk.said.append((whole, Label("", 0, assembly=True)))
    places = Places(whole)
    placed = []
    for shape, label in walk.said:
        kind = kind_of(shape)
        index = places.index(kind, shape)
        if label and index is not None:
            placed.append(replace(label, kind=kind, index=index))
    return settled(whole), tuple(placed), tuple(_unkept(walk))


def _unkept(walk: _Walk) -> list[str]:
    found = []
    for what, (tool, method) in _UNKEPT.items():
        count = walk.document.count(tool, method)
        if count:
            found.append(f"{count:,} {what}")
    if walk.repeated:
        found.append(f"that {walk.repeated:,} parts are others again, mounted elsewhere: each has a shape of its own")
    return found


def _compound() -> Any:
    made = kernel("TopoDS").TopoDS_Compound()
    kernel("BRep").BRep_Builder().MakeCompound(made)
    return made
