"""Recipes and templates: what people write is what they get, on any mesh, and comes back as text."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from every_deformer import every_deformer
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_shapes import MASK, MESH, mixed_stack, space_stack

import pliant as pl
from pliant.errors import InvalidParameter, UnreadableFile
from pliant.scene.recipe import Recipe
from pliant.scene.recipe_writing import recipe_document
from pliant.scene.toml_text import toml_text

LOW, HIGH = MESH.bounds
EXTENT = HIGH - LOW


def recipe(text):
    return Recipe(tomllib.loads(text))


def layers(text):
    return recipe(text).stack(MESH)


def test_a_layer_is_laid_around_the_mesh():
    stack = layers(
        """
        mode = "add"
        [[layer]]
        name = "turn"
        kind = "twist"
        around = true
        angle = 90
        bounds = ["25 %", "75 %"]
        envelope = 0.5
        [[layer]]
        name = "wag"
        kind = "sine"
        around = true
        amplitude = "10 %"
        origin = ["0 %", "50 %", "100 %"]
        """
    )
    expected = pl.Twist.around(MESH, angle=np.pi / 2, bounds=(LOW[2] + EXTENT[2] / 4, HIGH[2] - EXTENT[2] / 4))
    assert np.array_equal(stack["turn"].deformer(MESH.points), expected(MESH.points))
    assert (stack.mode, stack["turn"].envelope) == ("add", 0.5)
    assert np.isclose(stack["wag"].deformer.amplitude, 0.1 * MESH.diagonal)
    assert np.allclose(stack["wag"].deformer.origin, [LOW[0], (LOW[1] + HIGH[1]) / 2, HIGH[2]])


def test_plain_numbers_are_what_they_say_and_angles_are_degrees():
    (layer,) = layers('[[layer]]\nname = "a"\nkind = "twist"\nangle = 180\nbounds = [1, 3]\naxis = [0, 1, 1]')
    assert np.isclose(layer.deformer.angle, np.pi)
    assert layer.deformer.bounds == (1.0, 3.0)


def test_control_points_are_moved_by_parts_of_the_box():
    (layer,) = layers(
        '[[layer]]\nname = "a"\nkind = "bspline-ffd"\naround = true\nshape = [3, 3, 4]\n'
        'moves = [{ at = [0, "*", 3], by = ["10 %", 0, "-50 %"] }]'
    )
    moved = layer.deformer.displacements
    assert np.allclose(moved[0, :, 3], [0.1 * EXTENT[0], 0, -0.5 * EXTENT[2]])
    assert np.count_nonzero(moved.any(axis=-1)) == 3


def test_other_ways_to_lay_a_deformer_are_named():
    (layer,) = layers('[[layer]]\nname = "a"\nkind = "extended-ffd"\naround = "prism"\nsides = 5')
    assert np.array_equal(layer.deformer.points, pl.ExtendedFFD.prism(MESH, sides=5).points)


def test_a_mask_rises_along_an_axis():
    (layer,) = layers(
        '[[layer]]\nname = "a"\nkind = "affine"\nmove = ["50 %", 0, 0]\n'
        'mask = { axis = "z", from = "25 %", to = "75 %" }'
    )
    mask = layer.mask
    assert (mask[MESH.points[:, 2] < 1] == 0).all()
    assert (mask[MESH.points[:, 2] > 3] == 1).all()
    assert np.allclose(layer.deformer.offset, [0.5 * EXTENT[0], 0, 0])


def test_keys_make_a_clip_that_is_stretched_to_the_duration():
    text = (
        'duration = 2.0\nfps = 10\nending = "loop"\n[[layer]]\nname = "a"\nkind = "twist"\naround = true\n'
        '[[key]]\nlayer = "a"\ntime = 0\nangle = 0\n[[key]]\nlayer = "a"\ntime = 1\neasing = "linear"\nangle = 90\n'
    )
    clip = recipe(text).clip(MESH, duration=4.0)
    assert (clip.duration, clip.fps, clip.ending) == (4.0, 10.0, "loop")
    assert np.isclose(clip.stack_at(1.0)["a"].deformer.angle, np.pi / 4)
    assert np.isclose(clip.stack_at(3.9)["a"].deformer.angle, np.pi / 2)


@pytest.mark.parametrize(("intensity", "angle", "factor"), [(0.0, 0.0, 1.0), (1.0, 90.0, 2.0), (2.0, 180.0, 4.0)])
def test_intensity_scales_from_rest(intensity, angle, factor):
    text = (
        '[[layer]]\nname = "a"\nkind = "twist"\naround = true\nangle = 90\n'
        '[[layer]]\nname = "b"\nkind = "taper"\naround = true\nfactor = 2.0\n'
        '[[layer]]\nname = "c"\nkind = "affine"\nmove = [1, 0, 0]\nturn = 30\n'
        '[[layer]]\nname = "d"\nkind = "bspline-ffd"\naround = true\nmoves = [{ at = [0, 0, 0], by = [1, 0, 0] }]'
    )
    stack = recipe(text).stack(MESH, intensity=intensity)
    assert np.isclose(stack["a"].deformer.angle, np.radians(angle))
    assert np.isclose(stack["b"].deformer.factor, factor)
    expected = pl.Affine.rotation("z", np.radians(30 * intensity)).linear
    assert np.allclose(stack["c"].deformer.linear, expected, atol=1e-12)
    assert np.isclose(stack["d"].deformer.displacements[0, 0, 0, 0], intensity)


def test_with_y_up_it_does_the_same_to_the_mesh_laid_over():
    over = pl.Affine.rotation("x", -np.pi / 2)
    lying = over(MESH)
    for name in ("bounce", "twist-up", "shoulders", "walk-sway", "nod"):
        upright, turned = pl.template(name).clip(MESH), pl.template(name).clip(lying, up="y")
        for time in (0.0, 0.37 * upright.duration):
            expected = over(upright.sample(time).points)
            assert np.abs(turned.sample(time).points - expected).max() < 1e-9


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("", r"it has no \[\[layer\]\]"),
        ("pliant = 3\n[[layer]]", "of version 3; this pliant reads up to 2"),
        ("pliant = 0\n[[layer]]", "its version is 0"),
        ('colour = "red"', "recipes have no 'colour'; they have: pliant, title"),
        ("layer = 3", r"'layer' must be tables: write \[\[layer\]\]"),
        ('[[layer]]\nkind = "twist"', "a layer needs a name and a kind"),
        ('[[layer]]\nname = "a"\nkind = "twits"', "layer 'a': there is no kind of deformer 'twits'; there are: affine"),
        ('[[layer]]\nname = "a"\nkind = "twist"\naround = true\nangel = 3', "around of a twist knows no 'angel'"),
        ('[[layer]]\nname = "a"\nkind = "twist"\naround = "cylinder"', "ways to lay one around a shape: around"),
        ('[[layer]]\nname = "a"\nkind = "twist"\naround = true\nangle = "30 %"', "'30 %' is no number"),
        (
            '[[layer]]\nname = "a"\nkind = "taper"\naround = true\nfactor = "30 %"',
            "'factor' cannot be given in percent",
        ),
        ('[[layer]]\nname = "a"\nkind = "sine"\naround = true\namplitude = "much"', "nor percent such as '30 %'"),
        ('[[layer]]\nname = "a"\nkind = "affine"\nmove = [1, 2]', r"\[1, 2\] is no place"),
        ('[[layer]]\nname = "a"\nkind = "affine"\nmove = [1, 2, 3]\nspin = 3', "a motion has no 'spin'"),
        ('[[layer]]\nname = "a"\nkind = "twist"\nfields = 3', "its fields are no table"),
        (
            '[[layer]]\nname = "a"\nkind = "twist"\naround = true\nmoves = [{ at = [0, 0, 0], by = [0, 0, 0] }]',
            "only lat",
        ),
        (
            '[[layer]]\nname = "a"\nkind = "bspline-ffd"\naround = true\nmoves = [{ at = [9, 0, 0], by = [0, 0, 0] }]',
            "9",
        ),
        ('[[layer]]\nname = "a"\nkind = "bspline-ffd"\naround = true\nmoves = [3]', "3 is no move"),
        (
            '[[layer]]\nname = "a"\nkind = "affine"\nmask = { axis = "w", from = 0, to = 1 }',
            "a mask along an axis says",
        ),
        (
            '[[layer]]\nname = "a"\nkind = "affine"\nmask = { axis = "z", from = 1, to = 1 }',
            "must rise over some length",
        ),
        ('mode = "mix"\n[[layer]]\nname = "a"\nkind = "affine"', "'compose' or 'add', not 'mix'"),
        ('[[layer]]\nname = "a"\nkind = "affine"\n[[key]]\ntime = 1', "key 0 needs a layer, a word, and a time"),
        ('[[layer]]\nname = "a"\nkind = "affine"\n[[key]]\nlayer = "b"\ntime = 1\nturn = 3', "no layer 'b'"),
        ('[[layer]]\nname = "a"\nkind = "affine"\n[[key]]\nlayer = "a"\ntime = 1\nspeed = 3', "has no 'speed'"),
        ('duration = 1\n[[layer]]\nname = "a"\nkind = "affine"\n[[key]]\nlayer = "a"\ntime = -1\nturn = 3', "not neg"),
        (
            '[[layer]]\nname = "a"\nkind = "affine"\n[[key]]\nlayer = "a"\ntime = 1\nturn = 3\neasing = "fast"',
            "no easing",
        ),
    ],
)
def test_what_is_not_understood_is_told(text, cause):
    with pytest.raises(InvalidParameter, match=cause):
        recipe(text).clip(MESH)


def test_files_that_are_no_recipes_are_told(tmp_path):
    path = tmp_path / "a.toml"
    for data, cause in ((b"= 3", "it is no TOML"), (b"\xff", "no UTF-8"), (b"a = 3", "have no 'a'"), (b"", "empty")):
        path.write_bytes(data)
        with pytest.raises(UnreadableFile, match=cause):
            pl.read_recipe(path)
    path.write_bytes(b"a = " + b"[" * 5000 + b"]" * 5000)
    with pytest.raises(UnreadableFile, match="nested too deeply"):
        pl.read_recipe(path)


@pytest.mark.parametrize("mode", ["compose", "add"])
def test_a_stack_comes_back_from_its_recipe(tmp_path, mode):
    for stack in (space_stack().in_mode(mode), mixed_stack().in_mode(mode).replace("edit", muted=True, solo=True)):
        pl.write_recipe(stack, tmp_path / "a.toml", title="Ä “test” \\ \x7f")
        again = pl.read_recipe(tmp_path / "a.toml")
        assert again.title == "Ä “test” \\ \x7f"
        assert [each.muted for each in again.stack(MESH)] == [each.muted for each in stack]
        assert np.abs(again.stack(MESH)(MESH).points - stack(MESH).points).max() < 1e-14


def test_every_deformer_comes_back_from_a_recipe():
    for name, deformer in every_deformer().items():
        text = toml_text(recipe_document(pl.Stack([pl.Layer(name, deformer, mask=MASK)])))
        (again,) = recipe(text).stack(MESH)
        assert np.array_equal(again.mask, MASK)
        assert np.abs(again.deformer.bind(MESH).deform() - deformer.bind(MESH).deform()).max() < 1e-12, name


def test_a_clip_comes_back_from_its_recipe(tmp_path):
    clip = pl.Clip(MESH, space_stack(), duration=2.0, fps=12, ending="loop")
    clip = clip.key("twist", 0.0, {"angle": 0.1, "envelope": 0.2}).key("twist", 1.5, {"angle": 1.0}, "ease_in")
    clip = clip.key("warp", 1.0, {"controls": clip.stack["warp"].deformer.rest}, (0.1, 0.2, 0.3, 0.4))
    clip = clip.key("taper", 0.0, {"frame": pl.Affine.translation([0, 0, 1])})
    pl.write_recipe(clip, tmp_path / "a.toml")
    again = pl.read_recipe(tmp_path / "a.toml").clip(MESH)
    assert (again.duration, again.fps, again.ending) == (2.0, 12.0, "loop")
    for time in (0.0, 0.6, 1.2, 1.9):
        assert np.abs(again.sample(time).points - clip.sample(time).points).max() < 1e-12


def test_arrays_too_large_for_people_are_refused():
    large = pl.BSplineFFD.around(MESH, shape=(30, 30, 30))
    with pytest.raises(InvalidParameter, match=r"81,000 numbers is too large for a recipe.*save a project"):
        recipe_document(pl.Stack([pl.Layer("large", large)]))


words = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
scalars = st.one_of(st.booleans(), st.integers(-(2**62), 2**62), st.floats(allow_nan=False), words)
values = st.recursive(scalars, lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(words, inner)))


@settings(deadline=None)
@given(st.dictionaries(words, values, max_size=4))
def test_whatever_is_written_as_toml_reads_back(document):
    assert tomllib.loads(toml_text(document)) == document


def test_there_are_enough_templates_and_each_does_something_and_fits():
    assert len(pl.templates()) >= 24
    small = pl.PolygonMesh(MESH.points * 0.01 + 5.0, MESH.faces)
    for name, each in pl.templates().items():
        assert each.title, name
        assert each.about.endswith("."), name
        one, two = each.clip(MESH, fps=8), each.clip(small, fps=8)
        largest = 0.0
        for first, second in zip(one.frames(), two.frames(), strict=True):
            assert np.abs((second.points - 5.0) * 100 - first.points).max() < 1e-6, name  # any size, anywhere
            largest = max(largest, float(np.abs(first.points - MESH.points).max()))
        assert 0.005 * MESH.diagonal < largest < 3 * MESH.diagonal, name
        if one.ending == "loop":
            assert np.abs(one.sample(0.0).points - one._points(one._binding(), 0.9999999 * one.duration)).max() < 1e-3


def test_users_keep_templates_of_their_own(tmp_path, monkeypatch):
    monkeypatch.setenv("PLIANT_TEMPLATES", str(tmp_path / "mine"))
    count = len(pl.templates())
    path = pl.save_template(space_stack(), "my-own", about="Mine.")
    assert path == tmp_path / "mine" / "my-own.toml"
    assert len(pl.templates()) == count + 1
    assert np.abs(pl.template("my-own").stack(MESH)(MESH).points - space_stack()(MESH).points).max() < 1e-14
    with pytest.raises(InvalidParameter, match="no name of a template"):
        pl.save_template(space_stack(), "../evil")
    for name in ("../evil", "unknown"):
        with pytest.raises(InvalidParameter, match=r"no template .*; there are: banana"):
            pl.template(name)
