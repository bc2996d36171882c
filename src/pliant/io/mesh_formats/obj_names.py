"""Names as an OBJ file can say them: in one line, and with no backslash at its end, which would continue it."""

from __future__ import annotations

from dataclasses import replace

from pliant.io.text import shown
from pliant.mesh import PolygonMesh


def writable_names(mesh: PolygonMesh) -> tuple[PolygonMesh, tuple[str, ...]]:
    """The mesh with names that can be written, and a sentence for each that had to change."""
    labels = {kind: getattr(mesh, kind) for kind in ("groups", "objects", "materials")}
    names = [*mesh.material_library, *(name for each in labels.values() if each for name in each.names)]
    changed = {name: _in_one_line(name) for name in dict.fromkeys(names) if _in_one_line(name) != name}
    if not changed:
        return mesh, ()
    library = {
        changed.get(name, name): replace(each, name=changed.get(name, name))
        for name, each in mesh.material_library.items()
    }
    renamed = {
        kind: replace(each, names=tuple(changed.get(name, name) for name in each.names))
        for kind, each in labels.items()
        if each
    }
    losses = tuple(f"the name {shown(old)!r} is written as {shown(new)!r}" for old, new in changed.items())
    return mesh.replace(material_library=library, **renamed), losses


def _in_one_line(name: str) -> str:
    """A name without what ends a line or what stands before its end."""
    words = "".join(" " if character < " " else character for character in name).strip()
    return words.rstrip("\\") + "_" * (len(words) - len(words.rstrip("\\"))) or "_"
