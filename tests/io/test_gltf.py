"""glTF and GLB: scenes of placed meshes, written back with other positions and nothing else."""

import base64
import json
import struct

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.mesh_formats.gltf_file import packed
from pliant.io.meshes import read_mesh_bytes
from pliant.mesh import CornerValues, FaceLabels, Material

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9]], "<f4")
NORMALS = np.array([[0, 0, 1]] * 4 + [[1, 0, 0]], "<f4")
COORDINATES = np.array([[0, 0], [0.25, 0], [1, 0.75], [0, 1], [0, 0]], "<f4")
FACES = np.array([[0, 1, 2], [0, 2, 3]], "<u2")


def scene(**nodes):
    """A description and its chunk: one mesh of two primitives that share their vertices, and a node for it."""
    blobs = [POSITIONS, NORMALS, COORDINATES, FACES[:1], FACES[1:]]
    views, chunk = [], b""
    for blob in blobs:
        chunk += b"\0" * (-len(chunk) % 4)
        views.append({"buffer": 0, "byteOffset": len(chunk), "byteLength": blob.nbytes})
        chunk += blob.tobytes()
    kinds = [(5126, "VEC3", 5), (5126, "VEC3", 5), (5126, "VEC2", 5), (5123, "SCALAR", 3), (5123, "SCALAR", 3)]
    accessors = [
        {"bufferView": i, "componentType": kind, "type": name, "count": count}
        for i, (kind, name, count) in enumerate(kinds)
    ]
    accessors[0] |= {"min": [0, 0, 0], "max": [9, 9, 9]}
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    primitives = [{"attributes": attributes, "indices": 3 + i, "material": i} for i in range(2)]
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "plate", "mesh": 0, **nodes}],
        "meshes": [{"primitives": primitives}],
        "materials": [
            {"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}},
            {"extras": {"kept": [1.5]}},
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(chunk)}],
        "extras": {"note": "mine"},
    }, chunk


def glb(description, chunk):
    return b"".join(packed(description, chunk, binary=True))


def parts(data):
    """The description and the chunk of a GLB."""
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + size]), data[28 + size :]


PLACED = {"translation": [1, 2, 3], "rotation": [0, 0, 2**-0.5, 2**-0.5], "scale": [2, 4, 8]}


def test_nodes_place_their_meshes_and_turn_their_normals():
    description, chunk = scene(**PLACED)
    mesh = read_mesh_bytes(glb(description, chunk), "a.glb")
    expected = (POSITIONS * [2, 4, 8])[:, [1, 0, 2]] * [-1, 1, 1] + [1, 2, 3]
    assert np.allclose(mesh.points, expected, atol=1e-12)
    assert np.array_equal(mesh.faces.flat.reshape(-1, 3), FACES)
    assert np.allclose(mesh.normals.values, (NORMALS[:, [1, 0, 2]] * [-1, 1, 1]), atol=1e-12)
    assert np.allclose(mesh.uvs.per_corner, (COORDINATES * [1, -1] + [0, 1])[FACES.ravel()])
    assert [mesh.materials.names[i] for i in mesh.materials.indices] == ["red", "material 1"]
    assert mesh.material_library["red"].color == (1, 0, 0)
    assert mesh.objects.names == ("plate",)


def test_children_stand_where_their_parents_put_them_and_mirrors_turn_faces_round():
    description, chunk = scene(scale=[-1, 1, 1])
    matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]  # a quarter turn about z, and 5 along x
    description["nodes"].append({"matrix": matrix, "children": [0]})
    description["scenes"][0]["nodes"] = [1]
    mesh = read_mesh_bytes(glb(description, chunk), "a.glb")
    assert np.allclose(mesh.points, POSITIONS[:, [1, 0, 2]] * [-1, -1, 1] + [5, 0, 0])
    assert mesh.faces.flat.reshape(-1, 3).tolist() == FACES[:, ::-1].tolist()
    corners = mesh.points[mesh.faces.flat.reshape(-1, 3)]
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0).all()
    assert np.allclose(mesh.normals.values, NORMALS[:, [1, 0, 2]] * [1, -1, 1])


def test_positions_change_and_all_else_stays(tmp_path):
    description, chunk = scene(**PLACED)
    data = glb(description, chunk)
    (tmp_path / "a.glb").write_bytes(data)
    mesh = pl.read(tmp_path / "a.glb")
    pl.write(mesh, tmp_path / "same.glb", strict=True)
    assert (tmp_path / "same.glb").read_bytes() == data
    turned = CornerValues(np.tile([0.0, 0.6, 0.8], (5, 1)), mesh.normals.indices)
    pl.write(mesh.with_points(mesh.points + [0, 0, 8], normals=turned), tmp_path / "moved.glb", strict=True)
    now, moved = parts((tmp_path / "moved.glb").read_bytes())
    assert np.allclose(np.frombuffer(moved, "<f4", 15).reshape(5, 3), POSITIONS + [0, 0, 1], atol=1e-6)
    assert moved[120 : len(chunk)] == chunk[120:]
    assert np.allclose(now["accessors"][0].pop("min"), [0, 0, 1], atol=1e-6)
    assert np.allclose(now["accessors"][0].pop("max"), [9, 9, 10], atol=1e-6)
    description["accessors"][0].pop("min"), description["accessors"][0].pop("max")
    assert now == description
    again = pl.read(tmp_path / "moved.glb")
    assert np.allclose(again.points, mesh.points + [0, 0, 8], atol=1e-5)
    assert np.allclose(again.normals.values, turned.values, atol=1e-6)


def test_buffers_and_pictures_beside_the_file_go_with_it(tmp_path):
    description, chunk = scene()
    description["buffers"][0]["uri"] = "the%20data.bin"
    description["images"] = [{"uri": "wood.png"}]
    description["textures"] = [{"source": 0}]
    description["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    home = tmp_path / "home"
    home.mkdir()
    (home / "a.gltf").write_text(json.dumps(description))
    (home / "the data.bin").write_bytes(chunk)
    (home / "wood.png").write_bytes(b"a picture")
    mesh = pl.read(home / "a.gltf")
    assert mesh.material_library["red"].texture == home / "wood.png"
    pl.write(mesh.with_points(mesh.points + 1), tmp_path / "away" / "b.gltf", strict=True)
    assert (tmp_path / "away" / "wood.png").read_bytes() == b"a picture"
    assert np.array_equal(pl.read(tmp_path / "away" / "b.gltf").points, mesh.points + 1)
    pl.write(mesh.with_points(mesh.points + 2), home / "b.gltf", strict=True)
    assert np.array_equal(pl.read(home / "b.gltf").points, mesh.points + 2)
    assert (home / "the data.bin").read_bytes() == chunk
    (home / "the data.bin").unlink()
    with pytest.raises(UnreadableFile, match=r"the%20data\.bin.*not there"):
        pl.read(home / "a.gltf")


def test_a_buffer_inside_the_description_is_read_and_written(tmp_path):
    description, chunk = scene()
    description["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(chunk).decode()
    mesh = read_mesh_bytes(json.dumps(description).encode(), "stream")
    pl.write(mesh.with_points(mesh.points * 2), tmp_path / "a.gltf", strict=True)
    assert np.array_equal(pl.read(tmp_path / "a.gltf").points, mesh.points * 2)


def test_a_mesh_in_two_places_moves_alike_or_becomes_another_file(tmp_path):
    description, chunk = scene()
    description["nodes"].append({"mesh": 0, "translation": [10, 0, 0]})
    description["scenes"][0]["nodes"] = [0, 1]
    (tmp_path / "a.glb").write_bytes(glb(description, chunk))
    mesh = pl.read(tmp_path / "a.glb")
    assert np.array_equal(mesh.points, np.concatenate([POSITIONS, POSITIONS + np.float32([10, 0, 0])]))
    pl.write(mesh.with_points(mesh.points + [0, 1, 0]), tmp_path / "alike.glb")
    assert len(parts((tmp_path / "alike.glb").read_bytes())[0]["nodes"]) == 2
    bent = mesh.points.copy()
    bent[0] += 1
    pl.write(mesh.with_points(bent), tmp_path / "apart.glb")
    assert len(parts((tmp_path / "apart.glb").read_bytes())[0]["nodes"]) == 1
    for name, points in (("alike", mesh.points + [0, 1, 0]), ("apart", bent)):
        assert np.array_equal(pl.read(tmp_path / f"{name}.glb").points, points)


def test_a_shape_at_rest_is_read_by_choice(tmp_path):
    description, chunk = scene(skin=0, translation=[7, 7, 7])
    description["skins"] = [{"joints": [0]}]
    description["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 1}]
    (tmp_path / "a.glb").write_bytes(glb(description, chunk))
    with pytest.raises(UnsupportedFormat, match=r"a skin and morph targets; freeze=True"):
        pl.read(tmp_path / "a.glb")
    mesh = pl.read(tmp_path / "a.glb", freeze=True)
    assert np.array_equal(mesh.points, POSITIONS)
    assert {"a skin", "morph targets"} <= set(pl.write(mesh, tmp_path / "a.obj").losses)
    pl.write(mesh.with_points(mesh.points + 1), tmp_path / "b.glb", strict=True)
    assert parts((tmp_path / "b.glb").read_bytes())[0]["skins"] == description["skins"]
    assert np.array_equal(pl.read(tmp_path / "b.glb", freeze=True).points, POSITIONS + 1)


@pytest.mark.parametrize("ending", ["glb", "gltf"])
def test_a_new_file_splits_at_seams_and_holds_the_rest(ending, tmp_path):
    (tmp_path / "wood.png").write_bytes(b"\x89PNG")
    mesh = pl.PolygonMesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]],
        [[0, 1, 2, 3], [2, 1, 0]],
        uvs=CornerValues([[0, 0], [1, 0], [1, 1], [0, 1]], [0, 1, 2, 3, 3, 1, 0]),
        normals=CornerValues([[0, 0, 1], [0, 0, -1]], [0, 0, 0, 0, 1, 1, 1]),
        materials=FaceLabels(("wood", "none"), [0, -1]),
        material_library={"wood": Material("wood", (0.5, 0.25, 1), tmp_path / "wood.png")},
        vertex_attributes={"colors": np.arange(15, dtype=np.uint8).reshape(5, 3)},
        lines=[[0, 4]],
    )
    losses = pl.write(mesh, tmp_path / f"a.{ending}").losses
    assert losses == ("1 polygons are cut into 2 triangles", "3 vertices are added where seams split them")
    again = pl.read(tmp_path / f"a.{ending}")
    assert np.array_equal(again.points[:5], mesh.points)
    wanted = mesh.triangle_corners
    found = again.faces.flat.reshape(-1, 3)
    order = np.argsort(again.materials.indices == -1, kind="stable")
    assert np.array_equal(again.points[found][order], mesh.points[mesh.triangles])
    for name in ("uvs", "normals"):
        values = getattr(again, name).per_corner.reshape(3, 3, -1)[order]
        assert np.allclose(values, getattr(mesh, name).per_corner[wanted])
    assert np.array_equal(again.vertex_attributes["colors"][:5], mesh.vertex_attributes["colors"])
    assert again.lines[0].tolist() == [0, 4]
    assert again.material_library["wood"].color == (0.5, 0.25, 1)
    assert b"wood" in (tmp_path / f"a.{ending}").read_bytes()


def test_another_library_reads_what_is_written(box_mesh, tmp_path):
    pygltflib = pytest.importorskip("pygltflib")
    pl.write(box_mesh, tmp_path / "a.glb")
    other = pygltflib.GLTF2().load(str(tmp_path / "a.glb"))
    accessor = other.accessors[other.meshes[0].primitives[0].attributes.POSITION]
    view = other.bufferViews[accessor.bufferView]
    points = np.frombuffer(other.binary_blob(), "<f4", 3 * accessor.count, view.byteOffset).reshape(-1, 3)
    assert np.array_equal(points[: len(box_mesh.points)], box_mesh.points.astype(np.float32))
    assert np.array_equal(accessor.min, points.min(axis=0))
    assert np.array_equal(accessor.max, points.max(axis=0))


def damaged(change):
    description, chunk = scene()
    change(description)
    return glb(description, chunk)


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (lambda d: d["accessors"][0].update(count=10**9), "accessor 0 needs 1,000,000,000 values"),
        (lambda d: d["bufferViews"][0].update(byteOffset=-4), "accessor 0 has sizes that are none"),
        (lambda d: d["nodes"][0].update(children=[0]), "node 0 has two parents"),
        (lambda d: d["nodes"][0].update(mesh=5), "contradicts itself"),
        (lambda d: d["accessors"][0].update(type="MAT9"), "contradicts itself"),
        (lambda d: d["accessors"][0].update(count=2), r"accessor 1 has the shape \(5, 3\)"),
        (lambda d: d["accessors"][3].update(bufferView=1, byteOffset=6), "uses vertex 16256; it has 5"),
        (lambda d: d["scenes"][0].update(nodes=[]), "holds no mesh"),
        (lambda d: d["nodes"][0].update(scale=[1e200, 1e200, 1e999]), "JSON|not finite"),
    ],
)
def test_what_is_wrong_is_named(change, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(damaged(change), "bad.glb")


@pytest.mark.parametrize("name", ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "XYZ_other"])
def test_extensions_that_change_the_meaning_are_refused_by_name(name):
    with pytest.raises(UnsupportedFormat, match=name):
        read_mesh_bytes(damaged(lambda d: d.update(extensionsRequired=[name])), "bad.glb")
    data = damaged(lambda d: d["meshes"][0]["primitives"][0].update(extensions={"KHR_draco_mesh_compression": {}}))
    with pytest.raises(UnsupportedFormat, match="Draco"):
        read_mesh_bytes(data, "bad.glb")


def test_a_container_that_is_cut_off_is_named():
    data = glb(*scene())
    with pytest.raises(UnreadableFile, match="cut off"):
        read_mesh_bytes(data[:-10], "bad.glb")
    with pytest.raises(UnsupportedFormat, match="glTF 1"):
        read_mesh_bytes(damaged(lambda d: d["asset"].update(version="1.0")), "old.glb")
