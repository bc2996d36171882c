"""Space deformers against their peers: `python benchmarks/space.py`."""

from __future__ import annotations

import importlib.util
import subprocess
import sys

import numpy as np
from threadpoolctl import threadpool_limits

from measure import Comparison, report
from pliant.numerics.lattices.bases import bernstein
from pliant.space.bend import Bend
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.sine import Sine
from pliant.space.squash import Squash
from pliant.space.taper import Taper
from pliant.space.thin_plate_spline import ThinPlateSpline
from pliant.space.twist import Twist
from pliant.space.wave import Wave

RANDOM = np.random.default_rng(0)
POINTS = RANDOM.random((1_000_000, 3))


def bspline_comparisons() -> list[Comparison]:
    """8 x 8 x 8 spans, a million random points: bind and evaluate, evaluate again, move one control point."""
    lattice = BSplineFFD.around(POINTS, shape=(9, 9, 9))
    moves = [lattice.rest + RANDOM.normal(size=lattice.rest.shape) * 0.01 for _ in range(2)]
    bound, out = lattice.bind(POINTS), np.empty_like(POINTS)
    vtk_cold, vtk_again = vtk_bspline(moves[0] - lattice.rest, lattice)
    bent = lattice.moved(moves[0])
    expected = bent(POINTS)
    for name, result in (("VTK", vtk_cold()), ("SciPy", scipy_bspline(moves[0] - lattice.rest, lattice)())):
        assert np.abs(result - expected).max() < 1e-12, name
    drag, controls = bound.drag(lattice.rest), lattice.rest.copy()

    def move_one() -> None:
        controls[4, 4, 4] += 1e-4
        drag.update(controls, changed=[(4, 4, 4)])

    return [
        Comparison(
            "cubic B-spline, 8³ spans, 1M points: bind and evaluate",
            {
                "pliant, one call": lambda: bent(POINTS),
                "pliant, bind then deform": lambda: bent.bind(POINTS).deform(),
                "VTK": vtk_cold,
                "SciPy NdBSpline": scipy_bspline(moves[0] - lattice.rest, lattice),
                "splinepy": splinepy_bspline(moves[0], lattice),
                "a copy of the points": POINTS.copy,
            },
            repeat=3,
        ),
        Comparison(
            "the same, bound: all control points moved, ten moves in a row",
            {"pliant": lambda: bound.deform(moves[1], out=out), "VTK": vtk_again},
            repeat=10,
        ),
        Comparison(
            "the same, bound: one control point moved, twenty moves in a row",
            {"pliant, drag": move_one, "pliant, all anew": lambda: bound.deform(moves[1], out=out), "VTK": vtk_again},
            repeat=20,
        ),
    ]


def bezier_comparisons() -> list[Comparison]:
    """One hyperpatch of degree 3, and one of degree 9."""
    results = []
    for size, points in ((4, POINTS), (10, POINTS[:200_000])):
        lattice = BezierFFD.around(points, shape=(size,) * 3, outside="extend")
        controls = lattice.rest + RANDOM.normal(size=lattice.rest.shape) * 0.01
        gemm, peer = numpy_bezier(controls, lattice, points), splinepy_bezier(controls, points)
        bound, out = lattice.bind(points), np.empty_like(points)
        for result in (gemm(), peer()):
            assert np.abs(result - bound.deform(controls)).max() < 1e-10
        results.append(
            Comparison(
                f"Bézier degree {size - 1}, {len(points):,} points, bound",
                {
                    "pliant": lambda b=bound, c=controls, o=out: b.deform(c, out=o),
                    "NumPy GEMM, one BLAS thread": gemm,
                    "splinepy": peer,
                },
                rounds=5,
            )
        )
    return results


def barr_comparisons() -> list[Comparison]:
    """A twist of a million points, with Jacobians too; what its siblings cost beside it."""
    twist = Twist.around(POINTS, axis="z", angle=1.5)
    (low, high), origin = twist.bounds, np.asarray(twist.origin)

    def numpy_twist(points=POINTS):
        theta = 1.5 * np.clip((points[:, 2] - low) / (high - low), 0, 1)
        cosine, sine = np.cos(theta), np.sin(theta)
        x, y = points[:, 0] - origin[0], points[:, 1] - origin[1]
        turned = (cosine * x - sine * y + origin[0], sine * x + cosine * y + origin[1], points[:, 2])
        return np.stack(turned, axis=1)

    def numexpr_twist():
        import numexpr

        out, theta = np.empty_like(POINTS), "(a * where(z < l, 0, where(z > h, 1, (z - l) / (h - l))))"
        names = {"x": POINTS[:, 0], "y": POINTS[:, 1], "z": POINTS[:, 2], "l": low, "h": high, "a": 1.5}
        names |= {"p": origin[0], "q": origin[1]}
        numexpr.evaluate(f"cos({theta}) * (x - p) - sin({theta}) * (y - q) + p", names, out=out[:, 0])
        numexpr.evaluate(f"sin({theta}) * (x - p) + cos({theta}) * (y - q) + q", names, out=out[:, 1])
        out[:, 2] = POINTS[:, 2]
        return out

    def differences():
        step = 1e-6
        ahead = [numpy_twist(POINTS + step * e) - numpy_twist(POINTS - step * e) for e in np.eye(3)]
        return np.stack(ahead, axis=2) / (2 * step)

    for peer in (numpy_twist, numexpr_twist):
        assert np.abs(peer() - twist(POINTS)).max() < 1e-13
    siblings = {
        "Taper": Taper.around(POINTS, factor=0.5),
        "Bend": Bend.around(POINTS, angle=0.5),
        "Sine": Sine.around(POINTS, amplitude=0.1),
        "Wave": Wave.around(POINTS, amplitude=0.1),
        "Squash": Squash.around(POINTS, factor=0.7),
    }
    return [
        Comparison(
            "twist, 1M points",
            {
                "pliant": lambda: twist(POINTS),
                "numexpr": numexpr_twist,
                "NumPy": numpy_twist,
                "a copy of the points": POINTS.copy,
            },
            rounds=11,
        ),
        Comparison(
            "the same, with Jacobians",
            {
                "pliant": lambda: (twist(POINTS), twist.jacobian(POINTS)),
                "NumPy and central differences": lambda: (numpy_twist(), differences()),
            },
            rounds=5,
        ),
        Comparison(
            "its siblings, 1M points",
            {"Twist": lambda: twist(POINTS)} | {name: lambda d=d: d(POINTS) for name, d in siblings.items()},
        ),
    ]


def landmark_comparisons() -> list[Comparison]:
    """A thin-plate spline through 200 landmarks at 100,000 points: the system solved, and the points warped."""
    import warnings

    import morphops
    from scipy.interpolate import RBFInterpolator

    points, landmarks = POINTS[:100_000], RANDOM.random((200, 3))
    targets = landmarks + 0.05 * RANDOM.normal(size=landmarks.shape)
    bound = ThinPlateSpline(landmarks, targets).bind(points)

    def scipy_spline():
        return points + RBFInterpolator(landmarks, targets - landmarks, kernel="linear", degree=1)(points)

    def morphops_spline():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            return morphops.tps_warp(landmarks, targets, points)

    for peer in (scipy_spline, morphops_spline):
        assert np.abs(peer() - bound.deform()).max() < 1e-11
    return [
        Comparison(
            "thin-plate spline, 200 landmarks, 100k points",
            {
                "pliant": lambda: ThinPlateSpline(landmarks, targets)(points),
                "pliant, bound": bound.deform,
                "morphops": morphops_spline,
                "SciPy RBFInterpolator": scipy_spline,
            },
            rounds=5,
        )
    ]


def free_lattice_comparisons() -> list[Comparison]:
    """200 sites anywhere and a cylindrical lattice, 100,000 points: binding, evaluating, moving one control."""
    from pliant.space.dirichlet_ffd import DirichletFFD
    from pliant.space.extended_ffd import ExtendedFFD

    sites, points = np.random.default_rng(0).random((200, 3)), POINTS[:100_000]
    inner = (np.abs(points - 0.5) < 0.2).all(axis=1)
    kinds = {"Sibson": {}, "Laplace": {"coordinates": "laplace"}, "Farin": {"smooth": True}}
    dirichlet = {name: DirichletFFD(sites, **options) for name, options in kinds.items()}
    bound = {name: deformer.bind(points) for name, deformer in dirichlet.items()}
    for name in ("Sibson", "Laplace"):
        assert np.abs(bound[name].matrix() @ sites - points)[inner].max() < 1e-12, name
    drag, controls = bound["Sibson"].drag(sites), sites.copy()
    drum = ExtendedFFD.cylinder(points, shape=(8, 4, 4))
    drum_bound, out = drum.bind(points), np.empty_like(points)

    def move_one() -> None:
        controls[17] += 1e-4
        drag.update(controls, changed=[17])

    return [
        Comparison(
            "Dirichlet FFD, 200 sites, 100k points: bind",
            {
                "pliant, Sibson": lambda: DirichletFFD(sites).bind(points),
                "pliant, Laplace": lambda: DirichletFFD(sites, coordinates="laplace").bind(points),
                "pliant, Farin's C1 form": lambda: DirichletFFD(sites, smooth=True).bind(points),
                **natinterp3d_weights(sites, points),
                "SciPy Delaunay, linear weights": lambda: scipy_linear_weights(sites, points),
            },
            rounds=5,
        ),
        Comparison(
            "the same, bound: one site moved",
            {"pliant, drag": move_one, "pliant, all anew": lambda: bound["Sibson"].deform(controls, out=out)},
        ),
        Comparison(
            "extended FFD, a cylinder of 8 x 4 x 4 control points, 100k points",
            {
                "pliant, bind": lambda: drum.bind(points),
                "pliant, bound": lambda: drum_bound.deform(drum.rest, out=out),
            },
            rounds=5,
        ),
    ]


def natinterp3d_weights(sites, points):
    """The same weights by natinterp3d, where it is installed: GPL, so that nothing here asks for it."""
    if importlib.util.find_spec("natinterp3d") is None:
        return {}
    from natinterp3d import get_weights

    return {"natinterp3d, Sibson": lambda: get_weights(points, sites)}


def scipy_linear_weights(sites, points):
    """Barycentric weights in the Delaunay tetrahedra: four sites a point, and kinks at every face."""
    from scipy.spatial import Delaunay

    mesh = Delaunay(sites)
    cell = mesh.find_simplex(points)
    frame = mesh.transform[cell]
    weights = np.einsum("nij,nj->ni", frame[:, :3], points - frame[:, 3])
    return mesh.simplices[cell], np.column_stack([weights, 1 - weights.sum(axis=1)])


def vtk_bspline(displacements, lattice):
    """vtkBSplineTransform as shipped, through vtkTransformFilter."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
    from vtkmodules.vtkFiltersGeneral import vtkTransformFilter
    from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform

    def build():
        image = vtkImageData()
        image.SetDimensions(*lattice.shape)
        image.SetSpacing(*lattice.spacing)
        image.SetOrigin(*lattice.origin)
        flat = np.ascontiguousarray(displacements.transpose(2, 1, 0, 3)).reshape(-1, 3)
        image.GetPointData().SetScalars(numpy_to_vtk(flat, deep=1))
        transform = vtkBSplineTransform()
        transform.SetCoefficientData(image)
        transform.SetBorderModeToEdge()
        points = vtkPoints()
        points.SetData(numpy_to_vtk(POINTS))
        data = vtkPolyData()
        data.SetPoints(points)
        apply = vtkTransformFilter()
        apply.SetInputData(data)
        apply.SetTransform(transform)
        return image, transform, apply

    def run(parts):
        parts[2].Update()
        return vtk_to_numpy(parts[2].GetOutput().GetPoints().GetData())

    kept = build()

    def again():
        kept[0].GetPointData().GetScalars().Modified()
        kept[0].Modified()
        kept[1].Modified()
        return run(kept)

    return lambda: run(build()), again


def scipy_bspline(displacements, lattice):
    from scipy.interpolate import NdBSpline

    padded = np.pad(displacements, [(2, 2)] * 3 + [(0, 0)], mode="edge")
    spline = NdBSpline(knots(lattice), padded, 3)
    return lambda: POINTS + spline(POINTS)


def knots(lattice):
    """The knots of a lattice with two more layers on each side: peers know no clamped edge."""
    return tuple(
        origin + spacing * (np.arange(count + 8) - 4)
        for origin, spacing, count in zip(lattice.origin, lattice.spacing, lattice.shape, strict=True)
    )


def splinepy_bspline(controls, lattice):
    import splinepy

    padded = np.pad(controls, [(2, 2)] * 3 + [(0, 0)], mode="edge")
    flat = padded.transpose(2, 1, 0, 3).reshape(-1, 3)
    spline = splinepy.BSpline(degrees=[3] * 3, knot_vectors=[k.tolist() for k in knots(lattice)], control_points=flat)
    return lambda: spline.evaluate(POINTS, nthreads=2)


def splinepy_bezier(controls, points):
    import splinepy

    low, high = points.min(axis=0), points.max(axis=0)
    flat = controls.transpose(2, 1, 0, 3).reshape(-1, 3)
    patch = splinepy.Bezier(degrees=[n - 1 for n in controls.shape[:3]], control_points=flat)
    return lambda: patch.evaluate((points - low) / (high - low), nthreads=2)


def numpy_bezier(controls, lattice, points):
    """As PyGeM does it, but contracted one axis at a time by matrix products."""
    inverse = np.linalg.inv(lattice.edges)

    def run():
        out = np.empty_like(points)
        a, b, c = (size - 1 for size in controls.shape[:3])
        with threadpool_limits(1, "blas"):
            for first in range(0, len(points), 8192):
                t = (points[first : first + 8192] - lattice.origin) @ inverse.T
                along = bernstein(c, t[:, 2]) @ controls.transpose(2, 0, 1, 3).reshape(c + 1, -1)
                plane = np.einsum("nj,nijc->nic", bernstein(b, t[:, 1]), along.reshape(len(t), a + 1, b + 1, 3))
                out[first : first + 8192] = np.einsum("ni,nic->nc", bernstein(a, t[:, 0]), plane)
        return out

    return run


def memory_note() -> str:
    """Peak memory of ten million points, in a process of its own."""
    code = (
        "import resource, numpy as np\n"
        "from pliant.space.bspline_ffd import BSplineFFD\n"
        "small = np.random.default_rng(0).random((1000, 3))\n"
        "BSplineFFD.around(small, shape=(9, 9, 9)).bind(small).deform()\n"
        "points = np.random.default_rng(0).random((10_000_000, 3))\n"
        "points.flags.writeable = False\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "lattice = BSplineFFD.around(points, shape=(9, 9, 9))\n"
        "out = lattice.moved(lattice.rest * 1.01).bind(points).deform()\n"
        "after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "print((after - before) / 2**20 - out.nbytes / 2**30)\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return f"Ten million points, bound and evaluated: {float(result.stdout):.2f} GiB beyond input and output."


def compile_note() -> str:
    """Time of the first use of every lattice kernel, with an empty cache."""
    code = (
        "import os, tempfile, time\n"
        "os.environ['NUMBA_CACHE_DIR'] = tempfile.mkdtemp()\n"
        "import numba, numpy as np\n"
        "from pliant.space.bspline_ffd import BSplineFFD\n"
        "from pliant.space.bezier_ffd import BezierFFD\n"
        "points = np.random.default_rng(0).random((100, 3))\n"
        "start = time.perf_counter()\n"
        "for kind in (BSplineFFD.around(points), BezierFFD.around(points, shape=(3, 3, 3))):\n"
        "    kind(points)\n"
        "    bound = kind.bind(points)\n"
        "    bound.deform(), bound.vjp(None, points), kind.jacobian(points)\n"
        "    moved = kind.rest.copy(); moved[1, 1, 1] += 1; bound.drag().update(moved)\n"
        "print(time.perf_counter() - start)\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return (
        f"First use of every lattice kernel with an empty cache, numba itself imported: {float(result.stdout):.1f} s."
    )


if __name__ == "__main__":
    comparisons = bspline_comparisons() + bezier_comparisons() + barr_comparisons() + landmark_comparisons()
    comparisons += free_lattice_comparisons()
    print(
        report(
            "Space deformers",
            comparisons,
            ["pliant", "numpy", "numba", "vtk", "scipy", "splinepy", "numexpr", "morphops"],
            [compile_note(), memory_note()],
        )
    )
