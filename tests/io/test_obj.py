"""OBJ: everything that its faces can say, and writing back the very same file."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import PliantWarning, UnreadableFile
from pliant.io.meshes import read_mesh_bytes
from pliant.mesh import CornerValues, FaceLabels, PolygonMesh

CUBE = b"""# exported by hand
mtllib my materials.mtl
o cube
v 0.000 0.000 0.000
v 1.000 0.000 0.000 # a corner
v 1.000 1.000 0.000
v 0.000 1.000 0.000
v 0.5 0.5 1e0

vt 0 0
vt 1 0
vt 1 1
vn 0 0 -1
vn 0 1 0
g base
usemtl \xba\xec\xc9\xab
s 1
f 1/1/1 4/2/1 3/3/1 2/1/1
g sides
f 1//2 2//2 5//2
f 2/1 3/2 5/3
f 3 4 5
"""


def read(text, name="mesh.obj"):
    return read_mesh_bytes(text, name)


@pytest.fixture
def cube(tmp_path):
    (tmp_path / "my materials.mtl").write_bytes(
        b"newmtl \xba\xec\xc9\xab\nKd 0.5 0.25 1\nmap_Kd -s 1 1 1 -clamp on wood grain.png\nmap_bump -bm 0.5 bump.png\n"
    )
    (tmp_path / "wood grain.png").write_bytes(b"picture")
    (tmp_path / "bump.png").write_bytes(b"bumps")
    path = tmp_path / "cube.obj"
    path.write_bytes(CUBE)
    return path


def test_faces_keep_polygons_corners_and_names(cube):
    mesh = pl.read(cube)
    assert [row.tolist() for row in mesh.faces] == [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4]]
    assert mesh.uvs.indices.tolist() == [0, 1, 2, 0, -1, -1, -1, 0, 1, 2, -1, -1, -1]
    assert mesh.normals.indices.tolist() == [0, 0, 0, 0, 1, 1, 1, -1, -1, -1, -1, -1, -1]
    assert mesh.groups.names == ("base", "sides")
    assert mesh.groups.indices.tolist() == [0, 1, 1, 1]
    assert mesh.objects.names == ("cube",)
    assert mesh.face_attributes["smoothing"].tolist() == [1, 1, 1, 1]
    name = mesh.materials.names[0]
    assert name.encode("utf-8", "surrogateescape") == b"\xba\xec\xc9\xab"
    material = mesh.material_library[name]
    assert material.color == (0.5, 0.25, 1.0)
    assert material.texture == cube.with_name("wood grain.png")
    assert mesh.source == cube


def test_writing_back_the_same_points_gives_the_same_bytes(cube, tmp_path):
    mesh = pl.read(cube)
    report = pl.write(mesh, tmp_path / "elsewhere" / "cube.obj", strict=True)
    assert (tmp_path / "elsewhere" / "cube.obj").read_bytes() == CUBE
    assert not report.losses
    for name in ("my materials.mtl", "wood grain.png", "bump.png"):
        assert (tmp_path / "elsewhere" / name).read_bytes() == (tmp_path / name).read_bytes()
    again = pl.read(tmp_path / "elsewhere" / "cube.obj")
    assert next(iter(again.material_library.values())).texture.parent == tmp_path / "elsewhere"


def test_only_moved_vertices_change_their_text(cube, tmp_path):
    mesh = pl.read(cube)
    points = mesh.points.copy()
    points[1, 2] = 0.1
    pl.write(mesh.with_points(points), tmp_path / "moved.obj")
    expected = CUBE.replace(b"v 1.000 0.000 0.000 # a corner", b"v 1.000 0.000 0.1 # a corner")
    assert (tmp_path / "moved.obj").read_bytes() == expected


def test_normals_that_keep_their_layout_are_patched(cube, tmp_path):
    mesh = pl.read(cube)
    turned = CornerValues(mesh.normals.values[:, [0, 2, 1]], mesh.normals.indices)
    pl.write(mesh.with_points(mesh.points, normals=turned), tmp_path / "turned.obj")
    assert (tmp_path / "turned.obj").read_bytes() == CUBE.replace(b"vn 0 0 -1", b"vn 0 -1.0 0.0").replace(
        b"vn 0 1 0", b"vn 0 0.0 1.0"
    )


def test_normals_in_a_larger_pool_change_vn_lines_and_normal_indices_only(cube, tmp_path):
    mesh = pl.read(cube)
    random = np.random.default_rng(1)
    used = mesh.normals.indices >= 0
    indices = np.full(len(used), -1)
    indices[used] = np.arange(used.sum())
    grown = CornerValues(random.normal(size=(used.sum(), 3)), indices)
    pl.write(mesh.with_points(mesh.points * 2, normals=grown), tmp_path / "grown.obj")
    again = pl.read(tmp_path / "grown.obj")
    assert np.array_equal(again.normals.values, grown.values)
    assert np.array_equal(again.normals.indices, indices)
    assert np.array_equal(again.points, mesh.points * 2)
    assert np.array_equal(again.uvs.indices, mesh.uvs.indices)
    kept = [line for line in CUBE.splitlines() if not line.startswith((b"v ", b"vn", b"f"))]
    now = [
        line for line in (tmp_path / "grown.obj").read_bytes().splitlines() if not line.startswith((b"v ", b"vn", b"f"))
    ]
    assert now == kept


def test_a_mesh_with_other_faces_is_written_anew(cube, tmp_path):
    mesh = pl.read(cube)
    cut = pl.PolygonMesh(mesh.points, mesh.faces[1:], carrier=mesh.carrier)
    pl.write(cut, tmp_path / "cut.obj")
    assert [row.tolist() for row in pl.read(tmp_path / "cut.obj").faces] == [[0, 1, 4], [1, 2, 4], [2, 3, 4]]


def test_a_library_of_another_model_is_not_overwritten(cube, tmp_path):
    place = tmp_path / "shared"
    place.mkdir()
    (place / "my materials.mtl").write_bytes(b"newmtl somebody else's\n")
    pl.write(pl.read(cube), place / "cube.obj")
    assert (place / "my materials.mtl").read_bytes() == b"newmtl somebody else's\n"
    assert next(iter(pl.read(place / "cube.obj").material_library.values())).color == (0.5, 0.25, 1.0)


def test_pictures_outside_the_folder_come_along(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "picture.png").write_bytes(b"picture")
    (tmp_path / "in" / "a.mtl").write_bytes(b"newmtl m\nmap_Kd ../picture.png\n")
    (tmp_path / "in" / "a.obj").write_bytes(b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    pl.write(pl.read(tmp_path / "in" / "a.obj"), tmp_path / "out" / "deep" / "a.obj")
    texture = pl.read(tmp_path / "out" / "deep" / "a.obj").material_library["m"].texture
    assert texture == tmp_path / "out" / "deep" / "picture.png"
    assert texture.read_bytes() == b"picture"


def test_a_missing_library_is_a_warning():
    with pytest.warns(PliantWarning, match="'gone.mtl' is not there"):
        mesh = read(b"mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    assert mesh.materials.names == ("red",)


def test_negative_indices_count_back_from_where_they_stand():
    text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf -3/-1 -2/-1 -1/-1\nv 5 5 5\nvt 1 1\nf -1/-1 -2/-2 1/1\n"
    mesh = read(text)
    assert mesh.faces.flat.tolist() == [0, 1, 2, 3, 2, 0]
    assert mesh.uvs.indices.tolist() == [0, 0, 0, 1, 0, 0]


def test_vertices_may_have_colors_or_weights_and_lines_are_kept():
    mesh = read(b"v 0 0 0 1 0 0\nv 1 0 0 0 .5 0\nv 0 1 0 0 0 1\nf 1 2 3\nl 1 2 3\nl 3 1\np 2\n")
    assert mesh.vertex_attributes["colors"].tolist() == [[1, 0, 0], [0, 0.5, 0], [0, 0, 1]]
    assert [row.tolist() for row in mesh.lines] == [[0, 1, 2], [2, 0]]
    assert read(b"v 0 0 0 2\nv 1 0 0\n").vertex_attributes["weights"].tolist() == [2, 1]


def test_points_that_are_elements_are_told_of_when_lost(tmp_path):
    mesh = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\np 2\n")
    assert not pl.write(mesh, tmp_path / "same.obj").losses
    assert any("no polygons" in loss for loss in pl.write(mesh, tmp_path / "other.ply").losses)


@pytest.mark.parametrize(
    ("text", "line", "cause"),
    [
        (b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", 3, "uses vertex 3; the file has 2"),
        (b"v 0 0 0\n\nf 0 1 1\n", 3, "is no corner"),
        (b"v 0 0 0\nf 1 1 -2\n", 2, "uses vertex -2"),
        (b"v 0 0 0\nv 1 0\n", 2, "2 numbers"),
        (b"v 0 0 0\nv nan 0 0\n", 2, "not a finite number"),
        (b"v 0 0 0\nvt 0 0\nf 1/2 1/1 1/1\n", 3, "uses texture coordinate 2; the file has 1"),
        (b"v 0 0 0\nf 1//1 1 1\n", 2, "uses normal 1; the file has 0"),
        (b"v 0 0 0\nf 1 x 1\n", 2, "'x'"),
        (b"v 0 0 0\nf 1 99999999999 1\n", 2, "is no corner"),
        (b"v 0 0 0\nf\n", 2, "0 numbers"),
        (b"# nothing\ng a\n", None, "no vertex"),
        (b"v 0 0 0\nv 1 \0 0\n", 2, "zero byte"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text, line, cause):
    with pytest.raises(UnreadableFile, match=cause) as caught:
        read(text)
    assert caught.value.line == line
    assert "mesh.obj" in str(caught.value)


def test_a_statement_that_obj_does_not_have_is_a_warning():
    with pytest.warns(PliantWarning, match="'vv' in line 2"):
        assert len(read(b"v 0 0 0\nvv 1 2 3\n").points) == 1


def test_a_deformed_mesh_keeps_its_file_but_for_positions_and_normals(cube, tmp_path):
    mesh = pl.read(cube)
    lattice = pl.BezierFFD.around(mesh, shape=(3, 3, 3))
    controls = lattice.rest.copy()
    controls[1, 1, 2] += [0.3, -0.2, 0.4]
    bent = lattice.moved(controls)(mesh)
    pl.write(bent, tmp_path / "bent.obj", strict=True)
    again = pl.read(tmp_path / "bent.obj")
    assert np.array_equal(again.points, bent.points)
    assert np.array_equal(again.normals.per_corner, bent.normals.per_corner, equal_nan=True)
    kept = [line for line in CUBE.splitlines() if not line.startswith((b"v ", b"vn", b"f"))]
    now = [
        line for line in (tmp_path / "bent.obj").read_bytes().splitlines() if not line.startswith((b"v ", b"vn", b"f"))
    ]
    assert now == kept


def test_names_that_no_line_can_say_are_told_of(tmp_path):
    labels = FaceLabels(("two\nlines", "back\\"), [0, 1])
    mesh = PolygonMesh(np.eye(3), [[0, 1, 2], [2, 1, 0]], groups=labels)
    losses = pl.write(mesh, tmp_path / "a.obj").losses
    assert losses == (r"the name 'two\nlines' is written as 'two lines'", r"the name 'back\\' is written as 'back_'")
    again = pl.read(tmp_path / "a.obj")
    assert again.groups.names == ("two lines", "back_")
    assert again.faces.flat.tolist() == mesh.faces.flat.tolist()


def test_points_and_the_coordinates_of_lines_are_lost_elsewhere(tmp_path):
    text = b"v 0 0 0\nv 1 0 0\nvt 0 0\nvt 1 1\nl 1/1 2/2\np 1 2\n"
    (tmp_path / "a.obj").write_bytes(text)
    mesh = pl.read(tmp_path / "a.obj")
    assert not pl.write(mesh, tmp_path / "b.obj").losses
    losses = pl.write(mesh, tmp_path / "b.ply").losses
    assert "2 texture coordinates of lines" in losses
    assert "1 points, curves or surfaces that are no polygons" in losses
