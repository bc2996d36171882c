"""Shape models against a dense NumPy implementation: `python benchmarks/shape.py [FEMUR_MODEL TARGET]`.

The dense peer keeps all three coordinates of every field, as implementations do that know no scalar kernels.
"""

from __future__ import annotations

import sys

import numpy as np

import pliant as pl
from measure import Comparison, report
from pliant.shape.basis import ScalarBasis

RANDOM = np.random.default_rng(0)


def sphere(count):
    points = RANDOM.normal(size=(count, 3))
    return pl.PolygonMesh(points / np.linalg.norm(points, axis=1, keepdims=True) * [1, 2, 3])


def low_rank_comparison():
    mesh, kernel = sphere(50_000), pl.GaussianKernel(0.8, 0.1)

    def dense(rank=200):
        """Nyström with vectors for each coordinate: three times the memory, nine times the products."""
        samples = mesh.points[RANDOM.choice(len(mesh.points), 2 * rank, replace=False)]
        values, vectors = np.linalg.eigh(np.kron(kernel.block(samples, samples), np.eye(3)))
        chosen = vectors[:, -3 * rank :] / np.sqrt(np.maximum(values[-3 * rank :], 1e-9))
        blocks = [
            np.kron(kernel.block(mesh.points[i : i + 5000], samples), np.eye(3)) @ chosen
            for i in range(0, 50_000, 5000)
        ]
        return np.vstack(blocks)

    return Comparison(
        "50,000 points, Gaussian kernel: scalar rank 200",
        {"pliant, pivoted Cholesky": lambda: pl.ShapeModel.from_kernel(mesh, kernel, rank=200), "NumPy, dense": dense},
        rounds=3,
    )


def posterior_comparisons():
    mesh = sphere(150_000)
    basis = ScalarBasis(RANDOM.normal(size=(150_000, 40)) / 40, np.ones(40))
    model = pl.ShapeModel(mesh, mesh.points, basis)
    full = pl.ShapeModel(mesh, mesh.points, basis.turned(np.eye(3)).combined(np.eye(120)[:, :40], np.ones(40)))
    ids = RANDOM.choice(150_000, 1000, replace=False)
    seen = mesh.points[ids] + 0.01
    columns = full.basis.columns().reshape(-1, 40)

    def dense():
        rows = columns.reshape(-1, 3, 40)[ids].reshape(-1, 40)
        right = rows.T @ (seen - mesh.points[ids]).reshape(-1) / 1e-4
        return mesh.points + (columns @ np.linalg.solve(np.eye(40) + rows.T @ rows / 1e-4, right)).reshape(-1, 3)

    assert np.abs(dense() - full.posterior_mean(ids, seen, noise=0.01)).max() < 1e-9
    return [
        Comparison(
            "150,000 points, rank 40, 1000 observations: posterior model (published: 900 ms)",
            {"pliant, scalar fields": lambda: model.posterior(ids, seen, noise=0.01)},
        ),
        Comparison(
            "the same: most likely shape (published: 90 ms)",
            {
                "pliant, scalar fields": lambda: model.posterior_mean(ids, seen, noise=0.01),
                "pliant, full fields": lambda: full.posterior_mean(ids, seen, noise=0.01),
                "NumPy, dense": dense,
            },
        ),
    ]


def sample_comparison():
    mesh = sphere(50_000)
    basis = ScalarBasis(RANDOM.normal(size=(50_000, 200)) / 200, np.ones(200))
    model = pl.ShapeModel(mesh, mesh.points, basis)
    return Comparison(
        "1000 samples of 50,000 points, 600 coefficients",
        {
            "pliant, float32": lambda: model.sample(1000, seed=0, dtype=np.float32),
            "pliant, float64": lambda: model.sample(1000, seed=0),
        },
        rounds=3,
    )


def femur_comparisons(model_path, target_path):
    model, target = pl.read_model(model_path), pl.read(target_path)
    fitted = model.fit(target, pose="rigid")
    back = target.with_points((target.points - fitted.pose[:3, 3]) @ fitted.pose[:3, :3])
    density = pl.ClosestPointDensity(model, back, noise=1.0)
    steps = pl.Mixture([density.proposal(0.5), density.proposal(0.1), pl.RandomWalk(0.02)], [0.6, 0.3, 0.1])
    starts = np.vstack([np.zeros(model.count), 0.5 * RANDOM.normal(size=(2, model.count))])
    chains = pl.metropolis_hastings(density, steps, starts, 1500, seed=0)
    late = chains.samples[:, 500:]
    away = [pl.ClosestPointDensity(model, back, 1.0, 400).distances(each[-1]).mean() for each in late]
    facts = (
        f"R-hat {pl.r_hat(late).max():.2f}, {pl.effective_sample_size(late).min():.0f} effective samples of "
        f"{late.shape[0] * late.shape[1]}, acceptance {chains.acceptance.mean():.2f}, {max(away):.2f} mm apart"
    )
    return [
        Comparison(
            f"femur, GP-ICP with a pose, 50 rounds (reaches {fitted.distance:.2f} mm)",
            {"pliant": lambda: model.fit(target, pose="rigid")},
        ),
        Comparison(
            f"femur, 100 steps of a chain with closest-point proposals (published: 62,000 ms; three chains: {facts})",
            {"pliant": lambda: pl.metropolis_hastings(density, steps, fitted.coefficients, 100, seed=0)},
        ),
    ]


if __name__ == "__main__":
    comparisons = [low_rank_comparison(), *posterior_comparisons(), sample_comparison()]
    if len(sys.argv) == 3:
        comparisons += femur_comparisons(*sys.argv[1:])
    print(report("Shape models", comparisons, ["pliant", "numpy", "scipy", "numba"]))
