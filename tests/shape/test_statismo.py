"""Model files: round trips, and every trap that files in the wild set."""

import h5py
import numpy as np
import orjson
import pytest

import pliant as pl
from pliant.errors import LossRefused, UnreadableFile, UnsupportedFormat
from pliant.io.model_formats.model_json import from_json
from pliant.io.models import is_model
from pliant.numerics.ragged import Ragged
from pliant.shape.basis import FullBasis
from pliant.shape.model import ShapeModel
from pliant.shape.tetrahedra import boundary


@pytest.fixture
def mesh(box_mesh):
    return pl.PolygonMesh(box_mesh.points, box_mesh.triangles)


@pytest.fixture
def model(mesh):
    return pl.ShapeModel.from_kernel(mesh, pl.GaussianKernel(4.0, 0.3), rank=8)


@pytest.fixture(params=[".h5", ".h5.json"])
def written(request, model, tmp_path):
    path = tmp_path / f"model{request.param}"
    pl.write_model(model, path)
    return path


def edited(path, change):
    with h5py.File(path, "r+") as stored:
        change(stored)
    return path


def put(stored, name, value):
    if name in stored:
        del stored[name]
    stored[name] = value


def test_a_model_comes_back_to_single_precision(model, written):
    again = pl.read_model(written)
    np.testing.assert_array_equal(again.mean, model.mean.astype(np.float32))
    np.testing.assert_array_equal(again.reference.triangles, model.reference.triangles)
    np.testing.assert_allclose(again.variances, model.variances, rtol=1e-6)
    given = np.random.default_rng(0).normal(size=model.count)
    np.testing.assert_allclose(again.instance(given), model.instance(given), atol=1e-6)
    assert again.convention == model.convention
    assert is_model(written)


def test_a_model_that_was_read_is_written_again_number_by_number(written, tmp_path):
    first = pl.read_model(written)
    for ending in (".h5", ".h5.json"):
        pl.write_model(first, tmp_path / f"again{ending}")
        second = pl.read_model(tmp_path / f"again{ending}")
        assert sorted(second.carrier.values) == sorted(first.carrier.values)
        for place, value in first.carrier.values.items():
            other = second.carrier.values[place]
            assert np.asarray(other).dtype == np.asarray(value).dtype, place
            np.testing.assert_array_equal(other, value)
        assert second.carrier.attributes["/representer"] == first.carrier.attributes["/representer"]


def test_the_layout_is_that_of_statismo(model, tmp_path):
    pl.write_model(model, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as stored:
        n, k = len(model.mean), model.count
        for name, shape, kind in (
            ("model/mean", (3 * n,), "f4"),
            ("model/pcaBasis", (3 * n, k), "f4"),
            ("model/pcaVariance", (k,), "f4"),
            ("model/noiseVariance", (1,), "f4"),
            ("representer/points", (3, n), "f4"),
            ("representer/cells", (3, len(model.reference.triangles)), "i4"),
            ("version/majorVersion", (), "i4"),
            ("version/minorVersion", (), "i4"),
        ):
            assert stored[name].shape == shape, name
            assert stored[name].dtype == np.dtype(kind), name
        attributes = stored["representer"].attrs
        assert attributes["name"] == b"itkStandardMeshRepresenter"
        assert attributes["datasetType"] == b"POLYGON_MESH"
        assert attributes["version/majorVersion"] == b"0"
        basis = stored["model/pcaBasis"][()].astype(float)
        np.testing.assert_allclose(basis.T @ basis, np.eye(k), atol=1e-5)


def test_json_in_a_file_called_h5_is_recognised_by_what_it_holds(model, tmp_path):
    pl.write_model(model, tmp_path / "a.h5.json")
    (tmp_path / "a.h5.json").rename(tmp_path / "a.h5")
    np.testing.assert_array_equal(pl.read_model(tmp_path / "a.h5").mean, model.mean.astype(np.float32))


def test_json_links_lead_from_the_root_to_every_dataset(model, tmp_path):
    pl.write_model(model, tmp_path / "a.h5.json")
    stored = orjson.loads((tmp_path / "a.h5.json").read_bytes())
    reached, waiting = set(), [(stored["root"], "")]
    while waiting:
        group, path = waiting.pop()
        for link in stored["groups"][group].get("links", ()):
            place = f"{path}/{link['title']}"
            if link["collection"] == "groups":
                waiting.append((link["id"], place))
            else:
                assert stored["datasets"][link["id"]]["alias"] == [place]
                reached.add(place)
    assert reached == set(from_json(tmp_path, (tmp_path / "a.h5.json").read_bytes()).values)


@pytest.mark.parametrize("how", ["version 0.8", "no version"])
def test_old_files_store_the_basis_times_the_deviations(model, tmp_path, how):
    path = tmp_path / "old.h5"
    pl.write_model(model, path)

    def age(stored):
        basis = stored["model/pcaBasis"][()] * np.sqrt(stored["model/pcaVariance"][()])
        put(stored, "model/pcaBasis", basis)
        if how == "no version":
            del stored["version"]
        else:
            put(stored, "version/minorVersion", np.int32(8))

    given = np.random.default_rng(0).normal(size=model.count)
    np.testing.assert_allclose(pl.read_model(edited(path, age)).instance(given), model.instance(given), atol=1e-5)


def test_a_basis_that_is_not_orthonormal_is_taken_as_it_is(model, tmp_path):
    path = tmp_path / "a.h5"
    pl.write_model(model, path)

    def stretch(stored):
        put(stored, "model/pcaBasis", stored["model/pcaBasis"][()] * np.float32(40))
        put(stored, "model/pcaVariance", stored["model/pcaVariance"][()] / np.float32(1600))

    again = pl.read_model(edited(path, stretch))
    given = np.random.default_rng(0).normal(size=model.count)
    np.testing.assert_allclose(again.instance(given), model.instance(given), atol=1e-5)
    np.testing.assert_allclose(again.coefficients(again.instance(given)), given, atol=1e-6)
    observed = again.posterior([0, 70], model.mean[[0, 70]] + 0.1, noise=1e-2).mean
    np.testing.assert_allclose(
        observed, model.posterior([0, 70], model.mean[[0, 70]] + 0.1, noise=1e-2).mean, atol=1e-5
    )


def test_a_model_under_a_prefix_is_found(model, tmp_path):
    path = tmp_path / "face.h5"
    pl.write_model(model, path, prefix="shape")
    with h5py.File(path) as stored:
        assert "version" in stored
        assert "model" in stored["shape"]
    for prefix in (None, "shape", "/shape/"):
        np.testing.assert_array_equal(pl.read_model(path, prefix=prefix).mean, model.mean.astype(np.float32))
    with pytest.raises(UnreadableFile, match="no model under /color"):
        pl.read_model(path, prefix="color")
    with h5py.File(path, "r+") as stored:
        stored.copy("shape", "color")
    with pytest.raises(UnreadableFile, match="several models"):
        pl.read_model(path)


def test_strings_in_arrays_unsigned_cells_and_scalar_noise_are_read(model, tmp_path):
    path = tmp_path / "a.h5"
    pl.write_model(model, path)

    def vary(stored):
        put(stored, "representer/cells", stored["representer/cells"][()].astype(np.uint32))
        put(stored, "model/noiseVariance", np.float32(0.25))
        stored["representer"].attrs["datasetType"] = np.array([b"POLYGON_MESH"])
        put(stored, "modelinfo/modelBuilder-0/builderName", np.array([b"somebody"]))

    again = pl.read_model(edited(path, vary))
    np.testing.assert_array_equal(again.reference.triangles, model.reference.triangles)
    assert again.noise_variance == 0.25
    assert again.carrier.attributes["/representer"]["datasetType"] == "POLYGON_MESH"
    pl.write_model(again, path)
    with h5py.File(path) as stored:
        assert stored["modelinfo/modelBuilder-0/builderName"][()] == b"somebody"


def test_points_lines_and_tetrahedra_have_their_kinds(tmp_path):
    points = np.random.default_rng(0).normal(size=(5, 3))
    basis = FullBasis(np.ones((5, 3, 2)), np.array([2.0, 1.0]))
    cells = np.array([[0, 1, 2, 3], [1, 2, 3, 4]], np.int32)
    tetrahedra = ShapeModel(pl.PolygonMesh(points, boundary(points, cells)), points, basis, cells=cells)
    cases = {
        b"POINT_SET": ShapeModel(pl.PolygonMesh(points), points, basis),
        b"LINE_MESH": ShapeModel(pl.PolygonMesh(points, lines=Ragged.of([[0, 1, 2], [3, 4]])), points, basis),
        b"VOLUME_MESH": tetrahedra,
    }
    for kind, model in cases.items():
        path = tmp_path / "a.h5"
        pl.write_model(model, path)
        with h5py.File(path) as stored:
            assert stored["representer"].attrs["datasetType"] == kind
            assert ("cells" in stored["representer"]) == (kind != b"POINT_SET")
        again = pl.read_model(path)
        np.testing.assert_allclose(again.instance([1, 2]), model.instance([1, 2]), atol=1e-6)
    np.testing.assert_array_equal(again.cells, cells)
    assert len(again.reference.faces) == 6
    edited(path, lambda stored: stored["representer"].attrs.__setitem__("datasetType", b"POLYGON_MESH"))
    np.testing.assert_array_equal(pl.read_model(path).cells, cells)  # four rows are tetrahedra, whatever it is called


def test_the_boundary_of_tetrahedra_looks_outwards(random):
    from scipy.spatial import Delaunay

    points = random.normal(size=(40, 3))
    cells = Delaunay(points).simplices.astype(np.int32)
    cells[::2] = cells[::2, [1, 0, 2, 3]]
    corners = points[cells]
    total = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum() / 6
    surface = pl.PolygonMesh(points, boundary(points, cells))
    assert pl.volume(surface) == pytest.approx(total, rel=1e-12)


def test_losses_are_told_and_refused(box_mesh, tmp_path):
    model = pl.ShapeModel.from_kernel(box_mesh, pl.GaussianKernel(4.0, 0.3), rank=3)
    report = pl.write_model(model, tmp_path / "a.h5")
    assert [loss.split(":")[0] for loss in report.losses] == [
        "96 polygons are cut into triangles",
        "the kernel",
        "texture coordinates and attributes of the reference",
    ]
    with pytest.raises(LossRefused, match="polygons"):
        pl.write_model(model, tmp_path / "b.h5", strict=True)
    assert not (tmp_path / "b.h5").exists()
    assert not pl.write_model(pl.read_model(tmp_path / "a.h5"), tmp_path / "b.h5", strict=True).losses
    with pytest.raises(UnsupportedFormat, match=r"\.h5 or \.h5\.json"):
        pl.write_model(model, tmp_path / "a.ply")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: put(s, "model/mean", np.zeros(7, "f4")), r"model/mean has shape \(7,\); \(450,\) fits"),
        (lambda s: put(s, "model/pcaBasis", np.zeros((450, 2), "f4")), r"pcaBasis has shape"),
        (lambda s: put(s, "model/pcaVariance", np.full(24, -1, "f4")), "negative variance"),
        (lambda s: put(s, "model/mean", np.full(450, np.nan, "f4")), "not finite"),
        (lambda s: put(s, "model/mean", "words"), "no array of numbers"),
        (lambda s: put(s, "representer/points", np.zeros((4, 5), "f4")), r"\(3, N\) is expected"),
        (lambda s: put(s, "representer/cells", np.full((3, 2), 150, "i4")), "cell 0 uses vertex 150; there are 150"),
        (lambda s: put(s, "representer/cells", np.zeros((5, 2), "i4")), r"\(4, M\) is expected"),
        (lambda s: s.__delitem__("model/pcaVariance"), "there is no /model/pcaVariance"),
        (lambda s: s.__delitem__("model"), "there is no /model/mean"),
    ],
)
def test_damaged_models_are_refused_by_name(model, tmp_path, change, words):
    path = tmp_path / "a.h5"
    pl.write_model(model, path)
    with pytest.raises(UnreadableFile, match=words):
        pl.read_model(edited(path, change))


def test_files_that_are_cut_off_are_refused(written, tmp_path):
    data = written.read_bytes()
    for stop in (1, 9, 100, len(data) // 2, len(data) - 1):
        (tmp_path / "cut.h5").write_bytes(data[:stop])
        with pytest.raises(UnreadableFile):
            pl.read_model(tmp_path / "cut.h5")


def test_fields_of_a_scalar_kernel_are_found_to_be_so(model, tmp_path):
    pl.write_model(model, tmp_path / "a.h5")
    again = pl.read_model(tmp_path / "a.h5")
    assert again.basis.scalar
    assert again.rank == model.rank
    pl.write_model(again.posterior([0], model.mean[:1], noise=np.diag([1.0, 2, 3])), tmp_path / "b.h5")
    assert not pl.read_model(tmp_path / "b.h5").basis.scalar
