from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.deformer import Binding, SpaceDeformer, Target
from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.field.grids import field_grid
from pliant.field.measures import principal_strains, volume_ratio
from pliant.field.vectors import arrows
from pliant.io.meshes import read
from pliant.mesh import as_points


class Fixed(Binding):
    """A binding that knows its answer."""

    points = rest = controls = np.zeros(1)

    def __init__(self, points: np.ndarray, answer: np.ndarray) -> None:
        self.points, self.answer = points, answer

    def deform(self, controls=None, out=None):
        return self.answer.copy()

    def jvp(self, controls, d_controls):
        return np.zeros_like(self.points)

    def vjp(self, controls, d_points):
        return np.zeros(1)


@dataclass(frozen=True)
class Screw(SpaceDeformer):
    """Scaled by ``scale`` an axis, then turned about z by ``rate`` z: det J and strains have closed forms."""

    rate: float = 0.0
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @property
    def rest(self) -> np.ndarray:
        return np.zeros(1)

    @property
    def controls(self) -> np.ndarray:
        return np.array([self.rate])

    def moved(self, controls) -> Self:
        return replace(self, rate=float(controls[0]))

    def bind(self, target: Target) -> Fixed:
        points = as_points(target)
        x, y, z = (points * self.scale).T
        cos, sin = np.cos(self.rate * z), np.sin(self.rate * z)
        return Fixed(points, np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=1))

    def jacobian(self, points) -> np.ndarray:
        x, y, z = (as_points(points) * self.scale).T
        cos, sin = np.cos(self.rate * z), np.sin(self.rate * z)
        result = np.zeros((len(x), 3, 3))
        result[:, 0] = np.stack([cos, -sin, self.rate * (-sin * x - cos * y)], axis=1)
        result[:, 1] = np.stack([sin, cos, self.rate * (cos * x - sin * y)], axis=1)
        result[:, 2, 2] = 1.0
        return result * self.scale


BOX = ([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0])


def test_points_are_the_deformed_rest_points():
    screw = Screw(rate=0.7)
    grid = field_grid(screw, BOX, 0.5)
    np.testing.assert_array_equal(grid.points, screw(grid.rest))
    np.testing.assert_array_equal(grid.displacement, grid.points - grid.rest)
    np.testing.assert_allclose(grid.magnitude**2, (grid.displacement**2).sum(axis=1), atol=1e-15)


def test_lines_are_straight_along_an_axis_before_and_count_as_a_grid_does():
    grid = field_grid(Screw(rate=0.7), BOX, (0.5, 1.0, 2.0))  # 5 x 3 x 2 nodes
    assert len(grid.lines) == 3 * 2 + 5 * 2 + 5 * 3
    for line in grid.lines:
        steps = np.diff(grid.rest[line], axis=0)
        assert (np.abs(steps) > 1e-12).sum(axis=1).max() == 1
        np.testing.assert_allclose(steps, steps[:1].repeat(len(steps), 0), atol=1e-12)
    assert sorted(grid.lines.flat) == list(range(len(grid.points)))


@given(spacing=st.floats(0.1, 3.0), height=st.floats(0.3, 5.0))
@settings(deadline=None, max_examples=25)
def test_lines_fill_the_box_at_most_a_spacing_apart(spacing, height):
    grid = field_grid(Screw(), ([0, 0, 0], [0, 1, height]), spacing)
    levels = np.unique(np.round([grid.rest[line][0, 2] for line in grid.lines if np.ptp(grid.rest[line][:, 1])], 9))
    assert np.diff(levels).max() <= spacing * (1 + 1e-6)
    np.testing.assert_allclose(levels[[0, -1]], [0, height], atol=1e-8)
    assert np.diff(levels).max() > spacing / 2 * (1 - 1e-6) or len(levels) == 2


@pytest.mark.parametrize("rate", [0.5, 3.0, 6.0])
def test_chords_stay_near_their_curves(rate):
    screw = Screw(rate=rate)
    grid = field_grid(screw, BOX, 0.5)
    for line in grid.lines:
        middles = (grid.rest[line][1:] + grid.rest[line][:-1]) / 2
        chords = (grid.points[line][1:] + grid.points[line][:-1]) / 2
        assert np.linalg.norm(screw(middles) - chords, axis=1).max() <= 1.05 * 0.005 * 0.5


def test_planes_hold_only_their_lines():
    grid = field_grid(Screw(rate=1.0), BOX, 0.5, planes={"z": [0.25, 1.4], "x": 0.1})
    for value, axis in ((0.25, 2), (1.4, 2), (0.1, 0)):
        assert sum((grid.rest[line, axis] == value).all() for line in grid.lines) == 5 + 5
    assert len(grid.lines) == 3 * 10


def test_arrows_point_from_where_to_where():
    field = arrows(Screw(rate=1.0, scale=(2.0, 1.0, 1.0)), BOX, 0.5)
    assert len(field.positions) == 5 * 5 * 5
    x, y, z = field.positions.T
    expected = np.stack([np.cos(z) * 2 * x - np.sin(z) * y, np.sin(z) * 2 * x + np.cos(z) * y, z], axis=1)
    np.testing.assert_allclose(field.positions + field.vectors, expected, atol=1e-14)
    np.testing.assert_allclose(field.magnitude, np.linalg.norm(expected - field.positions, axis=1), atol=1e-14)


@given(rate=st.floats(-3, 3), scale=st.tuples(*[st.floats(0.2, 3)] * 3), seed=st.integers(0, 9))
@settings(deadline=None, max_examples=25)
def test_a_screw_changes_volume_by_its_scale_alone(rate, scale, seed):
    points = np.random.default_rng(seed).normal(size=(20, 3))
    np.testing.assert_allclose(volume_ratio(Screw(rate, scale), points), np.prod(scale), rtol=1e-9)


def test_strains_of_a_stretch_and_of_a_rotation():
    points = np.random.default_rng(1).normal(size=(7, 3))
    expected = (np.array([0.5, 1.0, 2.0]) ** 2 - 1) / 2
    np.testing.assert_allclose(principal_strains(Screw(0.0, (2.0, 0.5, 1.0)), points), np.tile(expected, (7, 1)))
    on_axis = np.array([[0.0, 0.0, z] for z in (0.0, 0.3, 2.0)])
    np.testing.assert_allclose(principal_strains(Screw(1.3), on_axis), 0, atol=1e-15)


def test_strains_of_simple_shear_about_a_twist():
    # at radius r a twist shears by s = rate r: J'J has the eigenvalues 1 and 1 + s²/2 ± s sqrt(1 + s²/4)
    shear = 1.5 * 0.8
    middle, half = 1 + shear**2 / 2, shear * np.sqrt(1 + shear**2 / 4)
    expected = (np.array([middle - half, 1.0, middle + half]) - 1) / 2
    np.testing.assert_allclose(principal_strains(Screw(1.5), [[0.0, 0.8, 0.4]])[0], expected, atol=1e-12)


@pytest.mark.parametrize(
    ("bounds", "spacing", "planes", "words"),
    [
        (([0, 0, 0], [1, 1, -1]), 0.1, None, "lowest and a highest"),
        (([0, 0], [1, 1]), 0.1, None, "lowest and a highest"),
        (([0, 0, 0], [1, 1, np.nan]), 0.1, None, "finite"),
        (BOX, 0.0, None, "positive"),
        (BOX, [0.1, 0.1], None, "positive"),
        (BOX, 1e-300, None, "enlarge"),
        (BOX, 1e-3, None, "enlarge the spacing"),
        (BOX, 0.5, {"w": 0.0}, "x, y or z"),
    ],
)
def test_impossible_grids_are_refused_with_their_cause(bounds, spacing, planes, words):
    with pytest.raises(InvalidParameter, match=words):
        field_grid(Screw(), bounds, spacing, planes=planes)


def test_too_many_arrows_are_refused():
    with pytest.raises(InvalidParameter, match=r"2001 × 2001 × 2001 arrows"):
        arrows(Screw(), BOX, 1e-3)


def test_a_deformer_of_a_surface_has_no_volume_ratio():
    with pytest.raises(NotDifferentiable, match="object is no map"):
        volume_ratio(object(), [[0.0, 0, 0]])


def test_a_saved_grid_is_read_back_with_its_lines_and_displacements(tmp_path):
    grid = field_grid(Screw(rate=0.4), BOX, 1.0)
    report = grid.save(tmp_path / "grid.vtp")
    again = read(tmp_path / "grid.vtp")
    np.testing.assert_array_equal(again.points, grid.points)
    np.testing.assert_array_equal(again.lines.flat, grid.lines.flat)
    np.testing.assert_array_equal(again.lines.offsets, grid.lines.offsets)
    np.testing.assert_array_equal(again.vertex_attributes["displacement"], grid.displacement)
    assert report.losses == ()
