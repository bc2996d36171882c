"""Wavefront material libraries, and the pictures that they name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath

from pliant.io.text import bytes_of, text_of
from pliant.mesh import Material

_ARGUMENTS = {"-s": 3, "-o": 3, "-t": 3, "-mm": 2}  # at most so many numbers follow; any other option takes one word
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_PICTURES = ("map_", "bump", "disp", "decal", "refl", "norm")


@dataclass(frozen=True)
class Library:
    """A material library as it was found: how the mesh file calls it, where it is, and what it says."""

    name: str
    path: Path
    data: bytes


def statements(data: bytes) -> Iterator[tuple[str, str]]:
    """Each statement of a library: its keyword, and the rest of the line."""
    for raw in data.removeprefix(b"\xef\xbb\xbf").splitlines():
        line = raw.strip()
        if line and not line.startswith(b"#"):
            word, _, rest = line.replace(b"\t", b" ", 1).partition(b" ")
            yield text_of(word), text_of(rest.strip())


def parse(library: Library) -> dict[str, Material]:
    """The materials of a library, by name."""
    found: dict[str, list[tuple[str, str]]] = {}
    current: list[tuple[str, str]] = []
    for word, rest in statements(library.data):
        if word.lower() == "newmtl":
            current = found[rest] = []
        else:
            current.append((word, rest))
    return {name: _material(name, properties, library.path.parent) for name, properties in found.items()}


def _material(name: str, properties: list[tuple[str, str]], folder: Path) -> Material:
    values = {word.lower(): rest for word, rest in properties}
    color = [float(found[0]) for found in _NUMBER.finditer(values.get("kd", ""))]
    texture = find(picture(values["map_kd"]), folder) if "map_kd" in values else None
    diffuse = (color[0], color[1], color[2]) if len(color) == 3 else Material.color
    return Material(name, diffuse, texture, tuple(properties))


def picture(value: str) -> str:
    """The file name in a statement like ``map_Kd -s 1 1 1 wood grain.png``; it may hold blanks."""
    while value.startswith("-"):
        option, _, value = value.partition(" ")
        most = _ARGUMENTS.get(option.lower())
        value = value.lstrip()
        for _ in range(most or 1):
            word, _, rest = value.partition(" ")
            if not rest or (most and not _NUMBER.fullmatch(word)):
                break
            value = rest.lstrip()
    return value


def pictures(data: bytes) -> list[str]:
    """The file names that a library refers to, in order, each once."""
    names = (picture(rest) for word, rest in statements(data) if word.lower().startswith(_PICTURES))
    return list(dict.fromkeys(name for name in names if name))


def find(name: str, folder: Path) -> Path | None:
    """The file of a name relative to a folder; paths of other machines are looked for by their last part."""
    for candidate in (name, name.replace("\\", "/"), PureWindowsPath(name).name):
        try:
            if candidate and (folder / candidate).is_file():
                return folder / candidate
        except (OSError, ValueError):  # a name that this system cannot have
            continue
    return None


def text(materials: Mapping[str, Material]) -> bytes:
    """A library that holds the given materials."""
    lines: list[str] = []
    for material in materials.values():
        lines.append(f"newmtl {material.name}")
        words = {word.lower() for word, _ in material.properties}
        lines += [f"{word} {rest}".rstrip() for word, rest in material.properties]
        if "kd" not in words:
            lines.append("Kd " + " ".join(repr(float(value)) for value in material.color))
        if "map_kd" not in words and material.texture is not None:
            lines.append(f"map_Kd {material.texture.name}")
    return bytes_of("\n".join([*lines, ""]))


def place(name: str, data: bytes, folder: Path, stem: str) -> str:
    """The name under which a file can stand in or below a folder without harm to what stands there already."""
    portable = PurePosixPath(name.replace("\\", "/"))
    inside = not portable.is_absolute() and ".." not in portable.parts and not PureWindowsPath(name).drive
    wanted = name if inside and "\\" not in name else portable.name
    target = folder / wanted
    if not target.exists() or (target.is_file() and target.read_bytes() == data):
        return wanted
    return f"{stem}-{portable.name}"


def _renamed(data: bytes, name: str, used: str) -> bytes:
    """A library whose statements name a picture otherwise."""
    return re.sub(rb"(?m)(?<=\s)" + re.escape(bytes_of(name)) + rb"(?=\s*$)", lambda _: bytes_of(used), data)


def gather(libraries: list[Library], path: Path) -> tuple[dict[Path, bytes], dict[str, str], list[str]]:
    """The files that must stand beside a mesh file, for its materials and pictures to be found.

    Returns
    -------
    files
        What is to be written, by path; files that stand there already are left out.
    renamed
        Libraries that need another name, by the old one.
    missing
        Pictures that were not found.
    """
    files: dict[Path, bytes] = {}
    renamed: dict[str, str] = {}
    missing: list[str] = []
    for library in libraries:
        data = library.data
        for name in pictures(data):
            found = find(name, library.path.parent)
            if found is None:
                missing.append(name)
                continue
            content = found.read_bytes()
            used = name if Path(name).is_absolute() else place(name, content, path.parent, path.stem)
            if used != name:
                data = _renamed(data, name, used)
            files[path.parent / used] = content
        used = place(library.name, data, path.parent, path.stem)
        if used != library.name:
            renamed[library.name] = used
        files[path.parent / used] = data
    wanted = {at: data for at, data in files.items() if not (at.is_file() and at.read_bytes() == data)}
    return wanted, renamed, missing
