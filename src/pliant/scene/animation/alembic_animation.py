"""Alembic: polygons with positions sampled over time, through the unofficial but complete ``alembic3d``.

Alembic winds polygons the other way round; they are turned when they are written.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant._version import __version__
from pliant.errors import MissingExtra
from pliant.io.files import replacing
from pliant.io.mesh_formats.losses import as_float32
from pliant.io.mesh_formats.polydata_process import read_path
from pliant.io.report import LossReport
from pliant.mesh import PolygonMesh
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
    _alembic()
    arrays, _ = read_path(path, "motion", child="pliant.scene.animation.alembic_child", reader="Alembic")
    return MeshSequence(arrays["points"], arrays["times"])


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
