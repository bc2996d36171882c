"""Alembic: polygons with positions sampled over time, through the unofficial but complete ``alembic3d``.

Alembic winds polygons the other way round; they are turned when they are written.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant._version import __version__
from pliant.errors import MissingExtra, UnreadableFile
from pliant.io.files import replacing
from pliant.io.losses import as_float32
from pliant.io.report import LossReport
from pliant.mesh import Points, PolygonMesh
from pliant.scene.clip import Clip, Progress
from pliant.scene.sequence import MeshSequence


def write_clip(clip: Clip, path: Path, progress: Progress | None, *, name: str = "mesh") -> LossReport:
    """An archive with one mesh called ``name``."""
    alembic, imath = _alembic()
    mesh = clip.mesh
    counts = imath.IntArrayFromBuffer(mesh.faces.lengths.astype(np.int32))
    indices = imath.IntArrayFromBuffer(_turned(mesh))
    with replacing(path) as temporary:
        archive = alembic.Abc.CreateArchiveWithInfo(str(temporary), f"pliant {__version__}", "")
        sampling = archive.addTimeSampling(alembic.AbcCoreAbstract.TimeSampling(1 / clip.fps, 0.0))
        shape = alembic.AbcGeom.OPolyMesh(archive.getTop(), name)
        schema = shape.getSchema()
        schema.setTimeSampling(sampling)
        for frame in clip.frames(progress):
            points, _ = as_float32(frame.points, "Alembic")
            schema.set(alembic.AbcGeom.OPolyMeshSchemaSample(imath.V3fArrayFromBuffer(points), indices, counts))
        del schema, shape, archive  # closing it is what writes the end of the file
    return LossReport(path, "Alembic", _losses(mesh), ("coordinates are rounded to float32",))


def read(path: Path, _fps: float) -> MeshSequence:
    """The points of all meshes of the archive, in its order, where their transforms put them."""
    alembic, _ = _alembic()
    if not path.is_file():
        raise UnreadableFile(path, "there is no such file", "check the path")
    try:
        top = alembic.Abc.IArchive(str(path)).getTop()
        found = list(_meshes(alembic, top, ()))
    except RuntimeError as error:
        raise UnreadableFile(path, f"it is no sound Alembic archive: {error}", "export it again") from error
    if not found:
        raise UnreadableFile(path, "it holds no mesh", "export it with its meshes")
    times = sorted({time for schema, above in found for each in (schema, *above) for time in _times(each)})
    frames = [np.concatenate([_world(alembic, schema, above, time) for schema, above in found]) for time in times]
    if len({len(frame) for frame in frames}) > 1:
        raise UnreadableFile(path, "its number of points changes over time: that is not one mesh that moves")
    return MeshSequence(np.stack(frames), np.array(times))


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


def _world(alembic: Any, schema: Any, above: tuple[Any, ...], time: float) -> Points:
    at = alembic.Abc.ISampleSelector(time)
    points = np.array(schema.getValue(at).getPositions(), np.float64)
    for transform in above:
        matrix = np.array(transform.getValue(at).getMatrix(), np.float64).reshape(4, 4)
        points = points @ matrix[:3, :3] + matrix[3, :3]
    return points


def _turned(mesh: PolygonMesh) -> NDArray[np.int32]:
    """The corners of all polygons, each from its last to its first."""
    flat, row = mesh.faces.flat, mesh.faces.row_of
    ends = mesh.faces.offsets[:-1] + mesh.faces.offsets[1:] - 1
    return np.ascontiguousarray(flat[ends[row] - np.arange(len(flat))])


def _losses(mesh: PolygonMesh) -> tuple[str, ...]:
    carried = ("uvs", "normals", "groups", "objects", "materials", "lines")
    lost = [name for name in carried if getattr(mesh, name) is not None]
    return (*lost, *mesh.vertex_attributes, *mesh.face_attributes)


def _alembic() -> tuple[Any, Any]:
    try:
        import alembic3d
        import imath
    except ImportError as error:
        raise MissingExtra("reading and writing Alembic", "alembic") from error
    return alembic3d, imath
