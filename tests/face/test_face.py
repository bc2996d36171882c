"""The mesh: its topology, its frame, and that it wears what the photograph shows at its landmarks."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import pliant as pl
from pliant.errors import PliantError
from pliant.face.pose import STABLE, pose_of, to_face, to_photograph
from pliant.face.topology import WIDTH, boundary_loops, mean_face, mirrored, openings, opposite
from pliant.shape.procrustes import align

TOOL = Path(__file__).parents[2] / "tools" / "mean_face.py"


def test_the_mean_face_is_a_manifold_with_open_eyes_and_mouth():
    mesh = mean_face()
    assert (len(mesh.points), len(mesh.faces)) == (468, 852)
    assert mesh.edge_use == (36 + 16 + 16 + 20, 0)
    assert len(mesh.points) - len(mesh.edges) + len(mesh.faces) == 2 - 4  # a sphere with four holes
    assert sorted(map(len, boundary_loops(mesh.triangles))) == [16, 16, 20, 36]
    assert [len(loop) for loop in openings()] == [16, 16, 20]
    assert (mesh.vertex_normals[openings()[2]][:, 2] > -0.7).all()
    assert (mesh.vertex_normals[:, 2] > 0).mean() > 0.95  # it looks at the viewer


def test_the_mean_face_is_symmetric():
    mesh = mean_face()
    assert np.array_equal(opposite()[opposite()], np.arange(468))
    assert np.array_equal(mirrored(mesh.points), mesh.points)
    own = {frozenset(t) for t in mesh.triangles.tolist()}
    assert {frozenset(opposite()[list(t)].tolist()) for t in own} == own
    assert np.ptp(mesh.points[:, 0]) == pytest.approx(WIDTH, abs=1e-4)
    assert mesh.points[10, 2] == pytest.approx(mesh.points[152, 2], abs=1e-4)  # upright


def test_the_mean_face_is_what_its_script_makes():
    spec = importlib.util.spec_from_file_location("tool_mean_face", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    points, triangles, pairs = tool.made()
    assert np.abs(points - mean_face().points).max() < 0.02  # processors round differently
    assert np.array_equal(pairs, opposite())
    assert len(triangles) == 852


def test_the_pose_is_undone(found):
    matrix = pl.Affine.rotation([1, 2, 0.5], 0.4).matrix
    shifted = 3.0 * found.points @ matrix[:3, :3].T + [40, 50, 60]
    posed, other = to_face(pose_of(found.points), found.points), to_face(pose_of(shifted), shifted)
    assert np.allclose(posed, other, atol=1e-9)
    back = to_photograph(pose_of(found.points), posed)
    assert np.allclose(back, found.points, atol=1e-9)
    apart = align(posed[list(STABLE)], mean_face().points[list(STABLE)], scale=True) - np.eye(4)
    assert np.abs(apart).max() < 1e-9  # nothing is left to align


def test_texture_coordinates_lead_to_the_landmarks(face, found, portrait):
    uvs, picture = face.mesh.uvs.values, face.picture
    places = picture.low + np.column_stack([uvs[:, 0], 1 - uvs[:, 1]]) * (picture.high - picture.low)
    assert np.allclose(places, found.points[:, :2], atol=1e-9)
    piece = portrait.crop(tuple(int(v) for v in (*picture.low, *picture.high)))
    again = Image.fromarray(picture.pixels).resize(piece.size, Image.Resampling.LANCZOS)
    assert np.abs(np.asarray(again, float) - np.asarray(piece, float)).mean() < 4


def test_obj_holds_mesh_groups_and_picture(face, tmp_path):
    report = face.write(tmp_path / "my face.obj")
    assert not report.losses
    assert sorted(path.name for path in tmp_path.iterdir()) == ["my face.obj", "my_face.mtl", "my_face.png"]
    again = pl.read(tmp_path / "my face.obj")
    assert np.allclose(again.points, face.mesh.points, atol=1e-12)
    assert np.array_equal(again.triangles, face.mesh.triangles)
    assert np.allclose(again.uvs.per_corner, face.mesh.uvs.per_corner, atol=1e-12)
    assert set(again.groups.names) == set(face.mesh.groups.names)
    with Image.open(again.material_library["skin"].texture) as stored:
        assert np.array_equal(np.asarray(stored), face.picture.pixels)


def test_glb_holds_everything_in_one_file(face, tmp_path):
    face.write(tmp_path / "face.glb")
    assert [path.name for path in tmp_path.iterdir()] == ["face.glb"]
    again = pl.read(tmp_path / "face.glb")
    assert np.allclose(again.points[again.triangles], face.mesh.points[face.mesh.triangles], atol=1e-5)
    assert b"\x89PNG" in (tmp_path / "face.glb").read_bytes()


def test_nothing_is_left_where_writing_fails(face, tmp_path):
    with pytest.raises(PliantError):
        face.write(tmp_path / "face.docx")
    assert not list(tmp_path.iterdir())


def test_groups_are_where_the_features_are(face):
    middle = face.mesh.points[face.mesh.triangles].mean(axis=1)
    nose, chin, brows, eyes = (middle[face.mesh.groups.faces(name)] for name in ("nose", "chin", "brows", "eyes"))
    assert brows[:, 1].mean() > eyes[:, 1].mean() > nose[:, 1].mean() > chin[:, 1].mean()
    assert nose[:, 2].mean() > eyes[:, 2].mean()
    assert (face.mesh.groups.indices >= 0).all()


def test_filled_only_the_outline_is_open(face):
    whole = face.filled()
    assert whole.mesh.edge_use == (36, 0)
    assert len(whole.mesh.faces) == 852 + 3
    assert np.array_equal(whole.mesh.points, face.mesh.points)
    added = [set(whole.mesh.faces[at].tolist()) for at in range(852, 855)]
    assert all(set(loop.tolist()) in added for loop in openings())
    assert [whole.mesh.groups.names[i] for i in whole.mesh.groups.indices[-3:]] == ["eyes", "eyes", "mouth"]


def test_the_face_asked_for_is_given_or_counted(portrait, face):
    pixels = np.hstack([np.asarray(portrait), np.asarray(portrait.resize((300, 512)))])
    assert len(pl.faces_from_photo(pixels)) == 2
    assert pl.face_from_photo(pixels, 1).picture.low[0] > 512
    with pytest.raises(pl.NoFace, match="there is no face 2: 2 faces are found"):
        pl.face_from_photo(pixels, 2)
    with pytest.raises(pl.NoFace, match="one face is found"):
        pl.face_from_photo(np.asarray(portrait), 1)
