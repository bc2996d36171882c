"""3MF, the 3D Manufacturing Format: a ZIP package with a model in XML."""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.carrier import Carrier, carrier_of, with_carrier
from pliant.io.mesh_formats.format import Encoded, Keeps, MeshFormat, Source
from pliant.io.mesh_formats.losses import losses_of
from pliant.io.mesh_formats.threemf_model import Item, Matrix, parsed
from pliant.io.text import number_text, shown
from pliant.mesh import FaceLabels, Material, PolygonMesh
from pliant.numerics.ragged import Ragged

_VERTEX = re.compile(rb"<!--.*?-->|<(?:\w+:)?vertex\s[^>]*>", re.S)
_ROOM, _GROWTH = 1 << 26, 100  # bytes that any model may inflate to, and how often its package's size
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


@dataclass(frozen=True, eq=False)
class Layout:
    """The model's name in the package, its text, its objects in order, and which are built where."""

    name: str
    text: bytes
    items: tuple[Item, ...]
    placed: tuple[tuple[Item, Matrix], ...]


class ThreeMf(MeshFormat):
    """3MF: what is built, as one mesh, in the model's unit; the package is written back with other positions."""

    name = "3MF"
    suffixes = (".3mf",)
    keeps = Keeps(materials=True)

    def sniff(self, data: bytes) -> bool:
        """Whether the file is a package that holds a model."""
        return data.startswith(b"PK\x03\x04") and b".model" in data

    def read(self, source: Source) -> PolygonMesh:
        """The objects that a package builds."""
        name, text = _model(source)
        model = parsed(source, text)
        placed = tuple(model.placed(source))
        if not placed:
            raise source.unreadable("the model builds nothing", "export it with its objects")
        counts = [len(item.vertices) for item, _ in placed]
        first = np.concatenate([[0], np.cumsum(counts)])
        points = np.concatenate([np.array(item.vertices) @ m[:3] + m[3] for item, m in placed])
        faces = []
        for (item, matrix), begin, count in zip(placed, first[:-1].tolist(), counts, strict=True):
            triangles = np.array(item.triangles, np.int64).reshape(-1, 3)
            if triangles.size and not 0 <= triangles.min() <= triangles.max() < count:
                cause = f"a triangle uses vertex {triangles.max()}; its object has {count:,}"
                raise source.unreadable(cause, "export the file again")
            faces.append((triangles if np.linalg.det(matrix[:3]) >= 0 else triangles[:, ::-1]) + begin)
        known = {(group, i): i for group, each in model.materials.items() for i in range(len(each))}
        order = {key: at for at, key in enumerate(known)}
        painted = [order.get(key, -1) for item, _ in placed for key in item.painted]
        materials = [Material(name, color) for each in model.materials.values() for name, color in each]
        mesh = PolygonMesh(
            points,
            Ragged.of(np.concatenate(faces).astype(np.int32)),
            objects=FaceLabels(
                tuple(item.name or f"object {i}" for i, (item, _) in enumerate(placed)),
                np.repeat(np.arange(len(placed)), [len(item.triangles) for item, _ in placed]).astype(np.int32),
            ),
            materials=FaceLabels(tuple(each.name for each in materials), np.array(painted)) if materials else None,
            material_library={each.name: each for each in materials},
        )
        layout = Layout(name, text, tuple(model.items.values()), placed)
        return with_carrier(mesh, self.name, source.data, layout, tuple(model.others))

    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """The package that the mesh was read from, with other positions; a new one if that cannot hold them."""
        carrier = carrier_of(mesh, self.name)
        return (_same_file(mesh, carrier) if carrier else None) or _new_file(mesh, self.keeps)


def _model(source: Source) -> tuple[str, bytes]:
    """The model's name in the package, and its text."""
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as package:
            found = [each for each in package.infolist() if each.filename.lower().endswith(".model")]
            found.sort(key=lambda each: (not each.filename.lower().endswith("3dmodel.model"), each.filename))
            if not found:
                raise source.unreadable("the package holds no model", "check what the file is")
            if found[0].file_size > _ROOM + _GROWTH * len(source.data):
                cause = f"the model inflates to {found[0].file_size:,} bytes, out of {len(source.data):,}"
                raise source.unreadable(cause, "if that is meant, unpack and compress it again")
            return found[0].filename, package.read(found[0])
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError, ValueError) as error:
        raise source.unreadable(f"the package is damaged: {error}", "copy or export it again") from error


def _same_file(mesh: PolygonMesh, carrier: Carrier) -> Encoded | None:
    """The package with the vertices exchanged that moved; None where an object moved differently in two places."""
    layout: Layout = carrier.layout
    if np.array_equal(mesh.points, carrier.mesh.points):
        return Encoded([carrier.data])
    local: dict[int, NDArray[np.float64]] = {}
    begin = 0
    for item, matrix in layout.placed:
        rows = slice(begin, begin + len(item.vertices))
        begin = rows.stop
        old = np.array(item.vertices)
        if np.linalg.matrix_rank(matrix[:3]) < 3:
            return None
        new = (mesh.points[rows] - matrix[3]) @ np.linalg.inv(matrix[:3])
        new = np.where((mesh.points[rows] != carrier.mesh.points[rows]).any(axis=1, keepdims=True), new, old)
        if not np.allclose(local.setdefault(id(item), new), new, rtol=1e-12, atol=1e-12 * float(np.abs(new).max())):
            return None
    before = [vertex for item in layout.items for vertex in item.vertices]
    after = np.concatenate([local.get(id(item), np.array(item.vertices).reshape(-1, 3)) for item in layout.items])
    tags = [found for found in _VERTEX.finditer(layout.text) if not found[0].startswith(b"<!--")]
    if len(tags) != len(before):
        return None
    pieces, at = [], 0
    for row in np.flatnonzero((np.array(before) != after).any(axis=1)).tolist():
        pieces += [layout.text[at : tags[row].start()], _exchanged(tags[row][0], after[row].tolist())]
        at = tags[row].end()
    text = b"".join([*pieces, layout.text[at:]])
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(carrier.data)) as package, zipfile.ZipFile(out, "w") as copy:
        for each in package.infolist():
            copy.writestr(each, text if each.filename == layout.name else package.read(each))
    return Encoded([out.getvalue()])


def _exchanged(tag: bytes, vertex: list[float]) -> bytes:
    """A vertex's tag with other coordinates."""
    for name, value in zip((b"x", b"y", b"z"), vertex, strict=True):
        tag = re.sub(rb"(\s" + name + rb"\s*=\s*)(\"[^\"]*\"|'[^']*')", rb'\g<1>"%b"' % repr(value).encode(), tag)
    return tag


def _new_file(mesh: PolygonMesh, keeps: Keeps) -> Encoded:
    """A package of one object."""
    numbers = number_text(mesh.points).decode().split(",") if len(mesh.points) else []
    rows = zip(numbers[::3], numbers[1::3], numbers[2::3], strict=True)
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>\n' for x, y, z in rows)
    names = [] if mesh.materials is None else list(mesh.materials.names)
    used = [-1] * len(mesh.triangles)
    if mesh.materials is not None:
        used = mesh.materials.indices[mesh.triangle_faces].tolist()
    paint = [f' pid="1" p1="{i}"' if i >= 0 else "" for i in used]
    corners = zip(mesh.triangles.tolist(), paint, strict=True)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"{more}/>\n' for (a, b, c), more in corners)
    bases = ""
    for name in names:
        color = "".join(f"{round(255 * each):02X}" for each in mesh.material_library.get(name, Material(name)).color)
        bases += f'<base name={quoteattr(shown(name))} displaycolor="#{color}"/>\n'
    group = f'<basematerials id="1">\n{bases}</basematerials>\n' if bases else ""
    text = (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xmlns="{_CORE}">\n<resources>\n{group}'
        f'<object id="2" type="model"><mesh>\n<vertices>\n{vertices}</vertices>\n<triangles>\n{triangles}</triangles>\n'
        '</mesh></object>\n</resources>\n<build><item objectid="2"/></build>\n</model>\n'
    )
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as package:
        for name, part in (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS), ("3D/3dmodel.model", text)):
            info = zipfile.ZipInfo(name)
            info.compress_type = zipfile.ZIP_DEFLATED
            package.writestr(info, part)
    return Encoded([out.getvalue()], losses_of(mesh, keeps), ("3MF needs a unit: millimetres are written",))
