"""Templates that users save: what was done to one mesh is done to any, whatever its size, place and proportions."""

from __future__ import annotations

import numpy as np
import pytest
from scene_shapes import MESH, lattice, space_stack

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.scene.fitting import Fit
from pliant.scene.recipe import read_recipe
from pliant.scene.recipe_values import Box
from pliant.space.compose import compose

GROWTH, SHIFT = 37.0, np.array([500.0, -20.0, 3.0])
LARGE = pl.PolygonMesh(GROWTH * MESH.points + SHIFT, MESH.faces)
LONG = pl.PolygonMesh(MESH.points * [1.0, 2.0, 5.0] + SHIFT, MESH.faces)


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PLIANT_TEMPLATES", str(tmp_path / "mine"))


def around(kind, **fields):
    return kind.around(MESH, **fields)


def random_motion():
    motion = pl.Affine.rotation((1.0, 2.0, -1.0), 0.7, MESH.center)
    return pl.Affine.of(motion.linear @ np.diag([1.2, 0.9, 1.1]), motion.offset + [0.3, 0.1, -0.2])


DEFORMERS = {
    "twist": lambda: around(pl.Twist, axis="z", angle=1.1),
    "slanted twist": lambda: around(pl.Twist, axis=(1.0, 0.5, 2.0), angle=0.6),
    "bend": lambda: around(pl.Bend, axis="z", angle=0.8, normal="x"),
    "centred bend": lambda: around(pl.Bend, axis="z", angle=0.8, normal="x", center=1.0),
    "taper": lambda: around(pl.Taper, axis="x", factor=0.4),
    "flare": lambda: around(pl.Flare, axis="z", start=0.7, end=1.3, bulge=0.4),
    "squash": lambda: around(pl.Squash, axis="z", factor=0.6),
    "sine": lambda: around(pl.Sine, axis="z", normal="x", amplitude=0.3, waves=2.0),
    "wave": lambda: around(pl.Wave, axis="z", amplitude=0.2, waves=3.0),
    "scale": lambda: around(pl.Scale, x=1.5, z=0.5),
    "affine": random_motion,
    "lattice": lattice,
    "placed": lambda: pl.place(around(pl.Twist, axis="z", angle=1.0), pl.Affine.rotation("x", 0.4, MESH.center)),
    "composition": lambda: compose(around(pl.Twist, angle=0.4), lattice()),
}


@pytest.mark.parametrize("name", DEFORMERS)
def test_on_a_mesh_of_another_size_and_place_it_does_the_same(name):
    deformer = DEFORMERS[name]()
    pl.save_template(pl.Stack([pl.Layer("own", deformer)]), "own", mesh=MESH)
    moved = pl.template("own").stack(LARGE)(LARGE).points
    wanted = GROWTH * deformer(MESH).points + SHIFT
    assert np.abs(wanted - LARGE.points).max() > 0.5
    assert np.abs(moved - wanted).max() < 1e-9 * LARGE.diagonal


@pytest.mark.parametrize("name", DEFORMERS)
def test_on_its_own_mesh_it_is_what_it_was(name):
    deformer = DEFORMERS[name]()
    pl.save_template(pl.Stack([pl.Layer("own", deformer)]), "own", mesh=MESH)
    layer = pl.template("own").stack(MESH)["own"]
    assert type(layer.deformer) is type(deformer)
    assert np.abs(layer.deformer(MESH).points - deformer(MESH).points).max() < 1e-12


def test_proportions_angles_stay_and_positions_follow():
    stack = pl.Stack([pl.Layer("twist", around(pl.Twist, axis="z", angle=1.1)), pl.Layer("warp", lattice())])
    pl.save_template(stack, "own", mesh=MESH)
    fitted = pl.template("own").stack(LONG)
    twist, low, high = fitted["twist"].deformer, *LONG.bounds
    assert twist.angle == pytest.approx(1.1, abs=1e-14)
    assert twist.bounds == pytest.approx((low[2], high[2]), rel=1e-12)
    assert np.asarray(twist.origin) == pytest.approx(LONG.center)
    stretched = lattice()(MESH).points * [1.0, 2.0, 5.0] + SHIFT
    assert np.abs(fitted["warp"].deformer(LONG).points - stretched).max() < 1e-10


def test_keys_are_fitted_too():
    sine = around(pl.Sine, axis="z", normal="x", amplitude=0.1, waves=1.0)
    stack = pl.Stack([pl.Layer("sine", sine), pl.Layer("warp", lattice()), pl.Layer("motion", random_motion())])
    clip = pl.Clip(MESH, stack, duration=1.0, fps=4)
    clip = clip.key("sine", 0.0, {"amplitude": 0.0}).key("sine", 1.0, {"amplitude": 0.5, "origin": MESH.center + 0.2})
    clip = clip.key("warp", 0.0, {"controls": lattice().rest}).key("warp", 1.0, {"controls": lattice().controls})
    clip = clip.key("motion", 0.0, {"matrix": np.eye(4)}).key("motion", 1.0, {"matrix": random_motion().matrix})
    clip = clip.key("sine", 0.5, {"frame": np.eye(4)}).key("sine", 1.0, {"frame": random_motion().matrix})
    pl.save_template(clip, "own")
    fitted = pl.template("own").clip(LARGE)
    for one, two in zip(clip.frames(), fitted.frames(), strict=True):
        assert np.abs(GROWTH * one.points + SHIFT - two.points).max() < 1e-9 * LARGE.diagonal


@pytest.mark.parametrize("name", [name for name in DEFORMERS if name != "composition"])
def test_intensity_counts_from_rest(name):
    pl.save_template(pl.Stack([pl.Layer("own", DEFORMERS[name]())]), "own", mesh=MESH)
    still = pl.template("own").stack(LARGE, intensity=0.0)(LARGE).points
    assert np.abs(still - LARGE.points).max() < 1e-10 * LARGE.diagonal
    full, half = (pl.template("own").stack(LARGE, intensity=part)(LARGE).points for part in (1.0, 0.5))
    far, near = (np.linalg.norm(points - LARGE.points) for points in (full, half))
    assert 0.2 * far < near < 0.8 * far


def test_a_flat_shape_fits_a_solid_one_and_back():
    flat = pl.PolygonMesh(MESH.points * [1, 1, 0], MESH.faces)
    for first, second in ((flat, LARGE), (LARGE, flat)):
        fit = Fit(Box.of(first), Box.of(second))
        assert np.isfinite(fit.map.matrix).all()
        assert abs(np.linalg.det(fit.map.linear)) > 0
        twist = fit.deformer(pl.Twist.around(MESH, axis="z", angle=1.0))
        assert twist.bounds[0] < twist.bounds[1]


def test_templates_of_before_are_as_they_were(tmp_path):
    (tmp_path / "old.toml").write_text(
        'pliant = 1\n[[layer]]\nname = "twist"\nkind = "twist"\nangle = 30.0\nbounds = [1.0, 2.0]\n'
    )
    twist = read_recipe(tmp_path / "old.toml").stack(LARGE)["twist"].deformer
    assert (twist.bounds, twist.angle) == ((1.0, 2.0), pytest.approx(np.pi / 6))
    pl.save_template(space_stack(), "fixed")
    assert "box" not in pl.template("fixed").document


@pytest.mark.parametrize("box", ["[1, 2]", "'large'", "[[0, 0, 0], [1, 1, nan]]", "[[0, 0, 0], [1, -1, 1]]"])
def test_boxes_that_are_none(box, tmp_path):
    (tmp_path / "bad.toml").write_text(f'pliant = 2\nbox = {box}\n[[layer]]\nname = "t"\nkind = "twist"\nangle = 1.0\n')
    with pytest.raises(InvalidParameter, match="box"):
        read_recipe(tmp_path / "bad.toml").stack(MESH)
