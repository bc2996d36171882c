"""Wavefront OBJ: polygons whose corners share pools of positions, texture coordinates and normals."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantWarning
from pliant.io.mesh_formats import mtl, obj_writer
from pliant.io.mesh_formats.carrier import carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.obj_elements import parse_elements, require_numbers
from pliant.io.mesh_formats.obj_writer import Layout
from pliant.io.text import Lines, Offsets, keyword, plain_text, read_numbers, shown, text_of
from pliant.mesh import CornerValues, FaceLabels, PolygonMesh
from pliant.numerics.ragged import Ragged

_SHAPES = (b"p", b"curv", b"curv2", b"surf", b"vp")
_KNOWN = (
    b"v vt vn vp f fo l p g o s usemtl mtllib usemap maplib mg lod bevel c_interp d_interp cstype deg bmat step curv "
    b"curv2 surf parm trim hole scrv sp end con shadow_obj trace_obj ctech stech bsp bzp cdc cdp res call csh"
).split()
_BEGINNING = re.compile(rb"(v|vt|vn|f|g|o|mtllib|usemtl)[ \t]")


class Obj(MeshFormat):
    """Wavefront OBJ with its material libraries and their pictures."""

    name = "OBJ"
    suffixes = (".obj",)
    keeps = Keeps(
        polygons=True,
        lines=True,
        corner_uvs=True,
        corner_normals=True,
        vertex_normals=True,
        vertex_colors=True,
        groups=True,
        objects=True,
        materials=True,
        textures=True,
    )

    def sniff(self, data: bytes) -> bool:
        """Whether the first statement is one of OBJ's."""
        head = data[:4096].removeprefix(b"\xef\xbb\xbf")
        lines = [line.strip() for line in head.splitlines()]
        first = next((line for line in lines if line and not line.startswith(b"#")), b"")
        return b"\0" not in head and _BEGINNING.match(first + b" ") is not None

    def read(self, source: Source) -> PolygonMesh:
        """The mesh that an OBJ file holds."""
        text = plain_text(source)
        lines = Lines.of(text)
        rows = {kind: lines.where(*words) for kind, words in _KINDS.items()}
        if not len(rows["v"]):
            raise source.unreadable("there is no vertex", "an OBJ file needs lines that begin with 'v'")
        unique = _warn_of_others(source, lines, rows)
        points, starts, attributes = _vertices(source, lines[rows["v"]])
        uvs, _ = _pool(source, lines[rows["vt"]], 1)
        normals, normal_starts = _pool(source, lines[rows["vn"]], 3)
        flat, offsets = _corners(source, lines, rows, "f", (len(points), len(uvs), len(normals)))
        flat_lines, line_offsets = _corners(source, lines, rows, "l", (len(points), len(uvs), len(normals)))
        libraries = _libraries(source, lines)
        mesh = PolygonMesh(
            points,
            Ragged(flat[0], offsets),
            uvs=CornerValues(uvs, flat[1]) if (flat[1] >= 0).any() else None,
            normals=CornerValues(normals, flat[2]) if (flat[2] >= 0).any() else None,
            groups=_labels(lines, b"g", rows["f"]),
            objects=_labels(lines, b"o", rows["f"]),
            materials=_labels(lines, b"usemtl", rows["f"]),
            material_library={name: each for library in libraries for name, each in mtl.parse(library).items()},
            vertex_attributes=attributes,
            face_attributes=_smoothing(lines, rows["f"]),
            lines=Ragged(flat_lines[0], line_offsets) if len(line_offsets) > 1 else None,
        )
        layout = Layout(starts, normals, normal_starts, tuple(libraries))
        if count := int((flat_lines[1] >= 0).sum()):
            unique = (*unique, f"{count:,} texture coordinates of lines")
        return with_carrier(mesh, self.name, source.data, layout, unique)

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The file that the mesh was read from, with other numbers; a new one if that was none or another."""
        carrier = carrier_of(mesh, self.name)
        return obj_writer.same_file(mesh, carrier, path) if carrier else obj_writer.new_file(mesh, self, path)


_KINDS = {"v": (b"v",), "vt": (b"vt",), "vn": (b"vn",), "f": (b"f", b"fo"), "l": (b"l",)}


def _warn_of_others(source: Source, lines: Lines, rows: dict[str, Offsets]) -> tuple[str, ...]:
    """Warn of statements that OBJ does not have, and tell of those that only the file itself can keep."""
    other = np.ones(len(lines), bool)
    for used in rows.values():
        other[used] = False
    at = np.flatnonzero(other)
    unknown = at[~np.isin(lines.key[at], [keyword(word) for word in _KNOWN])]
    if len(unknown):
        line = lines[unknown[:1]]
        word = shown(text_of(lines.text[line.start[0] : line.body[0]][:40]))
        warnings.warn(
            f"{source.name}: {len(unknown)} statements are not OBJ and were passed over, "
            f"the first is {word!r} in line {source.line(int(line.start[0]))}",
            PliantWarning,
            stacklevel=2,
        )
    shapes = len(lines.where(*_SHAPES))
    return (f"{shapes} points, curves or surfaces that are no polygons",) if shapes else ()


def _vertices(source: Source, lines: Lines) -> tuple[NDArray[np.float64], Offsets, dict[str, Any]]:
    """(n, 3) positions, (n, 3) where they stand, and what else the vertices say: colours or weights."""
    numbers = read_numbers(source, lines, 3)
    require_numbers(source, lines, numbers.counts, 3, "vertex")
    points, starts = numbers.values.reshape(-1, 3), numbers.starts.reshape(-1, 3)
    most = int(numbers.counts.max())
    if most == 3:
        return points, starts, {}
    extra = read_numbers(source, lines, 7).values.reshape(-1, 7)
    if numbers.counts.min() >= 6:
        return points, starts, {"colors": extra[:, 3 : min(most, 7)]}
    return points, starts, {"weights": np.where(numbers.counts == 4, extra[:, 3], 1.0)}


def _pool(source: Source, lines: Lines, least: int) -> tuple[NDArray[np.float64], Offsets]:
    """A pool of texture coordinates or normals, and where its numbers stand."""
    numbers = read_numbers(source, lines, 3)
    require_numbers(source, lines, numbers.counts, least, "texture coordinate" if least == 1 else "normal")
    values = numbers.values.reshape(-1, 3)
    flat = least == 1 and not (numbers.counts > 2).any()
    return values[:, :2] if flat else values, numbers.starts.reshape(-1, 3)


def _corners(
    source: Source, lines: Lines, rows: dict[str, Offsets], kind: str, sizes: tuple[int, int, int]
) -> tuple[list[NDArray[np.int32]], Offsets]:
    """Indices (c,) into the three pools, counted from 0 and -1 where there is none, and the elements' offsets."""
    at = rows[kind]
    elements = lines[at]
    table, _, offsets = parse_elements(source, elements)
    result = []
    for part, (word, size) in enumerate(zip(("v", "vt", "vn"), sizes, strict=True)):
        index = table[:, part]
        if (index < 0).any():
            before = np.repeat(np.searchsorted(rows[word], at), np.diff(offsets))
            index = np.where(index < 0, np.maximum(before + index + 1, -1), index)
        else:
            before = None
        wrong = np.flatnonzero((index > size) | (index < 0) | ((table[:, part] < 0) & (index == 0)))
        if len(wrong):
            line = int(elements.start[np.searchsorted(offsets, wrong[0], "right") - 1])
            what = {"v": "vertex", "vt": "texture coordinate", "vn": "normal"}[word]
            cause = f"a {'face' if kind == 'f' else 'line'} uses {what} {table[wrong[0], part]}; the file has {size}"
            raise source.unreadable(cause, "the file is cut off, or its indices are wrong: export it again", at=line)
        result.append((index - 1).astype(np.int32))
    return result, offsets


def _states(lines: Lines, word: bytes, faces: Offsets) -> tuple[list[str], NDArray[np.int32]]:
    """What each statement of a kind says, each text once, and which of them holds at each face; -1 = none."""
    at = lines.where(word)
    names: dict[str, int] = {}
    said = (text_of(lines.rest(row)) for row in at)
    ids = [names.setdefault(name, len(names)) if name else -1 for name in said]
    return list(names), np.array([-1, *ids], np.int32)[np.searchsorted(at, faces)]


def _labels(lines: Lines, word: bytes, faces: Offsets) -> FaceLabels | None:
    names, indices = _states(lines, word, faces)
    return FaceLabels(tuple(names), indices) if names else None


def _smoothing(lines: Lines, faces: Offsets) -> dict[str, NDArray[np.int32]]:
    names, indices = _states(lines, b"s", faces)
    numbers = [int(name) if name.isascii() and name.isdigit() and len(name) < 10 else 0 for name in names]
    return {"smoothing": np.array([*numbers, 0], np.int32)[indices]} if names else {}


def _libraries(source: Source, lines: Lines) -> list[mtl.Library]:
    """The material libraries that are found; a warning for those that are not."""
    found = []
    for row in lines.where(b"mtllib"):
        whole = text_of(lines.rest(row))
        names = [whole] if source.folder and mtl.find(whole, source.folder) else whole.split()
        for name in names:
            path = mtl.find(name, source.folder) if source.folder else None
            if path is None:
                message = (
                    f"{source.name}: the material library {shown(name)!r} is not there; materials keep their names"
                )
                warnings.warn(message, PliantWarning, stacklevel=2)
            else:
                found.append(mtl.Library(name, path, path.read_bytes()))
    return list({library.name: library for library in found}.values())
