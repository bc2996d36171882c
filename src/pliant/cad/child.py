"""A process of its own in which Open CASCADE translates one file, so that a damaged one harms nobody.

Called as ``python -m pliant.cad.child FILE OUT KIND BYTES SECONDS``; OUT receives the shape as the kernel itself keeps
it, binary and exact; a file beside it, OUT.json, what is said of it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import orjson

from pliant.cad.document import Document
from pliant.cad.document_reading import contents
from pliant.cad.files import of_kind, silence
from pliant.cad.kernel import kernel
from pliant.cad.labels import plain
from pliant.io.mesh_formats.polydata_child import Refused, limit, refusing


def main(path: str, out: str, memory: int, seconds: int) -> int:
    """Translate a file within limits; returns the exit code."""
    limit(memory, seconds)
    with refusing(), silence():
        reader, document = of_kind(path, "STEPCAFControl_Reader", "IGESCAFControl_Reader"), Document()
        for mode in ("SetNameMode", "SetColorMode", "SetLayerMode", "SetGDTMode", "SetMatMode", "SetViewMode"):
            if hasattr(reader, mode):
                getattr(reader, mode)(True)
        kernel("Interface").Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
        if reader.ReadFile(path) != kernel("IFSelect").IFSelect_RetDone or not reader.Transfer(document.whole):
            raise Refused("the kernel finds no shape in it")
        shape, labels, unkept = contents(document)
        if shape is None:
            raise Refused("the kernel finds no shape in it")
        if not kernel("BinTools").BinTools.Write_s(shape, out):
            raise Refused("the kernel could not hand it over")
        Path(out + ".json").write_bytes(orjson.dumps({"labels": plain(labels), "unkept": unkept}))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[4]), int(sys.argv[5])))
