"""Displacement fields as images: SimpleITK and nibabel read what we wrote, and we what they wrote."""

from __future__ import annotations

import gzip

import nibabel as nib
import numpy as np
import pytest
import SimpleITK as sitk  # noqa: N813

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.space.displacement_grid import DisplacementGrid

SIGNS = np.array([-1.0, -1, 1])
AXES = pl.Affine.rotation((1, -2, 3), 0.6).linear


def grid(**choices):
    values = np.random.default_rng(0).normal(size=(6, 5, 4, 3))
    return DisplacementGrid(
        displacements=values, origin=(1, 2, 3), spacing=(1.5, 2, 3), axes=AXES, **{"rim": 0.5, **choices}
    )


def points_of(deformer, beyond=2.0, count=500):
    q = np.random.default_rng(3).uniform(-beyond, np.array(deformer.displacements.shape[:3]) - 1 + beyond, (count, 3))
    return deformer.origin + (q * deformer.spacing) @ deformer.axes.T


def by_itk(image, points):
    transform = sitk.DisplacementFieldTransform(sitk.Cast(image, sitk.sitkVectorFloat64))
    return np.array([transform.TransformPoint(point) for point in (points * SIGNS).tolist()]) * SIGNS


@pytest.mark.parametrize(
    ("name", "tolerance"), [("a.mha", 1e-12), ("a.mhd", 1e-12), ("a.nii", 2e-6), ("a.nii.gz", 2e-6)]
)
def test_itk_evaluates_our_fields(tmp_path, name, tolerance):
    ours, path = grid(direction="pull-back"), tmp_path / name
    report = pl.write_transform(ours, path, strict=True)
    assert not report.losses
    points = points_of(ours, 0.4)
    expected = ours(points)
    assert np.abs(by_itk(sitk.ReadImage(str(path)), points) - expected).max() < tolerance
    again = pl.read_transform(path)
    assert np.abs(again(points) - expected).max() < tolerance
    assert np.array_equal(again.displacements, ours.displacements)
    assert (again.direction, again.outside, again.rim) == ("pull-back", "identity", 0.5)


@pytest.mark.parametrize(("name", "tolerance"), [("a.mha", 1e-12), ("a.mhd", 1e-12), ("a.nii.gz", 1e-5)])
@pytest.mark.parametrize("compressed", [False, True])
def test_fields_that_itk_wrote(tmp_path, name, tolerance, compressed):
    image = sitk.GetImageFromArray(np.random.default_rng(1).normal(size=(4, 5, 6, 3)), isVector=True)
    image.SetSpacing((1.5, 2, 3))
    image.SetOrigin((1, -2, 3))
    image.SetDirection(AXES.reshape(-1).tolist())
    path = tmp_path / name
    sitk.WriteImage(image, str(path), compressed)
    ours = pl.read_transform(path)
    points = points_of(ours, 0.45)
    assert np.abs(ours(points) - by_itk(image, points)).max() < tolerance


def niftyreg(path, values, matrix, kind, dtype=np.float64):
    image = nib.Nifti1Image(values[:, :, :, None].astype(dtype), matrix)
    image.header.set_intent(1007, name="NREG_TRANS", allow_unknown=True)
    image.header["intent_p1"] = kind
    nib.save(image, path)
    return np.asarray(nib.load(path).affine, np.float64)


def matrix():
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = AXES * [4, 5, 6], [1, 2, 3]
    return result


def positions(frame, shape):
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    return index @ frame[:3, :3].T + frame[:3, 3]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_niftyreg_control_points(tmp_path, dtype):
    """By hand: the sum of four by four by four positions, from floor(p) of the lattice that begins one spacing out."""
    path, shape = tmp_path / "cpp.nii.gz", (7, 6, 8)
    moves = np.random.default_rng(0).normal(size=(*shape, 3)) * 0.3
    frame = niftyreg(path, positions(matrix(), shape) + moves, matrix(), 2, dtype)
    controls = nib.load(path).get_fdata()[:, :, :, 0]
    ours = pl.read_transform(path)
    assert isinstance(ours, pl.BSplineFFD)
    assert (ours.direction, ours.edge) == ("pull-back", "clamp")
    image_index = np.random.default_rng(1).uniform(0, np.array(shape) - 3, (50, 3))  # in spacings of the image's corner
    points = (image_index + 1) @ frame[:3, :3].T + frame[:3, 3]
    for point, p in zip(points, image_index, strict=True):
        first = np.floor(p).astype(int)
        u = p - first
        basis = np.array([(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3]).T / 6
        i, j, k = (slice(at, at + 4) for at in first)
        expected = np.einsum("a,b,c,abcd->d", *basis, controls[i, j, k])
        assert np.abs(ours(point[None])[0] - expected).max() < 1e-6


@pytest.mark.parametrize(("kind", "absolute"), [(0, True), (1, False)])
def test_niftyreg_deformation_fields(tmp_path, kind, absolute):
    path, shape = tmp_path / "def.nii", (7, 6, 8)
    moves = np.random.default_rng(0).normal(size=(*shape, 3))
    frame = niftyreg(path, positions(matrix(), shape) + moves if absolute else moves, matrix(), kind)
    nodes = positions(frame, shape).reshape(-1, 3)
    assert np.abs(pl.read_transform(path)(nodes) - nodes - moves.reshape(-1, 3)).max() < 1e-5


@pytest.mark.parametrize("edge", ["clamp", "zero", "identity"])
def test_our_lattices_as_niftyreg_has_them(tmp_path, edge):
    path = tmp_path / "ours.nii.gz"
    values = np.random.default_rng(2).normal(size=(6, 5, 7, 3)) * 0.3
    ours = pl.BSplineFFD(displacements=values, origin=(1, 2, 3), spacing=(2, 3, 1.5), axes=AXES, edge=edge)
    report = pl.write_transform(ours, path, strict=True)
    assert any(edge in note for note in report.notes)
    again = pl.read_transform(path, edge=edge)
    points = points_of(ours, 6)
    assert np.abs(again(points) - ours(points)).max() < 2e-6
    stored = nib.load(path)
    assert bytes(stored.header["intent_name"].item()) == b"NREG_TRANS"
    assert stored.shape == (*again.shape, 1, 3)


def test_the_affine_part_goes_into_niftyregs_control_points(tmp_path):
    path, affine = tmp_path / "ours.nii", np.eye(4)
    affine[:3] += np.random.default_rng(7).normal(size=(3, 4)) * 0.1
    values = np.random.default_rng(2).normal(size=(6, 5, 7, 3)) * 0.3
    ours = pl.BSplineFFD(displacements=values, origin=(1, 2, 3), spacing=(2, 3, 1.5), axes=AXES, affine=affine)
    assert "affine part beyond" in pl.write_transform(ours, path).losses[0]
    points = points_of(ours, 0.9)
    assert np.abs(pl.read_transform(path)(points) - ours(points)).max() < 2e-6


def test_vectors_in_ras(tmp_path):
    path = tmp_path / "ras.nii"
    image = nib.Nifti1Image(np.ones((3, 3, 3, 1, 3)), np.eye(4))
    image.header["intent_code"] = 1006
    nib.save(image, path)
    assert np.allclose(pl.read_transform(path)([[1, 1, 1]]), [[2, 2, 2]])


def test_images_that_are_no_transforms(tmp_path):
    path = tmp_path / "scan.nii"
    nib.save(nib.Nifti1Image(np.ones((3, 3, 3)), np.eye(4)), path)
    with pytest.raises(UnsupportedFormat):
        pl.read_transform(path)
    niftyreg(path, np.zeros((5, 5, 5, 3)), np.eye(4), 5)
    with pytest.raises(UnsupportedFormat, match="velocity"):
        pl.read_transform(path)
    sheared = np.eye(4)
    sheared[0, 1] = 0.5
    image = nib.Nifti1Image(np.zeros((5, 5, 5, 1, 3)), sheared)
    image.header["intent_code"] = 1007
    nib.save(image, path)
    with pytest.raises(UnreadableFile, match="orthonormal"):
        pl.read_transform(path)


def test_truncated_and_lying_files(tmp_path):
    path = tmp_path / "a.nii.gz"
    pl.write_transform(grid(), path)
    data = path.read_bytes()
    path.write_bytes(data[:-200])
    with pytest.raises(UnreadableFile, match="cut off"):
        pl.read_transform(path)
    raw = bytearray(gzip.decompress(data))
    raw[42:48] = np.array([32767, 32767, 32767], "<i2").tobytes()
    path.write_bytes(gzip.compress(bytes(raw)))
    with pytest.raises(UnreadableFile, match=r"need|damaged"):
        pl.read_transform(path)
    path = tmp_path / "a.mha"
    pl.write_transform(grid(), path)
    text = path.read_bytes()
    for change in ((b"DimSize = 6 5 4", b"DimSize = 60000 50000 40000"), (b"DimSize = 6 5 4", b"DimSize = 6 5"),
                   (b"Spacing = 1.5", b"Spacing = 0.0"), (b"DataFile = LOCAL", b"DataFile = ../LOCAL")):  # fmt: skip
        path.write_bytes(text.replace(*change))
        with pytest.raises(UnreadableFile):
            pl.read_transform(path)
    path.write_bytes(text[:-8])
    with pytest.raises(UnreadableFile, match=r"2,872 bytes"):
        pl.read_transform(path)


def by_vtk(path, points):
    """VTK's own grid transform."""
    vtk = pytest.importorskip("vtk")
    reader = vtk.vtkXMLImageDataReader() if path.suffix == ".vti" else vtk.vtkStructuredPointsReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    image.GetPointData().SetScalars(image.GetPointData().GetArray(0))
    transform = vtk.vtkGridTransform()
    transform.SetDisplacementGridData(image)
    return np.array([transform.TransformPoint(point) for point in points.tolist()])


def test_vtk_evaluates_our_fields(tmp_path):
    values = np.random.default_rng(0).normal(size=(6, 5, 4, 3))
    ours = DisplacementGrid(displacements=values, origin=(1, 2, 3), spacing=(1.5, 2, 3), outside="clamp")
    path, points = tmp_path / "a.vti", points_of(ours, 2)
    assert not pl.write_transform(ours, path, strict=True).losses
    assert np.abs(by_vtk(path, points) - ours(points)).max() < 1e-4  # VTK's place in a cell is of single precision
    assert np.abs(pl.read_transform(path)(points) - ours(points)).max() < 1e-12


def test_turned_and_flat_images_of_vtk(tmp_path):
    for shape in ((6, 5, 4), (6, 1, 4), (1, 5, 4)):
        values = np.random.default_rng(0).normal(size=(*shape, 3))
        ours = DisplacementGrid(displacements=values, origin=(1, 2, 3), spacing=(1.5, 2, 3), axes=AXES, outside="clamp")
        pl.write_transform(ours, tmp_path / "a.vti")
        points = points_of(ours)
        assert np.abs(pl.read_transform(tmp_path / "a.vti")(points) - ours(points)).max() < 1e-12


def test_legacy_images_of_vtk_and_damage(tmp_path):
    path = tmp_path / "a.vtk"
    values = np.random.default_rng(0).normal(size=(2, 3, 4, 3))
    head = "# vtk DataFile Version 3.0\nfield\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 4\nORIGIN 1 2 3\n"
    rows = "\n".join(" ".join(map(repr, row)) for row in values.transpose(2, 1, 0, 3).reshape(-1, 3).tolist())
    path.write_text(f"{head}SPACING 1 2 3\nPOINT_DATA 24\nVECTORS u double\n{rows}\n")
    read = pl.read_transform(path)
    assert np.abs(read.displacements - values).max() < 1e-12
    path.write_text(f"{head}SPACING 1 2 3\nPOINT_DATA 24\nVECTORS u double\n{rows[:200]}\n")
    with pytest.raises((UnreadableFile, UnsupportedFormat)):
        pl.read_transform(path)
    grid_path = tmp_path / "a.vti"
    assert "border" in pl.write_transform(grid(), grid_path).losses[0]
    grid_path.write_bytes(grid_path.read_bytes()[:-2000])
    with pytest.raises(UnreadableFile):
        pl.read_transform(grid_path)
