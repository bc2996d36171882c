"""A process of its own in which Alembic reads one motion, so that a damaged file harms nobody.

Called as ``python -m pliant.scene.animation.alembic_child FILE OUT KIND BYTES SECONDS``, like its siblings for meshes.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.polydata_child import Refused, hand_over, limit, refusing


def main(path: str, out: str, memory: int, seconds: int) -> int:
    """Read a file within limits; returns the exit code."""
    limit(memory, seconds)
    with refusing():
        points, times = read(path)
        hand_over(out, {"points": points, "times": times}, {})
    return 0


def read(path: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(k, n, 3) the points of all meshes, and the (k,) times in seconds."""
    import alembic3d as alembic

    found = list(_meshes(alembic, alembic.Abc.IArchive(path).getTop(), ()))
    if not found:
        raise Refused("it holds no mesh")
    times = sorted({time for schema, above in found for each in (schema, *above) for time in _times(each)})
    frames = [np.concatenate([_world(alembic, schema, above, time) for schema, above in found]) for time in times]
    if len({len(frame) for frame in frames}) > 1:
        raise Refused("its number of points changes over time: that is not one mesh that moves")
    return np.stack(frames), np.array(times)


def _meshes(alembic: Any, parent: Any, above: tuple[Any, ...]) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """Each mesh below an object, with the transforms above it, the nearest first."""
    for i in range(parent.getNumChildren()):
        child = parent.getChild(i)
        kind = str(child.getMetaData().get("schema"))
        if "PolyMesh" in kind:
            yield alembic.AbcGeom.IPolyMesh(parent, child.getName()).getSchema(), above
        chain = above
        if "Xform" in kind:
            chain = (alembic.AbcGeom.IXform(parent, child.getName()).getSchema(), *above)
        yield from _meshes(alembic, child, chain)


def _times(schema: Any) -> list[float]:
    sampling = schema.getTimeSampling()
    return [float(sampling.getSampleTime(i)) for i in range(schema.getNumSamples())]


def _world(alembic: Any, schema: Any, above: tuple[Any, ...], time: float) -> NDArray[np.float64]:
    at = alembic.Abc.ISampleSelector(time)
    points = np.array(schema.getValue(at).getPositions(), np.float64)
    for transform in above:
        matrix = np.array(transform.getValue(at).getMatrix(), np.float64).reshape(4, 4)
        points = points @ matrix[:3, :3] + matrix[3, :3]
    return points


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[4]), int(sys.argv[5])))
