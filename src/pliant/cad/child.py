"""A process of its own in which Open CASCADE translates one file, so that a damaged one harms nobody.

Called as ``python -m pliant.cad.child FILE OUT KIND BYTES SECONDS``; OUT receives the shape as the kernel itself keeps
it, binary and exact.
"""

from __future__ import annotations

import sys

from pliant.cad.files import of_kind, silence
from pliant.cad.kernel import kernel
from pliant.io.mesh_formats.polydata_child import Refused, limit, refusing


def main(path: str, out: str, memory: int, seconds: int) -> int:
    """Translate a file within limits; returns the exit code."""
    limit(memory, seconds)
    with refusing(), silence():
        reader = of_kind(path, "STEPControl_Reader", "IGESControl_Reader")
        if reader.ReadFile(path) != kernel("IFSelect").IFSelect_RetDone or not reader.TransferRoots():
            raise Refused("the kernel finds no shape in it")
        if not kernel("BinTools").BinTools.Write_s(reader.OneShape(), out):
            raise Refused("the kernel could not hand it over")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[4]), int(sys.argv[5])))
