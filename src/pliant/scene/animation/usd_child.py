"""A process of its own in which USD reads one motion, so that a damaged file harms nobody.

Called as ``python -m pliant.scene.animation.usd_child FILE OUT FPS BYTES SECONDS``, like its siblings for meshes.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.polydata_child import Refused, hand_over, limit, refusing


def main(path: str, out: str, fps: float, memory: int, seconds: int) -> int:
    """Read a file within limits; returns the exit code."""
    limit(memory, seconds)
    with refusing():
        points, times = read(path, fps)
        hand_over(out, {"points": points, "times": times}, {})
    return 0


def read(path: str, fps: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(k, n, 3) the points of all meshes, and the (k,) times in seconds."""
    import pxr
    from pxr import Tf, Usd, UsdGeom  # noqa: F401  (makes them attributes of pxr)

    stage = pxr.Usd.Stage.Open(path)
    meshes = [pxr.UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(pxr.UsdGeom.Mesh)]
    codes = sorted({code for mesh in meshes for code in _samples(pxr, mesh)})
    if not meshes or not codes:
        raise Refused("it holds no mesh whose points move")
    frames = [np.concatenate([_world(pxr, mesh, code) for mesh in meshes]) for code in codes]
    if len({len(frame) for frame in frames}) > 1:
        raise Refused("its number of points changes over time: that is not one mesh that moves")
    return np.stack(frames), np.array(codes) / (stage.GetTimeCodesPerSecond() or fps)


def _samples(pxr: Any, mesh: Any) -> list[float]:
    """The times at which a mesh or a node above it changes."""
    times = list(mesh.GetPointsAttr().GetTimeSamples())
    prim = mesh.GetPrim()
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(pxr.UsdGeom.Xformable):
            times += pxr.UsdGeom.Xformable(prim).GetTimeSamples()
        prim = prim.GetParent()
    return times


def _world(pxr: Any, mesh: Any, code: float) -> NDArray[np.float64]:
    points = mesh.GetPointsAttr().Get(code)
    if points is None:
        raise Refused(f"the mesh {mesh.GetPath()} has no points at time {code:g}")
    matrix = np.array(pxr.UsdGeom.Imageable(mesh).ComputeLocalToWorldTransform(code), np.float64)
    placed: NDArray[np.float64] = np.asarray(points, np.float64).reshape(-1, 3) @ matrix[:3, :3] + matrix[3, :3]
    return placed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], float(sys.argv[3]), int(sys.argv[4]), int(sys.argv[5])))
