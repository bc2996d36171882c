"""Trees: the algebra of sets, volumes that add up, and deformations at any node."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidParameter

shapes = pl.shapes


def overlap(a, b):
    """The volume that two boxes have in common, from their corners."""
    low = np.maximum(a.mesh.bounds[0], b.mesh.bounds[0])
    high = np.minimum(a.mesh.bounds[1], b.mesh.bounds[1])
    return float(np.prod(np.maximum(high - low, 0)))


numbers = st.floats(0.2, 2.0)
boxes = st.builds(
    lambda size, center: shapes.box(size, center), st.tuples(*[numbers] * 3), st.tuples(*[st.floats(-1, 1)] * 3)
)


@settings(max_examples=40, deadline=None)
@given(boxes, boxes)
def test_volumes_of_boxes(a, b):
    both = overlap(a, b)
    assert (a & b).volume == pytest.approx(both, abs=1e-9)
    assert (a | b).volume == pytest.approx(a.volume + b.volume - both, abs=1e-9)
    assert (a - b).volume == pytest.approx(a.volume - both, abs=1e-9)
    assert (a | b).mesh.edge_use == (0, 0)


def test_inclusion_and_exclusion_of_three():
    a, b, c = shapes.sphere(1.0), shapes.box(1.5, (0.4, 0, 0)), shapes.cylinder(0.5, 3.0)
    singles = a.volume + b.volume + c.volume
    pairs = (a & b).volume + (a & c).volume + (b & c).volume
    assert (a | b | c).volume == pytest.approx(singles - pairs + (a & b & c).volume, rel=1e-9)
    assert (a - b - c).volume == pytest.approx((a - (b | c)).volume, rel=1e-9)


def test_nothing_can_be_left():
    nothing = shapes.box() & shapes.box(center=(5, 0, 0))
    assert nothing.volume == 0
    assert nothing.deformed(pl.Twist(angle=1.0)).volume == 0
    assert (shapes.box() | nothing).volume == pytest.approx(1)


def test_groups_say_where_faces_came_from():
    drilled = shapes.box(2.0, name="block") - shapes.cylinder(0.5, 4.0, name="hole")
    groups = drilled.mesh.groups
    triangle = drilled.mesh.points[drilled.mesh.triangles]
    area = np.linalg.norm(np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]), axis=1) / 2
    named = {name: area[groups.indices == i].sum() for i, name in enumerate(groups.names)}
    disc = 64 / 2 * 0.25 * np.sin(2 * np.pi / 64)
    assert named["hole"] == pytest.approx(2 * 64 * np.sin(np.pi / 64))  # 64 sides of the hole, 2 high
    assert named["block"] == pytest.approx(24 - 2 * disc)


def test_a_deformed_part_is_the_deformed_mesh():
    part = shapes.superquadric((1, 1, 3), (0.3, 0.3))
    twisted = part.deformed(pl.Twist(axis="z", angle=1.0, bounds=(-1.5, 1.5)), edge=np.inf)
    expected = pl.Twist(axis="z", angle=1.0, bounds=(-1.5, 1.5))(part.mesh)
    assert np.array_equal(twisted.mesh.points, expected.points)


def test_flat_faces_are_cut_before_they_bend():
    bar = shapes.box((1, 1, 6))
    twisted = bar.deformed(lambda mesh: pl.Twist.around(mesh, axis="z", angle=np.pi))
    assert twisted.volume == pytest.approx(6.0, rel=2e-3)  # a twist keeps it, but for the edges' steps
    fine = bar.deformed(lambda mesh: pl.Twist.around(mesh, axis="z", angle=np.pi), edge=0.05)
    assert abs(fine.volume - 6) < abs(twisted.volume - 6)
    assert twisted.mesh.edge_use == (0, 0)


def test_deforming_and_cutting_do_not_commute():
    bar, hole = shapes.box((1, 1, 4)), shapes.cylinder(0.2, 3.0).turned("x", np.pi / 2)
    twist = pl.Twist(axis="z", angle=np.pi / 2, bounds=(-2, 2))
    before = (bar - hole).deformed(twist)
    after = bar.deformed(twist) - hole
    assert before.mesh.edge_use == after.mesh.edge_use == (0, 0)
    assert before.volume == pytest.approx(bar.volume - (bar & hole).volume, rel=5e-3)
    assert (before & after).volume < min(before.volume, after.volume) - 1e-3


def test_rigid_motions_keep_volumes_and_mirrors_turn_faces():
    part = shapes.cone(1, 2, top=0.3) - shapes.box(0.5)
    for other in (part.moved((1, 2, 3)), part.turned("y", 0.7, (1, 0, 0)), part.scaled((-1, 1, 1))):
        assert other.volume == pytest.approx(part.volume)
        assert (other | shapes.box(0.1, (9, 9, 9))).volume == pytest.approx(part.volume + 0.001)


def test_deformations_deep_in_a_tree():
    ring = shapes.torus(1.0, 0.3).deformed(lambda mesh: pl.Taper.around(mesh, axis="x", factor=0.5))
    whole = ((ring | shapes.sphere(0.6)) - shapes.box((0.4, 4, 0.4))).deformed(
        pl.Stack([pl.Layer("bend", pl.Bend(axis="x", angle=0.8, bounds=(-1, 1), normal="z"))])
    )
    mesh = whole.mesh
    assert mesh.edge_use == (0, 0)
    assert set(mesh.groups.names) == {"torus", "sphere", "box"}
    assert (whole & shapes.box(10)).volume == pytest.approx(whole.volume, rel=1e-9)


@pytest.mark.parametrize(
    ("make", "cause"),
    [
        (lambda: shapes.box() | 3, "to a int"),
        (lambda: shapes.box().deformed(3), "deformer"),
        (lambda: shapes.box().deformed(pl.Twist(angle=1), edge=-1), "positive"),
        (lambda: shapes.box().deformed(lambda mesh: 3).mesh, "int"),
    ],
)
def test_what_no_tree_takes(make, cause):
    with pytest.raises(InvalidParameter, match=cause):
        make()
