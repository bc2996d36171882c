"""A document of the kernel: shapes, and what is said of them."""

from __future__ import annotations

from typing import Any

from pliant.cad.kernel import kernel


class Document:
    """An empty document, its tools, and what they say of a label of its tree."""

    def __init__(self) -> None:
        self.whole = kernel("TDocStd").TDocStd_Document(extended("BinXCAF"))
        kernel("XCAFApp").XCAFApp_Application.GetApplication_s().InitDocument(self.whole)
        tools, main = kernel("XCAFDoc").XCAFDoc_DocumentTool, self.whole.Main()
        self.shapes, self.colors, self.layers = (
            tools.ShapeTool_s(main),
            tools.ColorTool_s(main),
            tools.LayerTool_s(main),
        )
        self.shapes.SetAutoNaming_s(False)

    def name(self, at: Any) -> str:
        """What a label is called; empty where nothing is said."""
        kind = kernel("TDataStd").TDataStd_Name
        if not at.IsAttribute(kind.GetID_s()):
            return ""
        found = kind()
        at.FindAttribute(kind.GetID_s(), found)
        return str(found.Get().ToExtString())

    def set_name(self, at: Any, name: str) -> None:
        """Call a label so."""
        if name:
            kernel("TDataStd").TDataStd_Name.Set_s(at, extended(name))

    def color(self, at: Any) -> tuple[float, ...] | None:
        """(4,) the colour of a label's surfaces, else of its curves."""
        kinds, found = kernel("XCAFDoc"), kernel("Quantity").Quantity_ColorRGBA()
        for kind in (kinds.XCAFDoc_ColorSurf, kinds.XCAFDoc_ColorGen, kinds.XCAFDoc_ColorCurv):
            if self.colors.GetColor_s(at, kind, found):
                rgb = found.GetRGB()
                return rgb.Red(), rgb.Green(), rgb.Blue(), found.Alpha()
        return None

    def set_color(self, at: Any, color: tuple[float, ...], kind: str) -> None:
        """Colour a label, as an edge or wire is or as all else."""
        kinds, made = kernel("XCAFDoc"), kernel("Quantity").Quantity_ColorRGBA(*color)
        which = kinds.XCAFDoc_ColorCurv if kind in ("edge", "wire") else kinds.XCAFDoc_ColorSurf
        self.colors.SetColor(at, made, which)

    def layers_of(self, at: Any) -> tuple[str, ...]:
        """The layers that a label lies on."""
        found = self.layers.GetLayers(at)
        return tuple(str(found.Value(i + 1).ToExtString()) for i in range(found.Length())) if found is not None else ()

    def set_layer(self, at: Any, name: str) -> None:
        """Put a label on a layer."""
        self.layers.SetLayer(at, extended(name))

    def count(self, tool: str, method: str) -> int:
        """How many of something a tool of the document lists."""
        found = labels()
        getattr(getattr(kernel("XCAFDoc").XCAFDoc_DocumentTool, tool)(self.whole.Main()), method)(found)
        return int(found.Length())


def labels() -> Any:
    """An empty sequence of labels, for the kernel to fill."""
    return kernel("collections").Sequence_TDF_Label()


def each(sequence: Any) -> list[Any]:
    """What a sequence of the kernel holds."""
    return [sequence.Value(i + 1) for i in range(sequence.Length())]


def extended(text: str) -> Any:
    """A text of the kernel, of any letters."""
    return kernel("TCollection").TCollection_ExtendedString(text, True)
