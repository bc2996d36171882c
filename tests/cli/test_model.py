"""``pliant model``: what each command writes is what the library computes."""

import json

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.shape.kernel_text import parse_kernel


@pytest.fixture
def built(run, cube, tmp_path):
    path = tmp_path / "model.h5"
    done = run("model", "build", cube, "--kernel", "gaussian(sigma=9, scale=1)", "--rank", 6, "-o", path, "--json")
    assert done.exit_code == 0, done.stderr
    return path, json.loads(done.stdout)


def test_build_makes_the_model_of_the_kernel(built, cube):
    path, facts = built
    model, expected = pl.read_model(path), pl.ShapeModel.from_kernel(pl.read(cube), pl.GaussianKernel(9, 1), rank=6)
    np.testing.assert_allclose(model.variances, expected.variances, rtol=1e-6)
    assert facts["rank"] == 6
    assert facts["coefficients"] == 18


def test_samples_are_those_of_the_seed(run, built, tmp_path):
    path, _ = built
    assert run("model", "sample", path, "-n", 3, "--seed", 7, "-o", tmp_path / "s.ply").exit_code == 0
    expected = pl.read_model(path).sample(3, seed=7)
    for number in (1, 2, 3):
        np.testing.assert_allclose(pl.read(tmp_path / f"s-{number}.ply").points, expected[number - 1], atol=1e-6)


def test_posterior_matches_landmarks_by_name(run, built, tmp_path):
    path, _ = built
    (tmp_path / "a.csv").write_text("left,0,0,0\nright,10,0,0\nmiddle,5,5,5\n")
    (tmp_path / "b.csv").write_text("right,11,0,0\nleft,0,0,0\n")
    done = run(
        "model", "posterior", path, "--landmarks", tmp_path / "a.csv", tmp_path / "b.csv", "--noise", 0.01,
        "-o", tmp_path / "p.h5",
    )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    mean = pl.read_model(tmp_path / "p.h5").mean
    np.testing.assert_allclose(mean[:2], [[0, 0, 0], [11, 0, 0]], atol=0.02)
    (tmp_path / "b.csv").write_text("nose,11,0,0\n")
    done = run(
        "model", "posterior", path, "--landmarks", tmp_path / "a.csv", tmp_path / "b.csv", "-o", tmp_path / "q.h5"
    )
    assert done.exit_code == 2
    assert "no landmark name in common" in done.stderr


def test_fit_writes_the_shape_that_it_found(run, built, tmp_path):
    path, _ = built
    model = pl.read_model(path)
    target = model.reference.with_points(model.instance(0.3 * np.ones(model.count)))
    pl.write(target, tmp_path / "t.ply")
    done = run("model", "fit", path, tmp_path / "t.ply", "-o", tmp_path / "f.ply", "--pose", "none", "--json")
    assert done.exit_code == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["distance"] < 0.05
    np.testing.assert_allclose(pl.read(tmp_path / "f.ply").points, model.instance(told["coefficients"]), atol=1e-5)


def test_pca_learns_from_meshes(run, built, tmp_path):
    model = pl.read_model(built[0])
    files = []
    for number, points in enumerate(model.sample(5, seed=0)):
        files.append(tmp_path / f"{number}.ply")
        pl.write(model.reference.with_points(points), files[-1])
    assert run("model", "pca", *files, "-o", tmp_path / "learnt.h5").exit_code == 0
    learnt = pl.learn_model([pl.read(each) for each in files])
    np.testing.assert_allclose(pl.read_model(tmp_path / "learnt.h5").variances, learnt.variances, rtol=1e-5)


def test_convert_and_info(run, built, tmp_path):
    path, _ = built
    assert run("model", "convert", path, tmp_path / "m.h5.json").exit_code == 0
    told = [json.loads(run("model", "info", each, "--json").stdout) for each in (path, tmp_path / "m.h5.json")]
    assert told[0]["points"] == 8
    assert {**told[0], "file": 0} == {**told[1], "file": 0}
    assert "coefficients" in run("model", "info", path).stdout


@pytest.mark.parametrize(
    ("text", "kernel"),
    [
        ("gaussian(50, 10)", pl.GaussianKernel(50, 10)),
        ("gaussian(sigma=50, scale=10) + bspline(support=20)", pl.GaussianKernel(50, 10) + pl.BSplineKernel(20)),
        ("0.5 * matern(3, smoothness=1.5)", 0.5 * pl.MaternKernel(3, smoothness=1.5)),
        ("exponential(2) * gaussian(3)", pl.ExponentialKernel(2) * pl.GaussianKernel(3)),
        ("multi_scale(8, 1, levels=3)", pl.BSplineKernel.multi_scale(8, 1, 3)),
    ],
)
def test_kernels_are_read_from_text(text, kernel):
    assert parse_kernel(text) == kernel


@pytest.mark.parametrize(
    "text",
    [
        "",
        "3",
        "gauss(3)",
        "gaussian(",
        "gaussian('a')",
        "gaussian(width=3)",
        "__import__('os')",
        "gaussian(3) - 1",
        "-1",
    ],
)
def test_what_is_no_kernel_is_refused(text, run, cube, tmp_path):
    with pytest.raises(InvalidParameter):
        parse_kernel(text)
    assert run("model", "build", cube, "--kernel", text, "-o", tmp_path / "m.h5").exit_code == 2
