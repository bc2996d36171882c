"""Small files written by hand that between them use every part of the readers of text, and of simple binary formats."""

from __future__ import annotations

import base64
import io
import struct
import zipfile

import numpy as np

OBJ = b"""# a comment
mtllib none.mtl
o thing
v 0 0 0
v 1.5e0 0 0
v 1 1 0.25
v 0 1 -1e-3
v .5 .5 +1.
vt 0 0
vt 1 0
vt 1 1
vn 0 0 1
vn 0.12345678901234567 0 1
g front back
usemtl red
s 1
f 1/1/1 2/2/1 3/3/2 4/1/1
f -5//1 -4//1 \\
  -1//2
usemtl blue
s off
f 3 4 5
l 1 2 3
p 1
"""

OBJ_COLORS = b"\xef\xbb\xbfv 0 0 0 1 0 0\r\nv 1 0 0 0 1 0\r\nv 0 1 0 0 0 1\r\nf 1 2 3\r\n"

OFF = b"OFF # comment\n5 2 0\n\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .5 1\n4 0 1 2 3\n3 0 1 4 255 0 0\n"

OFF_ALL = b"""STCNOFF 3 1 0
0 0 0 0 0 1 255 0 0 255 0 0
1 0 0 0 0 1 0 255 0 255 1 0
0 1 0 0 0 1 0 0 255 255 0 1
3 0 1 2 1 0 0
"""

OFF_LOOSE = b"OFF 5\n2 0 # counts\n0 0\n0 1 0 0 1 1\n0 0 1 0 .5 .5 1\n4 0 1\n2 3 255 0 0\n3 0 1 4 0 255 0\n"

STL_TEXT = b"""solid two of them
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 0 1 0
 endloop
endfacet
facet normal 0 0 1
 outer loop
  vertex 1 0 0
  vertex 1 1 0
  vertex 0 1 0
 endloop
endfacet
endsolid two of them
"""

PLY_TEXT = b"""ply
format ascii 1.0
comment made by hand
element vertex 4
property float x
property float y
property double z
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
property float s
property float t
property float quality
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
property int material
element edge 1
property int vertex1
property int vertex2
end_header
0 0 0 0 0 1 255 0 0 0 0 .5
1 0 0 0 0 1 0 255 0 1 0 .25
1 1 0 0 0 1 0 0 255 1 1 .125
0 1 0 0 0 1 9 9 9 0 1 1e-2
3 0 1 2 6 0 0 1 0 1 1 7
4 0 1 2 3 8 0 0 1 0 1 1 0 1 8
0 3
"""


def stl_binary(head: bytes = b"solid but binary", count: int = 3) -> bytes:
    """A binary STL whose triangles have attribute bytes."""
    corners = np.arange(9.0 * count).reshape(count, 9) % 7
    records = (struct.pack("<12fH", 0, 0, 1, *row, i) for i, row in enumerate(corners))
    return head.ljust(80, b"\0") + struct.pack("<I", count) + b"".join(records)


def ply_binary(order: str = "<") -> bytes:
    """A binary PLY of either byte order with lists of different lengths, and a list between scalars."""
    name = {"<": b"binary_little_endian", ">": b"binary_big_endian"}[order]
    head = (
        b"ply\nformat " + name + b" 1.0\nobj_info made here\nelement vertex 4\nproperty float x\nproperty float y\n"
        b"property float z\nproperty list uchar short tags\nelement face 2\nproperty uchar flag\n"
        b"property list uchar uint vertex_index\nend_header\n"
    )
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0.1), (0, 1, 0)]
    body = b"".join(struct.pack(f"{order}3fB{i}h", *point, i, *range(i)) for i, point in enumerate(points))
    body += struct.pack(f"{order}BB3I", 1, 3, 0, 1, 2) + struct.pack(f"{order}BB4I", 2, 4, 0, 1, 2, 3)
    return head + body


def ply_strips() -> bytes:
    """A binary PLY whose triangles come as strips."""
    head = (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty double x\nproperty double y\n"
        b"property double z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
    strip = [0, 1, 2, 3, -1, 2, 3, 4]
    return head + np.arange(15.0).tobytes() + struct.pack(f"<i{len(strip)}i", len(strip), *strip)


def off_binary() -> bytes:
    """A binary OFF with normals whose faces differ in length."""
    vertices = np.array([[0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 1], [1, 1, 0, 0, 0, 1], [0, 1, 0, 0, 0, 1]], ">f4")
    faces = struct.pack(">5i3f", 3, 0, 1, 2, 3, 1, 0, 0) + struct.pack(">6i3f", 4, 0, 1, 2, 3, 3, 0, 1, 0)
    return b"NOFF BINARY\n" + struct.pack(">3i", 4, 2, 0) + vertices.tobytes() + faces


def gltf(*, binary: bool) -> bytes:
    """A glTF of a placed quadrilateral with a material; its buffer is inside."""
    chunk = np.array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], "<f4").tobytes()
    chunk += np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
    uri = "" if binary else f', "uri": "data:;base64,{base64.b64encode(chunk).decode()}"'
    text = (
        '{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], '
        '"nodes": [{"children": [1], "scale": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0.6, 0.8]}], '
        '"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "material": 0}]}], '
        '"materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}], '
        '"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}, '
        '{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}], '
        '"bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}], '
        f'"buffers": [{{"byteLength": 60{uri}}}]}}'
    ).encode()
    if not binary:
        return text
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(chunk), 0x004E4942) + chunk
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def threemf() -> bytes:
    """A 3MF package of a triangle built twice."""
    text = (
        '<model unit="millimeter"><resources><basematerials id="1"><base name="red" displaycolor="#FF0000"/>'
        '</basematerials><object id="2" pid="1" pindex="0"><mesh><vertices><vertex x="0" y="0" z="0"/>'
        '<vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/></vertices><triangles>'
        '<triangle v1="0" v2="1" v3="2"/></triangles></mesh></object></resources><build><item objectid="2"/>'
        '<item objectid="2" transform="2 0 0 0 2 0 0 0 2 1 0 0"/></build></model>'
    )
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as package:
        package.writestr(zipfile.ZipInfo("3D/3dmodel.model"), text)
    return out.getvalue()


MESHES = {
    "all.obj": OBJ,
    "colors.obj": OBJ_COLORS,
    "usual.off": OFF,
    "all.off": OFF_ALL,
    "loose.off": OFF_LOOSE,
    "binary.off": off_binary(),
    "text.stl": STL_TEXT,
    "binary.stl": stl_binary(),
    "table.csv": b"id,x,y,z,nx,ny,nz,heat\n1,0,0,0,0,0,1,2.5\n2,1,0,0,0,0,1,3\n3,0,1,0,0,0,1,4\n",
    "cloud.xyz": b"# a cloud\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1e-3 0 0 0 255\n",
    "placed.glb": gltf(binary=True),
    "placed.gltf": gltf(binary=False),
    "twice.3mf": threemf(),
    "text.ply": PLY_TEXT,
    "little.ply": ply_binary("<"),
    "big.ply": ply_binary(">"),
    "strips.ply": ply_strips(),
}

_SLICER = "# Markups fiducial file version = 4.13\n# CoordinateSystem = LPS\n"
_COLUMNS = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
LANDMARKS = {
    "named.csv": b"name,x,y,z\nnose,1,2,3\nleft ear,-4.5,5e-1,6\n",
    "semicolons.csv": "\ufeff# made by hand\n\na;1;2;3\r\nb;4;5;6\r\n".encode(),
    "scalismo.json": b'[{"id": "nose", "coordinates": [1.0, 2.0, 3.0], "uncertainty": {"stddevs": [1.0, 2.0, 3.0], '
    b'"pcvectors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}, {"id": "chin", "description": "low", "coordinates": [4, 5, 6]}'
    b"]",
    "slicer.mrk.json": b'{"markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": '
    b'[{"label": "F-1", "position": [1, 2, 3.5], "positionStatus": "defined", "description": "tip"}, {"label": "F-2", '
    b'"position": [0, 0, 0], "positionStatus": "undefined"}]}]}',
    "slicer.fcsv": (_SLICER + _COLUMNS + '0,-19.9,13.9,29.4,0,0,0,1,1,1,0,"F,1",,\n').encode(),
}

PAIRS = {"pairs.txt": b"# source target\n0 0\n1 2\n2, 1\n"}

RECIPE = b"""# words, numbers, percents and keys
pliant = 1
title = "Turn and taper"
about = "All that recipes have."
duration = 2.0
fps = 12
ending = "ping-pong"

[[layer]]
name = "turn"
kind = "twist"
around = true
axis = "z"
angle = 90
envelope = 0.8

[[layer]]
name = "taper"
kind = "taper"
around = true
factor = 0.5
profile = [[0, 0], [0.5, 1], [1, 0.2]]

[[layer]]
name = "lattice"
kind = "bspline-ffd"
around = true
shape = [3, 3, 4]
moves = [{ at = [2, "*", 3], by = ["10 %", 0, "5 %"] }]

[[key]]
layer = "turn"
time = 0
angle = 0

[[key]]
layer = "turn"
time = 2
angle = 180
easing = "ease_in_out"
"""
