"""Project files: everything comes back, nothing is ever lost, and hostile files are refused."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
import zipfile
from io import BytesIO

import numpy as np
import orjson
import pytest
from every_deformer import every_deformer
from scene_shapes import HANDLE, MASK, MESH, lattice, mixed_stack, space_stack

import pliant as pl
from pliant.errors import InvalidParameter, PliantWarning, UnreadableFile, UnwritableFile
from pliant.mesh import FaceLabels, Material


def full_scene():
    stack = mixed_stack().replace("twist", invert=True, envelope=0.7).replace("warp", muted=True)
    motion = pl.MeshSequence(np.stack([MESH.points, MESH.points + 0.1]), [0.0, 0.5])
    clip = pl.Clip(MESH, stack, duration=2.0, fps=10, ending="ping-pong", intensity=0.8, motion=motion, amplify=1.5)
    clip = clip.key("twist", 0.0, {"angle": 0.0}).key("twist", 1.0, {"angle": 1.0}, (0.1, 0.0, 0.2, 1.0))
    clip = clip.key("edit", 0.5, {"controls": stack["edit"].deformer.controls})
    return pl.Scene(MESH, stack, clip, {"top": HANDLE, "nothing": []})


def same_arrays(one, two):
    return np.array_equal(np.asarray(one), np.asarray(two))


def test_everything_comes_back(tmp_path):
    scene, path = full_scene(), tmp_path / "scene.pliant"
    pl.save_project(scene, path)
    again = pl.load_project(path)
    assert same_arrays(again.mesh.points, MESH.points)
    assert same_arrays(again.mesh.faces.flat, MESH.faces.flat)
    assert again.stack.mode == "compose"
    for one, two in zip(again.stack, scene.stack, strict=True):
        assert one.content == two.content
        assert (one.name, one.muted, one.solo, one.invert) == (two.name, two.muted, two.solo, two.invert)
    assert {name: ids.tolist() for name, ids in again.selections.items()} == {"top": HANDLE.tolist(), "nothing": []}
    assert same_arrays(again.deformed().points, scene.deformed().points)
    for moment in (0.0, 0.3, 2.7):
        assert same_arrays(again.clip.sample(moment).points, scene.clip.sample(moment).points)


def test_every_deformer_survives(tmp_path):
    layers = [pl.Layer(name, deformer, muted=True) for name, deformer in every_deformer().items()]
    pl.save_project(pl.Scene(MESH, pl.Stack(layers)), tmp_path / "all.pliant")
    for one, two in zip(pl.load_project(tmp_path / "all.pliant").stack, layers, strict=True):
        assert one.content == two.content


def test_all_that_rides_on_a_mesh_comes_back(tmp_path, box_mesh):
    texture = tmp_path / "pictures" / "skin.png"
    texture.parent.mkdir()
    texture.write_bytes(b"picture")
    mesh = box_mesh.replace(
        materials=FaceLabels(("skin",), np.zeros(len(box_mesh.faces), int)),
        material_library={"skin": Material("skin", (0.1, 0.2, 0.3), texture, (("Kd", "1 2 3"),))},
        vertex_attributes={"weight": np.arange(len(box_mesh.points), dtype=np.float32), "word": np.full(150, "é")},
        lines=[[0, 1, 2], [3, 4]],
    )
    pl.save_project(pl.Scene(mesh), tmp_path / "scene.pliant")
    again = pl.load_project(tmp_path / "scene.pliant").mesh
    assert same_arrays(again.uvs.values, mesh.uvs.values)
    assert same_arrays(again.normals.indices, mesh.normals.indices)
    assert again.groups.names == mesh.groups.names
    assert again.material_library["skin"] == mesh.material_library["skin"]
    assert [row.tolist() for row in again.lines] == [[0, 1, 2], [3, 4]]
    assert same_arrays(again.vertex_attributes["word"], mesh.vertex_attributes["word"])
    assert again.vertex_attributes["weight"].dtype == np.float32


def test_a_texture_elsewhere_travels_along(tmp_path):
    library = {"skin": Material("skin", texture=tmp_path / "skin.png")}
    (tmp_path / "skin.png").write_bytes(b"picture")
    (tmp_path / "projects").mkdir()
    pl.save_project(pl.Scene(MESH.replace(material_library=library)), tmp_path / "projects" / "scene.pliant")
    (tmp_path / "skin.png").unlink()
    again = pl.load_project(tmp_path / "projects" / "scene.pliant")
    assert again.mesh.material_library["skin"].texture.read_bytes() == b"picture"
    pl.save_project(again, tmp_path / "moved.pliant")
    assert pl.load_project(tmp_path / "moved.pliant").mesh.material_library["skin"].texture.suffix == ".png"


@pytest.mark.parametrize("entry", [{"ending": ".sh", "array": "pictures/0"}, {"ending": ".png", "array": "none"}, 7])
def test_pictures_that_are_none_are_refused(tmp_path, entry):
    from pliant.scene.pictures import unpacked

    library = {"skin": Material("skin")}
    with pytest.raises(InvalidParameter, match="picture of the material 'skin' is none"):
        unpacked(MESH.replace(material_library=library), {"skin": entry}, {"pictures/0": np.zeros(3, np.uint8)})


def test_a_texture_that_is_gone_is_left_out_and_told(tmp_path):
    library = {"skin": Material("skin", texture=tmp_path / "skin.png")}
    (tmp_path / "projects").mkdir()
    with pytest.warns(PliantWarning, match="texture of 'skin' is left out.*nothing outside"):
        pl.save_project(pl.Scene(MESH.replace(material_library=library)), tmp_path / "projects" / "scene.pliant")
    assert pl.load_project(tmp_path / "projects" / "scene.pliant").mesh.material_library["skin"].texture is None


def test_equal_arrays_are_stored_once(tmp_path):
    layers = [pl.Layer(str(i), lattice(), mask=MASK.copy()) for i in range(5)]
    pl.save_project(pl.Scene(MESH, pl.Stack(layers[:1])), tmp_path / "one.pliant")
    pl.save_project(pl.Scene(MESH, pl.Stack(layers)), tmp_path / "five.pliant")
    with zipfile.ZipFile(tmp_path / "one.pliant") as one, zipfile.ZipFile(tmp_path / "five.pliant") as five:
        assert len(one.namelist()) == len(five.namelist())


def test_a_mesh_can_stay_in_a_file_of_its_own(tmp_path):
    pl.write(MESH, tmp_path / "tube.obj")
    mesh = pl.read(tmp_path / "tube.obj")
    pl.save_project(pl.Scene(mesh, space_stack()), tmp_path / "scene.pliant", embed=False)
    assert (tmp_path / "scene.pliant").stat().st_size < 40_000
    again = pl.load_project(tmp_path / "scene.pliant")
    assert same_arrays(again.mesh.points, mesh.points)
    assert again.mesh.carrier is not None  # it is written back as it was
    (tmp_path / "tube.obj").write_text((tmp_path / "tube.obj").read_text() + "# changed\n")
    with pytest.raises(UnreadableFile, match=r"its mesh .*tube.obj has changed since.*pass the mesh"):
        pl.load_project(tmp_path / "scene.pliant")
    (tmp_path / "tube.obj").unlink()
    with pytest.raises(UnreadableFile, match=r"its mesh .*tube.obj is missing.*pass the mesh"):
        pl.load_project(tmp_path / "scene.pliant")
    assert pl.load_project(tmp_path / "scene.pliant", mesh=MESH).stack.names == space_stack().names


def test_a_mesh_that_cannot_be_referred_to_is_told(tmp_path):
    pl.write(MESH, tmp_path / "tube.obj")
    mesh = pl.read(tmp_path / "tube.obj")
    with pytest.raises(InvalidParameter, match="was not read from a file"):
        pl.save_project(pl.Scene(MESH), tmp_path / "a.pliant", embed=False)
    with pytest.raises(InvalidParameter, match="no longer holds this mesh"):
        pl.save_project(pl.Scene(mesh.with_points(mesh.points + 1)), tmp_path / "a.pliant", embed=False)
    with pytest.raises(InvalidParameter, match="does not lie in the project's folder"):
        pl.save_project(pl.Scene(mesh), tmp_path / "below" / "a.pliant", embed=False)


def test_what_no_file_can_hold_is_told_with_its_layer(tmp_path):
    profile = pl.Profile(lambda t: t, lambda t: 1 + 0 * t)
    stack = pl.Stack([pl.Layer("bend", pl.Twist(angle=1.0, profile=profile))])
    with pytest.raises(InvalidParameter, match=r"layer 'bend' cannot be stored: profile/value is a Python function"):
        pl.save_project(pl.Scene(MESH, stack), tmp_path / "a.pliant")
    endless: list = []
    endless.append(endless)
    twist = pl.Twist(angle=1.0)
    object.__setattr__(twist, "profile", endless)
    with pytest.raises(InvalidParameter, match="contains itself"):
        pl.save_project(pl.Scene(MESH, pl.Stack([pl.Layer("round", twist)])), tmp_path / "a.pliant")
    assert not list(tmp_path.iterdir())


SAVE_FOR_EVER = """
import sys
import numpy as np
import pliant as pl
mesh = pl.PolygonMesh(np.random.default_rng(0).normal(size=(20_000, 3)))
scenes = [pl.Scene(mesh, pl.Stack([pl.Layer("move", pl.Affine.translation([i, 0, 0]))])) for i in (1, 2)]
while True:
    for scene in scenes:
        pl.save_project(scene, sys.argv[1])
        print("saved", flush=True)
"""


def test_killed_at_any_moment_of_saving_the_file_is_whole(tmp_path):
    path, random = tmp_path / "scene.pliant", np.random.default_rng(8)
    for _ in range(4):
        saver = subprocess.Popen([sys.executable, "-c", SAVE_FOR_EVER, path], stdout=subprocess.PIPE)
        assert saver.stdout.readline() == b"saved\n"
        time.sleep(random.uniform(0.0, 0.08))
        saver.send_signal(signal.SIGKILL)
        saver.wait()
        saver.stdout.close()
        scene = pl.load_project(path)
        assert len(scene.mesh.points) == 20_000
        assert scene.stack["move"].deformer.offset[0] in (1.0, 2.0)


FILL_THE_DISK = """
import resource, signal, sys
import numpy as np
import pliant as pl
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    pl.save_project(pl.Scene(pl.PolygonMesh(np.ones((20_000, 3)))), sys.argv[1])
except pl.PliantError as error:
    print(type(error).__name__, error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX's")
def test_where_no_more_can_be_written_the_old_file_stays(tmp_path):
    path = tmp_path / "scene.pliant"
    pl.save_project(pl.Scene(MESH, space_stack()), path)
    before = path.read_bytes()
    done = subprocess.run([sys.executable, "-c", FILL_THE_DISK, path], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("UnwritableFile")
    assert "could not be written: File too large" in done.stdout
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_place_that_cannot_be_written_to_is_told(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(UnwritableFile, match="could not be written"):
        pl.save_project(pl.Scene(MESH), tmp_path / "file" / "scene.pliant")


@pytest.fixture
def saved(tmp_path):
    pl.save_project(full_scene(), tmp_path / "scene.pliant")
    return tmp_path / "scene.pliant"


def rewritten(path, change=None, arrays=None, extra=()):
    """The project with its manifest changed, some arrays exchanged, and entries added."""
    with zipfile.ZipFile(path) as old:
        entries = {name: old.read(name) for name in old.namelist()}
    manifest = orjson.loads(entries["manifest.json"])
    if change is not None:
        manifest = change(manifest)
    entries["manifest.json"] = manifest if isinstance(manifest, bytes) else orjson.dumps(manifest)
    entries.update(arrays or {})
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for name, data in [*entries.items(), *extra]:
            new.writestr(name, data)


def npy(array=None, header=None):
    stream = BytesIO()
    if header is None:
        np.lib.format.write_array(stream, array, allow_pickle=True)
    else:
        np.lib.format.write_array_header_1_0(stream, header)
        stream.write(b"\0" * 64)
    return stream.getvalue()


def without(*names):
    return lambda manifest: {name: value for name, value in manifest.items() if name not in names}


def layer(**changes):
    def change(manifest):
        manifest["stack"]["layers"][0].update(changes)
        return manifest

    return change


def clip(**changes):
    return lambda manifest: {**manifest, "clip": {**manifest["clip"], **changes}}


KEYS = [{"time": 1.0, "value": 0.0}, {"time": 0.5, "value": 1.0}]
HOSTILE = {
    "a newer version": (lambda m: {**m, "version": 99}, "a newer pliant wrote it .format 99.*update pliant"),
    "no version": (without("version"), "its version is None"),
    "a version that is a word": (lambda m: {**m, "version": "2"}, "its version is '2'"),
    "another program's file": (lambda m: {**m, "format": "epub"}, "it is a 'epub', not a 'pliant project'"),
    "no JSON": (lambda m: b"{", "its manifest is no JSON"),
    "a list": (lambda m: b"[]", "no object of names and values"),
    "deep nesting": (lambda m: b'{"a":' + b"[" * 900 + b"]" * 900 + b"}", "it is a None"),
    "deep nesting of a mesh": (
        lambda m: orjson.dumps(m).replace(b'"mesh":', b'"mesh":' + b"[" * 900 + b"]" * 900 + b',"was":', 1),
        "it holds no mesh|nested too deeply|no JSON",
    ),
    "no mesh": (without("mesh"), "it holds no mesh"),
    "no stack": (without("stack"), "a stack has a mode"),
    "no selections": (without("selections"), "its selections are no names"),
    "an unknown kind": (layer(kind="warp-drive"), "layer 'warp': there is no kind of deformer 'warp-drive'"),
    "an unknown field": (layer(fields={"colour": 1}), "layer 'warp': a BSplineFFD has no field 'colour'"),
    "an unknown entry": (layer(code="import os"), "layer 'warp' has an unknown entry 'code'"),
    "a layer without a name": (layer(name=None), "layer 0 has no name"),
    "two layers of one name": (layer(name="twist"), "two layers are called 'twist'"),
    "an envelope that is a word": (layer(envelope="all"), "envelope of layer 'warp' is 'all'"),
    "an array that is missing": (lambda m: {**m, "arrays": {}}, "the array 'mesh/points' is missing"),
    "an array in no file": (
        lambda m: {**m, "arrays": {**m["arrays"], "mesh/points": {"file": "arrays/999.npy"}}},
        "'mesh/points' should be in 'arrays/999.npy', which is not there",
    ),
    "an array in the manifest": (
        lambda m: {**m, "arrays": {**m["arrays"], "mesh/points": {"file": "manifest.json"}}},
        "should be in 'manifest.json'",
    ),
    "a mesh elsewhere": (lambda m: {**m, "mesh": {"file": "../../etc/passwd"}}, "refers to nothing outside it"),
    "a mesh at the root": (lambda m: {**m, "mesh": {"file": "/etc/passwd"}}, "refers to nothing outside it"),
    "a mesh on a drive": (lambda m: {**m, "mesh": {"file": "C:\\x.obj"}}, "refers to nothing outside it"),
    "a record that is none of ours": (lambda m: {**m, "mesh": {"record": "Popen", "fields": {}}}, "no record 'Popen'"),
    "a record that is no mesh": (
        lambda m: {**m, "mesh": {"record": "Material", "fields": {"name": "x"}}},
        "it holds no mesh",
    ),
    "keys out of order": (
        clip(tracks=[{"layer": "twist", "field": "angle", "keys": KEYS}]),
        "keys of 'angle' of layer 'twist' are out of order: one at 1 s comes before one at 0.5 s",
    ),
    "a track without keys": (clip(tracks=[{"layer": "twist", "field": "angle", "keys": []}]), "has no keys"),
    "a key of a layer that is gone": (
        clip(tracks=[{"layer": "gone", "field": "angle", "keys": KEYS[:1]}]),
        "no layer 'gone'",
    ),
    "a track that says nothing": (clip(tracks=[{}]), "the clip is not understood"),
    "an empty clip": (clip(duration=0), "the clip is empty: its duration is 0"),
    "a clip that is a number": (lambda m: {**m, "clip": 3}, "the clip is no names and values"),
    "a selection of vertices that are not there": (
        lambda m: {**m, "selections": {"top": {"array": "mesh/faces/offsets"}}},
        "selection 'top' holds vertex",
    ),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_manifests_are_refused_by_cause(case, saved):
    change, cause = HOSTILE[case]
    rewritten(saved, change)
    before = saved.read_bytes()
    with pytest.raises(UnreadableFile, match=cause):
        pl.load_project(saved)
    assert saved.read_bytes() == before


ENTRIES = {
    "a path upwards": (("../evil.txt", b"x"), "'../evil.txt', which is no part of a project"),
    "a path from the root": (("/etc/cron.d/evil", b"x"), "no part of a project"),
    "a script": (("run.py", b"x"), "no part of a project"),
    "a bomb": (("arrays/999.npy", bytes(20_000_000)), "bytes of arrays/999.npy inflate to 20,000,000"),
}


@pytest.mark.parametrize("case", ENTRIES)
def test_hostile_entries_are_refused(case, saved):
    entry, cause = ENTRIES[case]
    rewritten(saved, extra=[entry])
    with pytest.raises(UnreadableFile, match=cause):
        pl.load_project(saved)


def test_an_entry_twice_is_refused(saved):
    with pytest.warns(UserWarning, match="Duplicate name"):
        rewritten(saved, extra=[("arrays/0.npy", b"x")])
    with pytest.raises(UnreadableFile, match=r"it holds 'arrays/0.npy' twice"):
        pl.load_project(saved)


ARRAYS = {
    "a pickle": (npy(np.array([print], dtype=object)), "only plain arrays of numbers"),
    "an absurd shape": (npy(header={"descr": "<f8", "fortran_order": False, "shape": (10**12, 3)}), "claims shape"),
    "a shape whose size overflows": (
        npy(header={"descr": "<f8", "fortran_order": False, "shape": (2**40, 2**40)}),
        "claims shape",
    ),
    "a negative shape": (npy(header={"descr": "<f8", "fortran_order": False, "shape": (-8,)}), "only plain arrays"),
    "records": (npy(np.zeros(3, [("a", "f8")])), "only plain arrays of numbers"),
    "no array": (b"text", "is no .npy file"),
    "code for a header": (b"\x93NUMPY\x01\x00\x20\x00__import__('os').system('true')  ", "is no .npy file"),
    "another array": (npy(np.zeros((160, 3))), "its hash is another one"),
}


@pytest.mark.parametrize("case", ARRAYS)
def test_hostile_arrays_are_refused(case, saved):
    data, cause = ARRAYS[case]
    rewritten(saved, arrays={"arrays/0.npy": data})
    with pytest.raises(UnreadableFile, match=cause):
        pl.load_project(saved)


def test_damage_anywhere_is_noticed(saved):
    data, random = saved.read_bytes(), np.random.default_rng(2)
    for at in random.integers(0, len(data), 60):
        damaged = bytearray(data)
        damaged[at] ^= 0xFF
        saved.write_bytes(bytes(damaged))
        try:
            scene = pl.load_project(saved)
        except UnreadableFile:
            continue
        assert same_arrays(scene.deformed().points, full_scene().deformed().points)  # a byte that means nothing
    for length in (0, 10, len(data) // 2, len(data) - 1):
        saved.write_bytes(data[:length])
        with pytest.raises(UnreadableFile):
            pl.load_project(saved)
    with pytest.raises(UnreadableFile, match="No such file"):
        pl.load_project(saved.with_name("none.pliant"))


def test_files_of_version_one_are_opened(saved):
    """They knew no time."""

    def as_it_was(manifest):
        return {**without("clip")(manifest), "version": 1}

    rewritten(saved, as_it_was)
    scene = pl.load_project(saved)
    assert scene.clip is None
    assert same_arrays(scene.deformed().points, full_scene().deformed().points)
