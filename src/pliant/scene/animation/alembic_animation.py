"""Alembic: polygons whose positions and normals are sampled over time, with their texture coordinates.

It is written and read through ``alembic3d``, which is unofficial but complete. Alembic winds polygons the other way
round; they are turned when they are written.
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
    turned = _turned(mesh)
    indices = imath.IntArrayFromBuffer(np.ascontiguousarray(mesh.faces.flat[turned]))
    uvs = _uvs(mesh, turned)
    with replacing(path) as temporary:
        archive = alembic.Abc.CreateArchiveWithInfo(str(temporary), f"pliant {__version__}", "")
        sampling = archive.addTimeSampling(alembic.AbcCoreAbstract.TimeSampling(1 / clip.fps, 0.0))
        shape = alembic.AbcGeom.OPolyMesh(archive.getTop(), name)
        schema = shape.getSchema()
        schema.setTimeSampling(sampling)
        for frame in clip.frames(progress):
            points, _ = as_float32(frame.points, "Alembic")
            sample = alembic.AbcGeom.OPolyMeshSchemaSample(imath.V3fArrayFromBuffer(points), indices, counts)
            if uvs is not None:
                sample.setUVs(uvs)
            normals = _normals(clip.posed(frame), turned)
            if normals is not None:
                sample.setNormals(normals)
            schema.set(sample)
        del schema, shape, archive  # closing it is what writes the end of the file
    return LossReport(path, "Alembic", _losses(mesh), ("coordinates are rounded to float32",))


def read(path: Path, _fps: float) -> MeshSequence:
    """The points of all meshes of the archive, in its order, where their transforms put them."""
    _alembic()
    arrays, _ = read_path(path, "motion", child="pliant.scene.animation.alembic_child", reader="Alembic")
    return MeshSequence(arrays["points"], arrays["times"])


def _turned(mesh: PolygonMesh) -> NDArray[np.int32]:
    """Places of the corners of all polygons, each from its last to its first."""
    row = mesh.faces.row_of
    ends = mesh.faces.offsets[:-1] + mesh.faces.offsets[1:] - 1
    return np.ascontiguousarray(ends[row] - np.arange(len(mesh.faces.flat)))


def _uvs(mesh: PolygonMesh, turned: NDArray[np.int32]) -> Any:
    """Texture coordinates, one a corner, so that seams stay; None where a corner has none."""
    if mesh.uvs is None or (mesh.uvs.indices < 0).any():
        return None
    alembic, imath = _alembic()
    values = np.ascontiguousarray(mesh.uvs.per_corner[turned, :2], np.float32)
    return alembic.AbcGeom.OV2fGeomParamSample(
        imath.V2fArrayFromBuffer(values), alembic.AbcGeom.GeometryScope.kFacevaryingScope
    )


def _normals(mesh: PolygonMesh, turned: NDArray[np.int32]) -> Any:
    """Stored normals, one a corner or a vertex; None where there are none."""
    alembic, imath = _alembic()
    scope = alembic.AbcGeom.GeometryScope
    if mesh.normals is not None and (mesh.normals.indices >= 0).all():
        values, where = mesh.normals.per_corner[turned], scope.kFacevaryingScope
    elif "normals" in mesh.vertex_attributes:
        values, where = mesh.vertex_attributes["normals"], scope.kVertexScope
    else:
        return None
    given = imath.V3fArrayFromBuffer(np.ascontiguousarray(values, np.float32))
    return alembic.AbcGeom.ON3fGeomParamSample(given, where)


def _losses(mesh: PolygonMesh) -> tuple[str, ...]:
    carried = ("groups", "objects", "materials", "lines")
    lost = [name for name in carried if getattr(mesh, name) is not None]
    for name, corner in (("uvs", mesh.uvs), ("normals", mesh.normals)):
        if corner is not None and (corner.indices < 0).any():
            lost.append(f"{name}, which some corners have and some have not")
    return (*lost, *(name for name in mesh.vertex_attributes if name != "normals"), *mesh.face_attributes)


def _alembic() -> tuple[Any, Any]:
    try:
        import alembic3d
        import imath
    except ImportError as error:
        raise MissingExtra("reading and writing Alembic", "alembic") from error
    return alembic3d, imath
