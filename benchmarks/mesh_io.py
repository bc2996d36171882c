"""Reading and writing meshes: pliant against trimesh, meshio and, for .vtp, VTK itself.

    python benchmarks/mesh_io.py [--triangles 1000000] [--repeats 5]

All run in one process, interleaved; medians of wall time, files in a temporary folder, in the page cache. Every
peer reads the same file and writes the same mesh, to a file that is not there yet; trimesh's cached normals are
dropped before it writes. Ratios are peer over pliant: above 1, pliant is faster.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import meshio
import numpy as np
import pyvista as pv
import trimesh
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import pliant as pl

Action = Callable[[], object]
FORMATS = {"obj": "obj", "ply": "ply", "stl": "stl", "off": "off", "glb": "glb"}


def grid(triangles: int) -> pl.PolygonMesh:
    """A bumpy square sheet of about so many triangles, half as many vertices."""
    n = round((triangles / 2) ** 0.5) + 1
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    points = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], axis=-1).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1, 1)
    faces = np.concatenate([corner + np.array(step) for step in ([0, n, n + 1], [0, n + 1, 1])])
    return pl.PolygonMesh(points, faces)


def measure(actions: dict[str, Action], repeats: int, written: Path | None = None) -> dict[str, float]:
    """Median wall seconds of each, one after the other in every round; the first round does not count.

    What was left in the folder ``written`` is removed before each, outside the timing.
    """
    times: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(repeats + 1):
        for name, action in actions.items():
            for old in written.glob("*.*") if written else ():
                old.unlink()
            begin = time.perf_counter()
            action()
            times[name].append(time.perf_counter() - begin)
    return {name: statistics.median(each[1:]) for name, each in times.items()}


def readers(path: Path) -> dict[str, Action]:
    return {
        "pliant": lambda: pl.read(path),
        "trimesh": lambda: trimesh.load(path, process=False, force="mesh"),
        **({} if path.suffix == ".glb" else {"meshio": lambda: meshio.read(path)}),
    }


def writers(mesh: pl.PolygonMesh, folder: Path, ending: str) -> dict[str, Action]:
    other = trimesh.Trimesh(mesh.points, mesh.triangles, process=False)
    third = meshio.Mesh(mesh.points, [("triangle", mesh.triangles)])
    options = {"binary": True} if ending in ("stl", "ply") else {}
    path = folder / "written" / f"mesh.{ending}"
    return {
        "pliant": lambda: pl.write(mesh, path),
        "trimesh": lambda: (other._cache.clear(), other.export(path)),
        **({} if ending == "glb" else {"meshio": lambda: meshio.write(path, third, **options)}),
    }


def moved_writers(mesh: pl.PolygonMesh, folder: Path, ending: str) -> dict[str, Action]:
    """The write that follows a deformation: every point has moved, all else stays as the file had it."""
    path = folder / f"source.{ending}"
    read = pl.read(path)
    moved = read.with_points(read.points * 1.0001)
    return {"pliant": lambda: pl.write(moved, folder / "written" / path.name), **_peers(writers(mesh, folder, ending))}


def _peers(actions: dict[str, Action]) -> dict[str, Action]:
    return {name: action for name, action in actions.items() if name != "pliant"}


VTK_READS = """
import sys
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
reader = vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
mesh = reader.GetOutput()
vtk_to_numpy(mesh.GetPoints().GetData()), vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())
"""


def vtk_actions(mesh: pl.PolygonMesh, folder: Path) -> tuple[dict[str, Action], dict[str, Action]]:
    """Reading and writing .vtp, against VTK's own reader, in a new process as ours, and writer."""
    source = folder / "source.vtp"
    pl.write(mesh, source)
    data = pv.read(source)

    def vtk_read(path: Path) -> object:
        return subprocess.run([sys.executable, "-c", VTK_READS, str(path)], check=True)

    def vtk_write() -> object:
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(folder / "written" / "vtk.vtp"))
        writer.SetInputData(data)
        return writer.Write()

    pl.write(pl.PolygonMesh(np.eye(3), [[0, 1, 2]]), folder / "tiny.vtp")
    tiny = folder / "tiny.vtp"
    read = {
        "pliant": lambda: pl.read(source),
        "pliant, start": lambda: pl.read(tiny),
        "VTK": lambda: vtk_read(source),
        "VTK, start": lambda: vtk_read(tiny),
    }
    return read, {"pliant": lambda: pl.write(mesh, folder / "written" / "pliant.vtp"), "VTK": vtk_write}


def row(what: str, ending: str, times: dict[str, float]) -> str:
    own = times["pliant"]
    cells = [
        f"{times[name]:.3f} ({times[name] / own:.1f}×)" if name in times else "–"
        for name in ("trimesh", "meshio", "VTK")
    ]
    return f"| {what} {ending.upper()} | {own:.3f} | " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--formats", nargs="*", default=[*FORMATS, "vtp"])
    options = parser.parse_args()
    mesh = grid(options.triangles)
    print(
        f"{datetime.date.today()}, `python {' '.join(sys.argv)}`, {platform.processor() or platform.machine()}, "
        f"{os.cpu_count()} cores, Python {platform.python_version()}, "
        + ", ".join(f"{name} {version(name)}" for name in ("pliant", "numpy", "trimesh", "meshio", "vtk"))
    )
    print(f"{len(mesh.points):,} vertices, {len(mesh.faces):,} triangles; seconds, and the peer's time over pliant's\n")
    print("| | pliant | trimesh | meshio | VTK |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        written = folder / "written"
        written.mkdir()
        for ending in options.formats:
            if ending == "vtp":
                read, write = vtk_actions(mesh, folder)
                times = measure(read, options.repeats)
                for name in ("pliant", "VTK"):
                    times[name] -= times.pop(f"{name}, start")
                print(row("read, in a new process each, less its start,", ending, times), flush=True)
                print(row("write", ending, measure(write, options.repeats, written)), flush=True)
                continue
            pl.write(mesh, folder / f"source.{ending}")
            print(row("read", ending, measure(readers(folder / f"source.{ending}"), options.repeats)), flush=True)
            print(row("write", ending, measure(writers(mesh, folder, ending), options.repeats, written)), flush=True)
            moved = moved_writers(mesh, folder, ending)
            print(row("write back, moved,", ending, measure(moved, options.repeats, written)), flush=True)


if __name__ == "__main__":
    main()
