"""Every gallery script runs, and its number is right."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

GALLERY = Path(__file__).parents[1] / "docs" / "gallery"
PICTURES = os.environ.get("PLIANT_PICTURES")  # a folder for pictures in full size, as the documentation shows them
SCRIPTS = sorted(path.stem for path in GALLERY.glob("*.py") if path.stem not in {"bodies", "shapes"})
NUMBERS = {
    "affine": (1.0, 1e-12),  # a shear keeps volume
    "arap": (0.99, 0.0099),  # below one: the energy only decreases
    "bend": (1.0, 1e-6),  # the bent axis keeps its length
    "bezier_ffd": (0.8, 0.2),  # the least volume ratio of the vase's dance: nothing folds
    "bezier_patch": (0.0, 1e-12),  # studs keep their height
    "bspline_ffd": (0.0, 1e-8),  # the inverse brings every point back
    "cad_part": (0.0, 1e-4),  # a twist keeps volume, and so does its spline
    "cage_build": (0.0, 1e-12),  # at rest the figure stays where it is
    "cage_builder": (2.0, 0.0),  # one piece without a handle
    "cage_coordinates": (0.5016, 0.02),  # half of the shear is gone
    "cage_influence": (0.0, 1e-12),  # nothing is negative
    "clamped_ffd": (0.059475, 1e-5),
    "compose": (0.0, 0.0),  # with the twist at rest the bend is left, exactly
    "contour_skeleton": (6.0, 0.0),  # muzzle, tail and four hooves
    "deformation_transfer": (0.0, 1e-12),  # at rest the camel is itself
    "dirichlet_ffd": (0.0, 1e-12),  # sites go where they are moved
    "displacement_arrows": (1.0, 1e-12),  # no point outruns the layers of control points
    "displacement_grid": (3.0276, 1e-3),
    "extended_ffd": (0.0, 1e-12),  # the lattice at rest gives every point back
    "face_caricature": (0.3, 0.28),  # above zero: nothing folds
    "face_from_photo": (0.0215, 0.01),  # centimetres between landmarks and the dense face
    "face_handles": (0.0, 1e-9),  # a symmetric face stays symmetric
    "face_turntable": (24.0, 0.0),  # thirteen views there, and back
    "flare": (0.244132, 1e-5),  # the square of the narrowest scale
    "fold_certificate": (0.391395, 1e-3),  # the step at which the first fold begins
    "from_the_formula": (0.0, 1e-14),  # the formula and the library agree
    "hero": (3.0, 0.0),  # panels
    "inverse": (0.0, 1e-8),  # there and back
    "key_frames": (0.0, 0.02),  # both keep the volume; the mesh is coarse
    "laplacian_edit": (0.0, 1e-12),  # the handle is held
    "local_support": (0.125563, 1e-5),
    "model_landmarks": (0.6307, 1e-2),  # five landmarks come nearer than one
    "performance": (0.0, 1e-12),  # the figure ends as it began
    "place": (0.0, 0.0),  # no point is moved by the tool everywhere it goes
    "pull": (0.0, 1e-12),  # held points are where they shall be
    "radial_basis_warp": (0.5776875, 1e-4),  # the part of the points that nothing reaches
    "random_fields": (3.6848, 0.2),  # the narrowest kernel bends space most
    "random_variants": (0.0, 0.0),  # whoever draws them
    "read_write_ffd": (0.0, 1e-7),  # the digits that the file keeps
    "registered_organ": (0.1869, 0.01),  # above zero: nothing folds
    "scale": (1.6 * 1.1 * 0.6, 1e-12),
    "shape_keys": (0.0, 1e-15),  # all keys together are the stack
    "shape_model_modes": (0.9839, 1e-3),  # the variance in the first ten fields
    "shape_model_samples": (0.9962, 1e-3),  # the variance in the first twenty fields
    "shape_uncertainty": (0.0, 1e-3),  # the mean passes through what was seen
    "sine": (0.0, 1e-12),  # sliding keeps volume
    "skeleton_edit": (0.3, 0.2),  # smooth, against torn
    "smooth_patches": (0.0, 1e-6),  # no jump of the Jacobian
    "smoothing": (1.0, 0.01),  # Taubin keeps the volume
    "solid_tree": (0.0, 0.0),  # no edge is open
    "squash": (0.0, 1e-3),  # the faces are flat
    "stack": (0.0, 0.0),  # all layers muted
    "tangent_frames": (1.1, 1e-5),  # each segment grows by a tenth
    "taper": (0.0, 1e-12),  # there and back
    "templates": (0.0, 1e-6),  # loops close
    "thin_plate_spline": (0.0, 1e-10),  # landmarks are where they shall be
    "twist": (0.0, 1e-12),  # volume is kept
    "volume_change": (1.110635, 1e-5),
    "volume_keeping": (0.0, 1e-12),  # nothing is missing
    "warped_grid": (0.4, 0.1),  # the longest displacement, in diagonals
    "wave": (0.0, 1e-12),  # there and back
    "wetted_area": (0.0, 1e-5),  # the volume is kept
}


@pytest.fixture(scope="module")
def beside():
    """The scripts import the shapes that lie beside them."""
    sys.path.insert(0, str(GALLERY))
    yield
    sys.path.remove(str(GALLERY))
    for name in ("bodies", "shapes"):
        sys.modules.pop(name, None)


def test_every_script_has_its_number():
    assert sorted(NUMBERS) == SCRIPTS


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_draws_its_picture_and_returns_its_number(name, tmp_path, beside):
    path = GALLERY / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"gallery_{name}", path)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    expected, tolerance = NUMBERS[name]
    folder, size = (Path(PICTURES), {}) if PICTURES else (tmp_path, {"size": (96, 72)})
    assert script.main(folder, **size) == pytest.approx(expected, abs=tolerance)
    with Image.open(folder / f"{name}.png") as picture:
        assert PICTURES or picture.height == 72
        assert np.ptp(np.asarray(picture.convert("L"))) > 60  # there is something in it


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_is_short(name):
    assert len((GALLERY / f"{name}.py").read_text().splitlines()) <= 42


def test_knots_and_shells_are_what_they_are_called(beside):
    from shapes import shell, trefoil

    import pliant as pl

    knot = trefoil(along=600, around=24, radius=0.3)
    assert knot.edge_use == (0, 0)
    assert len(knot.points) - len(knot.edges) + len(knot.faces) == 0  # a torus, however it is knotted
    center = knot.points.reshape(600, 24, 3).mean(axis=1)
    length = np.linalg.norm(np.diff(center, axis=0, append=center[:1]), axis=1).sum()
    assert abs(pl.volume(knot)) == pytest.approx(12 * np.sin(np.pi / 12) * 0.3**2 * length, rel=1e-2)  # Pappus
    assert shell().edge_use == (2 * 56, 0)
