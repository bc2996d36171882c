"""ITK's transforms: SimpleITK evaluates what we wrote, and we what it wrote: inside, at borders, outside."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk  # noqa: N813

import pliant as pl
from pliant.errors import InvalidParameter, LossRefused, UnreadableFile, UnsupportedFormat
from pliant.space.compose import compose
from pliant.space.displacement_grid import DisplacementGrid

SIGNS = np.array([-1.0, -1, 1])
AXES = pl.Affine.rotation((1, -2, 3), 0.6).linear
ENDINGS = [".tfm", ".h5", ".txt"]


def by_itk(transform, points):
    """In RAS."""
    return np.array([transform.TransformPoint(point) for point in (points * SIGNS).tolist()]) * SIGNS


def spline(seed=0, size=(10.0, 12, 15), mesh=(3, 4, 5)):
    transform = sitk.BSplineTransform(3, 3)
    transform.SetTransformDomainOrigin((1, 2, 3))
    transform.SetTransformDomainPhysicalDimensions(size)
    transform.SetTransformDomainMeshSize(mesh)
    transform.SetTransformDomainDirection(AXES.reshape(-1).tolist())
    random = np.random.default_rng(seed)
    transform.SetParameters((random.normal(size=len(transform.GetParameters())) * 0.3).tolist())
    return transform


def field(seed=1):
    image = sitk.GetImageFromArray(np.random.default_rng(seed).normal(size=(4, 5, 6, 3)), isVector=True)
    image.SetSpacing((1.5, 2, 3))
    image.SetOrigin((1, -2, 3))
    image.SetDirection(AXES.reshape(-1).tolist())
    return sitk.DisplacementFieldTransform(image)


def euler(zyx=False):
    transform = sitk.Euler3DTransform((1, 2, 3), 0.1, -0.2, 0.3, (4, 5, 6))
    transform.SetComputeZYX(zyx)
    return transform


def around(count=400, seed=5):
    """RAS points in, at the border of, and far from the domains of :func:`spline` and :func:`field`."""
    random = np.random.default_rng(seed)
    inside = random.uniform(0, 1, (count, 3))
    beyond = random.uniform(-1, 2, (count, 3))
    near = random.integers(0, 2, (count, 3)) + random.choice([-1e-6, 1e-6], (count, 3))
    return ([1, 2, 3] + np.vstack([inside, beyond, near]) * [10, 12, 15] @ AXES.T) * SIGNS


def composite():
    return sitk.CompositeTransform(
        [euler(), spline(), sitk.AffineTransform(np.eye(3).reshape(-1) * 1.1, (1, 2, 3)), field()]
    )


MADE = {
    "spline": spline,
    "field": field,
    "composite": composite,
    "affine after a spline": lambda: sitk.CompositeTransform([euler(), spline()]),
    "affine before a spline": lambda: sitk.CompositeTransform([spline(), euler()]),
    "euler": euler,
    "euler zyx": lambda: euler(zyx=True),
    "affine": lambda: sitk.AffineTransform(AXES.reshape(-1) * 1.2, (1, 2, 3), (4, 5, 6)),
    "similarity": lambda: sitk.Similarity3DTransform(1.3, (0, 0.6, 0.8), 0.7, (1, 2, 3), (4, 5, 6)),
    "versor": lambda: sitk.VersorTransform((0, 0.6, 0.8), 0.7, (1, 2, 3)),
    "versor rigid": lambda: sitk.VersorRigid3DTransform((0, 0.6, 0.8), 0.7, (1, 2, 3), (4, 5, 6)),
    "scale versor": lambda: sitk.ScaleVersor3DTransform((1.2, 1, 0.8), (0.1, 0.2, 0.1, 0.9), (1, 2, 3), (4, 5, 6)),
    "scale": lambda: sitk.ScaleTransform(3, (1, 2, 3)),
    "translation": lambda: sitk.TranslationTransform(3, (1, 2, 3)),
    "identity": lambda: sitk.Transform(3, sitk.sitkIdentity),
}


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("name", MADE)
def test_what_itk_wrote(tmp_path, name, ending):
    path = tmp_path / f"made{ending}"
    transform, points = MADE[name](), around()
    sitk.WriteTransform(transform, str(path))
    assert np.abs(pl.read_transform(path)(points) - by_itk(transform, points)).max() < 1e-11


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("name", MADE)
def test_what_itk_wrote_and_we_wrote_again(tmp_path, name, ending):
    path, again = tmp_path / f"made{ending}", tmp_path / f"again{ending}"
    transform, points = MADE[name](), around()
    sitk.WriteTransform(transform, str(path))
    report = pl.write_transform(pl.read_transform(path), again, strict=True)
    assert not report.losses
    assert np.abs(by_itk(sitk.ReadTransform(str(again)), points) - by_itk(transform, points)).max() < 1e-11


def lattice(edge="zero", affine=None, shape=(6, 5, 7)):
    values = np.random.default_rng(2).normal(size=(*shape, 3)) * 0.3
    return pl.BSplineFFD(
        displacements=values,
        origin=(1, 2, 3),
        spacing=(2, 3, 1.5),
        axes=AXES,
        edge=edge,
        affine=np.eye(4) if affine is None else affine,
    )


def bent_affine():
    matrix = np.eye(4)
    matrix[:3] += np.random.default_rng(7).normal(size=(3, 4)) * 0.1
    return matrix


def points_of(ffd, beyond, count=500):
    q = np.random.default_rng(3).uniform(-beyond, np.array(ffd.shape) - 1 + beyond, (count, 3))
    return ffd.origin + (q * ffd.spacing) @ ffd.axes.T


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize(("edge", "beyond"), [("zero", 5.0), ("identity", 5.0), ("clamp", 1.0)])
def test_our_lattices(tmp_path, edge, beyond, ending):
    for affine in (None, bent_affine()):
        ffd, path = lattice(edge, affine), tmp_path / f"ours{ending}"
        report = pl.write_transform(ffd, path)
        assert bool(report.losses) == (edge == "clamp")
        points = points_of(ffd, beyond - 1e-9)
        assert np.abs(by_itk(sitk.ReadTransform(str(path)), points) - ffd(points)).max() < 1e-12
        assert np.abs(pl.read_transform(path)(points) - ffd(points)).max() < 1e-12
        assert pl.read_transform(path).direction == "pull-back"


def test_beyond_a_clamped_lattice_the_loss_is_as_told(tmp_path):
    ffd, path = lattice("clamp"), tmp_path / "ours.tfm"
    report = pl.write_transform(ffd, path)
    assert "beyond the lattice" in report.losses[0]
    far = points_of(ffd, 40)
    assert np.abs(pl.read_transform(path)(far) - ffd(far)).max() > 0.01
    with pytest.raises(LossRefused, match="beyond the lattice"):
        pl.write_transform(ffd, tmp_path / "strict.tfm", strict=True)
    assert not (tmp_path / "strict.tfm").exists()


def test_a_planar_lattice(tmp_path):
    ffd, path = lattice(shape=(5, 6, 1)), tmp_path / "plane.tfm"
    pl.write_transform(ffd, path)
    points = points_of(ffd, 0.9)
    assert np.abs(by_itk(sitk.ReadTransform(str(path)), points) - ffd(points)).max() < 1e-12


@pytest.mark.parametrize("ending", ENDINGS)
def test_our_compositions(tmp_path, ending):
    grid = DisplacementGrid(
        displacements=np.random.default_rng(4).normal(size=(4, 5, 6, 3)), origin=(0, 0, 0), spacing=(3, 3, 3), rim=0.5
    )
    deformer = compose(pl.Affine(bent_affine()), lattice(affine=bent_affine()), grid, pl.Affine.scaling((2, 1, 1)))
    path, points = tmp_path / f"all{ending}", points_of(lattice(), 2)
    assert not pl.write_transform(deformer, path).losses
    assert np.abs(by_itk(sitk.ReadTransform(str(path)), points) - deformer(points)).max() < 1e-11
    assert np.abs(pl.read_transform(path)(points) - deformer(points)).max() < 1e-11


def test_grids_with_another_border_are_a_loss_and_cubic_ones_refused(tmp_path):
    values = np.ones((3, 3, 3, 3))
    for choice in ({"outside": "clamp"}, {"rim": 0.0}):
        grid = DisplacementGrid(displacements=values, origin=(0, 0, 0), spacing=(1, 1, 1), **choice)
        assert "border" in pl.write_transform(grid, tmp_path / "a.tfm").losses[0]
    cubic = DisplacementGrid(displacements=values, origin=(0, 0, 0), spacing=(1, 1, 1), interpolation="cubic")
    with pytest.raises(UnsupportedFormat, match="DisplacementGrid"):
        pl.write_transform(cubic, tmp_path / "a.tfm")
    with pytest.raises(UnsupportedFormat, match="BezierFFD"):
        pl.write_transform(pl.BezierFFD.around(np.eye(3)), tmp_path / "a.h5")


SPLINE = "Transform: BSplineTransform_double_3_3\nParameters: {values}\nFixedParameters: {fixed}\n"
FIXED = "4 4 4 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1"
ZEROS = "0 " * 192


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        (SPLINE.format(values="0 0 0", fixed=FIXED), UnreadableFile, "3 parameters; 4 x 4 x 4 need 192"),
        (SPLINE.format(values="0", fixed="99999 99999 99999" + FIXED[5:]), UnreadableFile, "1 parameters"),
        (SPLINE.format(values=ZEROS, fixed="4 4 4"), UnreadableFile, "3 fixed parameters; a grid has 18"),
        (SPLINE.format(values=ZEROS[:-2] + "x", fixed=FIXED), UnreadableFile, "line 3: parameters: 'x'"),
        (SPLINE.format(values=ZEROS[:-2] + "nan", fixed=FIXED), UnreadableFile, "'nan' is not a finite number"),
        (SPLINE.format(values=ZEROS, fixed=FIXED.replace("1 1 1 1", "1 0 1 1")), UnreadableFile, "spacing"),
        (SPLINE.format(values=ZEROS, fixed=FIXED.replace("1 1 1 1", "1 1 1 2")), UnreadableFile, "orthonormal"),
        (SPLINE.format(values="0 " * 81, fixed="3 3 3" + FIXED[5:]), UnreadableFile, "4 control points an axis"),
        (SPLINE.replace("3_3", "3_2").format(values=ZEROS, fixed=FIXED), UnsupportedFormat, "order 3"),
        (
            "Transform: Euler3DTransform_double_3_3\nParameters: 1 2 3\nFixedParameters: 0 0 0\n",
            UnreadableFile,
            "6 and",
        ),
        ("Transform: ThinPlateSpline_double_3_3\nParameters: 1\n", UnsupportedFormat, "ThinPlateSpline"),
        ("Transform: IdentityTransform_double_3_3\n" * 2, UnreadableFile, "2 transforms and does not say"),
        ("Transform: CompositeTransform_double_3_3\n", UnreadableFile, "no transform"),
        ("nonsense\n", UnreadableFile, "line 2: .*nonsense"),
        ("", UnreadableFile, "no transform"),
    ],
)
def test_damaged_texts(tmp_path, text, error, message):
    path = tmp_path / "bad.tfm"
    path.write_text("#Insight Transform File V1.0\n" + text)
    with pytest.raises(error, match=message):
        pl.read_transform(path)


def test_damaged_hdf5(tmp_path):
    path = tmp_path / "a.h5"
    pl.write_transform(lattice(), path)
    data = path.read_bytes()
    for broken in (data[: len(data) // 2], data[:600], b"\x89HDF\r\n\x1a\n" + bytes(100)):
        path.write_bytes(broken)
        with pytest.raises(UnreadableFile):
            pl.read_transform(path)


def test_a_lattice_that_says_where_it_lies_is_not_fitted(tmp_path, box_mesh):
    path = tmp_path / "a.tfm"
    pl.write_transform(lattice(), path)
    with pytest.raises(InvalidParameter, match="physical"):
        pl.read_transform(path, placement="fit", target=box_mesh)
