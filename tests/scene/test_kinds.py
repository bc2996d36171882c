"""The registry of kinds: complete, true to the classes, and every deformer survives being described."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np
import orjson
import pytest
from every_deformer import every_deformer
from scene_shapes import MESH

import pliant as pl
from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidDeformer, InvalidParameter
from pliant.scene.kinds import all_kinds, build, describe, kind_of
from pliant.space.affine import AffineBinding
from pliant.space.profile import Profile

EVERY = every_deformer()


def test_one_of_every_kind_is_tried_here():
    ours = {name for name, kind in all_kinds().items() if kind.cls.__module__.startswith("pliant.")}
    assert ours == {name.partition(" ")[0] for name in EVERY}


@pytest.mark.parametrize("name", EVERY)
def test_a_description_as_json_builds_the_same_deformer(name):
    deformer = EVERY[name]
    kind, data, arrays = describe(deformer)
    copy = build(kind, orjson.loads(orjson.dumps(data)), {key: np.array(array) for key, array in arrays.items()})
    assert type(copy) is type(deformer)
    assert np.array_equal(copy.bind(MESH).deform(), deformer.bind(MESH).deform())


@pytest.mark.parametrize("name", EVERY)
def test_fields_are_those_of_the_class_and_explained(name):
    kind = kind_of(EVERY[name])
    expected = {each.name for each in fields(kind.cls) if each.init and each.name != "carrier"}
    assert {each.name for each in kind.fields} == expected
    assert all(each.doc and not each.doc.startswith("See ") for each in kind.fields)
    assert kind.summary.endswith((".", ")."))
    own = getattr(kind.cls, "parameters", ())
    assert {each.name for each in kind.fields if each.control} == set(own if isinstance(own, tuple) else ())


def test_types_units_and_choices_are_what_the_class_says():
    twist = {each.name: each for each in all_kinds()["twist"].fields}
    assert (twist["angle"].type, twist["angle"].unit, twist["angle"].control) == ("angle", "radians", True)
    assert (twist["axis"].type, twist["origin"].type, twist["bounds"].type) == ("axis", "vector", "vector")
    assert twist["profile"].type == "profile"
    assert twist["profile"].default == "ramp"
    wave = {each.name: each for each in all_kinds()["wave"].fields}
    assert (wave["amplitude"].type, wave["waves"].type) == ("length", "number")
    lattice = {each.name: each for each in all_kinds()["bspline-ffd"].fields}
    assert lattice["edge"].choices == ("clamp", "zero", "identity")
    assert lattice["displacements"].required
    assert set(all_kinds()["extended-ffd"].makers) == {"cylinder", "prism", "sphere"}


@pytest.mark.parametrize(("kind", "maker"), [(k.name, m) for k in all_kinds().values() for m in k.makers])
def test_every_maker_lays_a_deformer_at_rest(kind, maker):
    made = all_kinds()[kind].around(MESH, maker=maker)
    assert kind_of(made).name == kind
    assert np.abs(made(MESH.points) - MESH.points).max() < 1e-12


def test_a_deformer_written_elsewhere_is_a_kind_like_all_others():
    @dataclass(frozen=True, eq=False)
    class ShearForTests(SpaceDeformer):
        """Shear x by z.

        Parameters
        ----------
        amount
            How much.
        """

        amount: float = field(default=0.0, metadata={"range": (-2, 2)})
        parameters = ("amount",)

        @property
        def rest(self):
            return np.zeros(1)

        @property
        def controls(self):
            return np.array([self.amount])

        def moved(self, controls):
            return type(self)(float(controls[0]))

        def bind(self, target):
            return AffineBinding(MESH.points, self._affine().controls)

        def jacobian(self, points):
            return self._affine().jacobian(points)

        def _affine(self):
            return pl.Affine.of([[1, 0, self.amount], [0, 1, 0], [0, 0, 1]])

    (amount,) = all_kinds()["shear-for-tests"].fields
    assert (amount.type, amount.range, amount.control, amount.doc) == ("number", (-2.0, 2.0), True, "How much.")
    assert build("shear-for-tests", {"amount": 0.5}).amount == 0.5


def test_what_no_data_can_hold_is_refused_by_name():
    square = Profile(lambda t: t**2, lambda t: 2 * t)
    with pytest.raises(InvalidParameter, match=r"profile/value is a Python function.*keys"):
        describe(pl.Twist(angle=1.0, profile=square))


@pytest.mark.parametrize(
    ("kind", "data", "cause"),
    [
        ("twits", {}, "no kind of deformer 'twits'; there are: affine, "),
        ("twist", {"angel": 1.0}, "a Twist has no field 'angel'; it has: axis"),
        ("twist", {"axis": 7}, "no Twist can be made|axis"),
        ("bspline-ffd", {}, "no BSplineFFD can be made"),
        ("bspline-ffd", {"displacements": {"array": "gone"}}, "array 'gone' is missing"),
        ("inverse", {"deformer": {"kind": "nothing"}}, "there is no kind 'nothing'"),
        ("inverse", {"deformer": {"record": "Popen", "fields": {}}}, "there is no record 'Popen'"),
        ("inverse", {"deformer": {"what": 1}}, "nothing that pliant knows"),
        ("inverse", {"deformer": {"kind": "affine", "fields": []}}, "names and values are needed"),
        ("affine", {"matrix": {"array": [["a"]]}}, "not one of numbers"),
    ],
)
def test_bad_data_is_told(kind, data, cause):
    with pytest.raises((InvalidParameter, InvalidDeformer), match=cause):
        build(kind, data)


def test_makers_say_what_they_know():
    with pytest.raises(InvalidParameter, match="ways to lay one around a shape: around"):
        all_kinds()["twist"].around(MESH, maker="cylinder")
    with pytest.raises(InvalidParameter, match=r"knows no 'sides'; it knows: .*axis"):
        all_kinds()["twist"].around(MESH, {"sides": 3})
    with pytest.raises(InvalidParameter, match="none: it is made from its fields"):
        all_kinds()["dirichlet-ffd"].around(MESH)
