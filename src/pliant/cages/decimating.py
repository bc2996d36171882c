"""Fewer triangles by libigl, which keeps the interpreter from all other threads meanwhile.

In the main thread that harms nobody. Beside others, as in a studio that answers while it builds a cage, it happens in
a process of its own: ``python -m pliant.cages.decimating FILE``, which reads FILE.npz and puts the result in its place.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.cages.extras import import_igl
from pliant.mesh import Points

Triangles = NDArray[np.int64]


def decimated(points: Points, triangles: Triangles, faces: int, *, careful: bool) -> tuple[Points, Triangles]:
    """A surface with fewer faces, by quadrics (Garland & Heckbert 1997).

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3), closed.
    faces
        How many triangles are left at most, if the shape allows it.
    careful
        Whether no faces may cut one another.
    """
    import_igl()  # else its absence is told here
    if threading.current_thread() is threading.main_thread():
        return _decimated(points, triangles, faces, careful)
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        file = Path(folder, "surface.npz")
        np.savez(file, points=points, triangles=triangles, faces=faces, careful=careful)
        done = subprocess.run([sys.executable, "-m", __name__, str(file)], capture_output=True, check=False)  # noqa: S603
        if done.returncode:  # this machine starts no processes
            return _decimated(points, triangles, faces, careful)
        with np.load(file) as found:
            return found["points"], found["triangles"]


def _decimated(points: Points, triangles: Triangles, faces: int, careful: bool) -> tuple[Points, Triangles]:
    given = np.asfortranarray(points), np.asfortranarray(triangles.astype(np.int32))
    found, corners, _, _ = import_igl().qslim(*given, max_m=max(faces, 4), block_intersections=careful)
    used = np.unique(corners)
    place = np.full(len(found), -1)
    place[used] = np.arange(len(used))
    return np.ascontiguousarray(found[used]), np.ascontiguousarray(place[corners], np.int64)


def main(file: str) -> None:
    """Decimate the surface of a file."""
    with np.load(file) as given:
        points, triangles = given["points"], given["triangles"]
        left, corners = _decimated(points, triangles, int(given["faces"]), bool(given["careful"]))
    np.savez(file, points=left, triangles=corners)


if __name__ == "__main__":
    main(sys.argv[1])
