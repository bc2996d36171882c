"""Pictures are measured: where things are in them, how large, and of which colour."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest
from PIL import Image

from pliant.deformer import Binding, SpaceDeformer
from pliant.errors import InvalidMesh, InvalidParameter, MissingExtra, NoGraphics, UnreadableFile, UnsupportedFormat
from pliant.mesh import CornerValues, PolygonMesh, as_points
from pliant.rendering import window
from pliant.rendering.pictures import render

SIZE = (160, 120)


def globe(count: int = 48) -> PolygonMesh:
    """A sphere of radius 1 as a cut-open cylinder of quadrangles, with its equirectangular texture coordinates."""
    v, u = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, 1, 2 * count), indexing="ij")
    height, turn = np.pi * (v - 0.5), 2 * np.pi * u
    points = np.stack([np.cos(height) * np.cos(turn), np.cos(height) * np.sin(turn), np.sin(height)], axis=-1)
    at = np.arange(v.size).reshape(v.shape)
    quads = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    uvs = CornerValues(np.stack([u, v], axis=-1).reshape(-1, 2), quads.reshape(-1))
    return PolygonMesh(points.reshape(-1, 3), quads, uvs=uvs)


def square(**parts) -> PolygonMesh:
    """The unit square in the xz plane, facing the viewer of the front view."""
    return PolygonMesh([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 2, 3]], **parts)


class Known(Binding):
    points = rest = controls = np.zeros((1, 3))

    def __init__(self, points, answer):
        self.points, self.answer = points, answer

    def deform(self, controls=None, out=None):
        return self.answer.copy()

    def jvp(self, controls, d_controls):
        return np.zeros_like(self.points)

    def vjp(self, controls, d_points):
        return np.zeros((1, 3))


@dataclass(frozen=True, eq=False)
class Shear(SpaceDeformer):
    """x goes by ``step`` z; its controls are a lattice that follows."""

    step: float = 0.5
    corners: int = 8  # how many of the lattice's corners follow

    @property
    def rest(self):
        return np.stack(np.meshgrid([-1.2, 1.2], [-1.2, 1.2], [-1.2, 1.2], indexing="ij"), axis=-1)

    @property
    def controls(self):
        followers = (np.arange(8) < self.corners).reshape(2, 2, 2, 1)
        return self.rest + followers * self.step * self.rest[..., 2:] * [1, 0, 0]

    def moved(self, controls):
        return replace(self)

    def bind(self, target):
        points = as_points(target)
        return Known(points, points + self.step * points[:, 2:] * [1, 0, 0])

    def jacobian(self, points):
        return np.broadcast_to([[1, 0, self.step], [0, 1, 0], [0, 0, 1.0]], (len(as_points(points)), 3, 3))


TOOLS = (Shear(0.0), Shear(0.5, corners=3), Shear(0.5))


def test_a_globe_fills_the_height_but_for_the_margins():
    alpha = render(globe(), size=SIZE, view="front", background="transparent")[..., 3] / 255
    radius = 0.43 * SIZE[1]  # 7 % are left free above and below
    assert alpha.sum() == pytest.approx(np.pi * radius**2, rel=0.02)
    rows, columns = np.nonzero(alpha > 0.5)
    assert [rows.min(), SIZE[1] - 1 - rows.max()] == pytest.approx([0.07 * SIZE[1]] * 2, abs=1.1)
    assert (columns.min() + columns.max()) / 2 == pytest.approx(SIZE[0] / 2 - 0.5, abs=1)
    assert (alpha > 0.99).sum() > 0.9 * np.pi * radius**2


def test_the_picture_moves_with_the_shape_and_keeps_its_sides():
    left_red = square(vertex_attributes={"colors": np.array([[1, 0, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]], float)})
    for view, red_is_left in (("front", True), ("back", False)):
        picture = render(left_red, size=SIZE, view=view).astype(float)
        red, blue = (picture[:, :, i] - picture[:, :, 2 - i] > 60 for i in (0, 2))
        assert (np.nonzero(red)[1].mean() < np.nonzero(blue)[1].mean()) == red_is_left


def test_colours_follow_the_numbers_through_the_colour_bar():
    faces = PolygonMesh([[x, 0, z] for z in (0, 1) for x in range(4)], [[i, i + 1, i + 5, i + 4] for i in range(3)])
    picture = render(faces, size=(320, 120), view="front", color=[0.0, 0.5, 1.0], limits=(0, 1)).astype(float)
    middle = picture[60]
    shown = np.flatnonzero(np.ptp(picture[40:80], axis=(0, 2)) > 12)[::1]
    shown = shown[shown < 0.85 * 320]
    brightness = [middle[c].sum() for c in np.quantile(shown, [1 / 6, 1 / 2, 5 / 6]).astype(int)]
    assert brightness[0] > brightness[1] > brightness[2]  # pale, then orange, then indigo


def test_a_texture_is_worn_the_right_way_up(tmp_path):
    Image.fromarray(np.array([[[250, 0, 0], [0, 250, 0]], [[0, 0, 250], [250, 250, 0]]], np.uint8)).resize(
        (64, 64), Image.Resampling.NEAREST
    ).save(tmp_path / "four.png")
    uvs = CornerValues(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float), np.arange(4))
    picture = render(square(uvs=uvs), texture=tmp_path / "four.png", size=(120, 120), view="front").astype(int)
    corners = [picture[row, column] for row in (30, 90) for column in (30, 90)]
    assert [int(np.argmax(c)) for c in corners[:3]] == [0, 1, 2]
    assert corners[3][2] < min(corners[3][:2]) - 50  # yellow


def test_a_checkerboard_where_there_is_no_texture_and_clay_unless_asked():
    plain, checkered = (
        render(globe(), size=SIZE, view="front", color=c, show=("mesh",)).astype(int) for c in (None, "texture")
    )
    redness = [(picture[40:80, 60:100, 0] - picture[40:80, 60:100, 2]) for picture in (plain, checkered)]
    assert np.ptp(redness[0]) < 30 < 80 < np.ptp(redness[1])  # clay is of one hue, the board of two


def test_the_lattice_fits_into_the_picture_too():
    full = render(globe(), Shear(0.5), size=SIZE, view="front", background="transparent")[..., 3] / 255
    rows, columns = np.nonzero(full > 0.5)
    wide, tall = np.ptp(columns) + 1, np.ptp(rows) + 1
    assert wide == pytest.approx(0.86 * SIZE[0], abs=4)  # the lattice: 3.6 wide, 2.4 high
    assert wide / tall == pytest.approx(3.6 / 2.4, rel=0.06)


def test_the_few_control_points_that_moved_are_red():
    red, amber = zip(*(_red_and_amber(render(globe(), tool, size=(640, 480))) for tool in TOOLS), strict=True)
    assert red[0] == red[2] == 0  # at rest; and all moved, which marks none
    assert red[1] > 80
    assert min(amber) > 50
    assert amber[1] < amber[0]


def _red_and_amber(picture: np.ndarray) -> tuple[int, int]:
    r, g, b = picture.astype(int).transpose(2, 0, 1)
    return int(((r > 150) & (g < 90) & (b < 110)).sum()), int(((r > 170) & (abs(g - 130) < 60) & (b < 90)).sum())


@pytest.mark.parametrize("part", ["edges", "grid", "arrows"])
def test_each_part_adds_something(part):
    without = render(globe(12), Shear(), size=SIZE, show=("mesh",)).astype(int)
    withit = render(globe(12), Shear(), size=SIZE, show=("mesh", part)).astype(int)
    assert (abs(without - withit).max(axis=2) > 30).sum() > 200


def test_a_file_holds_the_picture_that_is_returned(tmp_path):
    picture = render(globe(), Shear(), size=SIZE, color="volume ratio", unit="1")
    path = render(globe(), Shear(), tmp_path / "one" / "picture.png", size=SIZE, color="volume ratio", unit="1")
    np.testing.assert_array_equal(np.asarray(Image.open(path)), picture)
    assert [p.name for p in path.parent.iterdir()] == ["picture.png"]


def test_points_and_lines_are_drawn_without_faces():
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]])
    for mesh in (PolygonMesh(corners), PolygonMesh(corners, lines=[[0, 1, 2, 3, 0]])):
        alpha = render(mesh, size=(640, 480), view="front", background="transparent")[..., 3]
        rows, columns = np.nonzero(alpha > 15)
        assert np.ptp(rows) == pytest.approx(0.86 * 480, abs=16)
        assert np.ptp(columns) == pytest.approx(np.ptp(rows), abs=3)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e12, 1e13), (1.0, -1e5)])
def test_scale_and_place_do_not_matter(scale, shift):
    alpha = render(globe().with_points(scale * globe().points + shift), size=SIZE, background="transparent")[..., 3]
    assert alpha.sum() / 255 == pytest.approx(np.pi * (0.43 * SIZE[1]) ** 2, rel=0.03)


def test_one_point_is_seen_in_the_middle():
    alpha = render(PolygonMesh([[1.0, 2.0, 3.0]]), size=SIZE, background="transparent")[..., 3]
    rows, columns = np.nonzero(alpha > 128)
    assert (rows.mean(), columns.mean()) == pytest.approx((SIZE[1] / 2, SIZE[0] / 2), abs=1.5)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"color": "warmth"}, InvalidParameter, "displacement, x, y, z, volume ratio"),
        ({"color": np.zeros(5)}, InvalidParameter, "fits neither"),
        ({"color": np.full(4, np.nan)}, InvalidParameter, "4 values of the colour are not finite"),
        ({"color": "texture"}, InvalidParameter, "no texture coordinates"),
        ({"color": "x", "limits": (1.0, 1.0)}, InvalidParameter, "a low and a higher"),
        ({"show": ("mesh", "cage")}, InvalidParameter, "'cage'"),
        ({"view": "above"}, InvalidParameter, "'above'"),
        ({"view": (0, 0, 0)}, InvalidParameter, "not zero"),
        ({"up": "x"}, InvalidParameter, "'y' or 'z'"),
        ({"background": "pink"}, InvalidParameter, "'pink'"),
        ({"size": (0, 10)}, InvalidParameter, "pixels"),
        ({"spacing": 0.0}, InvalidParameter, "positive"),
        ({"path": "a.obj"}, UnsupportedFormat, r"\.png"),
        ({"path": "a.jpg", "background": "transparent"}, UnsupportedFormat, "transparency"),
    ],
)
def test_impossible_wishes_are_refused_with_their_cause(options, error, words):
    with pytest.raises(error, match=words):
        render(square(), **options)


def test_a_picture_of_nothing_and_a_broken_texture_are_refused(tmp_path):
    with pytest.raises(InvalidMesh, match="no points"):
        render(PolygonMesh(np.empty((0, 3))))
    (tmp_path / "broken.png").write_bytes(b"not a picture")
    with pytest.raises(UnreadableFile, match=r"broken\.png"):
        render(globe(12), texture=tmp_path / "broken.png")


def test_without_pyvista_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(MissingExtra, match=r"pliant\[render\]"):
        render(square())


def test_without_a_driver_the_packages_are_named(monkeypatch):
    last_resort = type("Window", (), {"GetClassName": lambda self: "vtkOSOpenGLRenderWindow"})
    monkeypatch.setattr("vtkmodules.vtkRenderingCore.vtkRenderWindow", last_resort)
    monkeypatch.setattr(window, "SOFTWARE_LIBRARIES", ("libnothing.so",))
    with pytest.raises(NoGraphics, match="libegl1 libgl1-mesa-dri"):
        render(square())
