"""The volume of a deformed block: against quadrature that is exact for its degree, and against its skin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidDeformer

BOX = np.array([[0.0, 0, 0], [2.0, 3.0, 1.0]])


def shaken(rest, seed=0):
    return rest.moved(rest.rest + 0.1 * np.random.default_rng(seed).normal(size=rest.rest.shape))


def quadrature(deformer, spans):
    """Gauss-Legendre in each span: exact up to degree 2 * 8 - 1 an axis."""
    t, w = np.polynomial.legendre.leggauss(8)
    places, weights = [], []
    for axis, count in enumerate(spans):
        edges = np.linspace(BOX[0, axis], BOX[1, axis], count + 1)
        half = np.diff(edges) / 2
        places.append((edges[:-1, None] + half[:, None] * (t + 1)).reshape(-1))
        weights.append((half[:, None] * w).reshape(-1))
    points = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.einsum("n,n", np.einsum("i,j,k->ijk", *weights).reshape(-1), pl.volume_ratio(deformer, points))


@pytest.mark.parametrize("edge", ["clamp", "zero", "identity"])
def test_spline_blocks(edge):
    deformer = shaken(pl.BSplineFFD.around(BOX, shape=(5, 6, 5), edge=edge))
    assert pl.deformed_volume(deformer) == pytest.approx(quadrature(deformer, (4, 5, 4)), rel=1e-12)
    bent = replace(deformer, affine=np.diag([2.0, 1.0, 1.5, 1.0]))
    assert pl.deformed_volume(bent) == pytest.approx(quadrature(bent, (4, 5, 4)), rel=1e-12)


@pytest.mark.parametrize("fields", [{"shape": (3, 4, 5)}, {"patches": (2, 1, 2)}, {"shape": (2, 1, 3)}])
def test_bezier_blocks(fields):
    deformer = shaken(pl.BezierFFD.around(BOX, **fields))
    assert pl.deformed_volume(deformer) == pytest.approx(quadrature(deformer, (2, 1, 2)), rel=1e-12)
    frame = pl.Affine.scaling((2, 3, 4)) @ pl.Affine.rotation("x", 1.0)
    assert pl.deformed_volume(pl.place(deformer, frame)) == pytest.approx(24 * pl.deformed_volume(deformer))


def test_a_multilinear_block_is_the_mesh_of_its_skin():
    """A trilinear hexahedron has the volume of its six bent quadrangles."""
    deformer = shaken(pl.BezierFFD.around(BOX, shape=(2, 2, 2)))
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    skin = pl.PolygonMesh(deformer.controls.reshape(-1, 3), quads)
    assert pl.deformed_volume(deformer) == pytest.approx(pl.volume(skin), rel=1e-12)


def test_at_rest_it_is_the_box():
    assert pl.deformed_volume(pl.BSplineFFD.around(BOX)) == pytest.approx(6.0, rel=1e-13)


def test_what_has_no_block():
    with pytest.raises(InvalidDeformer, match="no volume"):
        pl.deformed_volume(pl.BSplineFFD.around(BOX, shape=(4, 4, 1)))
    with pytest.raises(InvalidDeformer, match="Twist is no lattice"):
        pl.deformed_volume(pl.Twist(axis="z", angle=1.0))
