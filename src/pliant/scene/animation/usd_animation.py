"""USD: a mesh with time-sampled points, polygons and texture coordinates as they are."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from pliant.errors import MissingExtra
from pliant.io.files import replacing
from pliant.io.mesh_formats.losses import as_float32
from pliant.io.mesh_formats.polydata_process import read_path
from pliant.io.report import LossReport
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip, Progress
from pliant.scene.sequence import MeshSequence


def write_clip(clip: Clip, path: Path, progress: Progress | None, *, name: str = "mesh", up: str = "z") -> LossReport:
    """A stage with one mesh; ``name`` is the mesh's, ``up`` the axis that points up."""
    pxr = _pxr()
    stage = pxr.Usd.Stage.CreateInMemory()
    pxr.UsdGeom.SetStageUpAxis(stage, up.upper())
    stage.SetTimeCodesPerSecond(clip.fps)
    stage.SetFramesPerSecond(clip.fps)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(len(clip.times) - 1)
    safe = pxr.Tf.MakeValidIdentifier(name)
    root = pxr.UsdGeom.Xform.Define(stage, "/scene")
    stage.SetDefaultPrim(root.GetPrim())
    prim = pxr.UsdGeom.Mesh.Define(stage, f"/scene/{safe}")
    losses = _describe(pxr, stage, prim, clip.mesh, path.parent)
    for code, frame in enumerate(clip.frames(progress)):
        points, _ = as_float32(frame.points, "USD")
        prim.GetPointsAttr().Set(pxr.Vt.Vec3fArray.FromNumpy(points), code)
        extent = np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else np.zeros((2, 3), np.float32)
        prim.GetExtentAttr().Set(pxr.Vt.Vec3fArray.FromNumpy(extent), code)
    with replacing(path) as temporary:
        stage.GetRootLayer().Export(str(temporary))
    return LossReport(path, "USD", losses, ("coordinates are rounded to float32",))


def read(path: Path, fps: float) -> MeshSequence:
    """The points of all meshes of the stage, in its order, at every time at which one is sampled."""
    _pxr()
    arrays, _ = read_path(path, repr(fps), child="pliant.scene.animation.usd_child", reader="USD")
    return MeshSequence(arrays["points"], arrays["times"])


def _describe(pxr: Any, stage: Any, prim: Any, mesh: PolygonMesh, folder: Path) -> tuple[str, ...]:
    """What does not move: polygons, texture coordinates, colours, materials."""
    prim.CreateSubdivisionSchemeAttr("none")
    prim.CreateFaceVertexCountsAttr(pxr.Vt.IntArray.FromNumpy(mesh.faces.lengths.astype(np.int32)))
    prim.CreateFaceVertexIndicesAttr(pxr.Vt.IntArray.FromNumpy(mesh.faces.flat))
    values = pxr.UsdGeom.PrimvarsAPI(prim)
    kinds, places = pxr.Sdf.ValueTypeNames, pxr.UsdGeom.Tokens
    if mesh.uvs is not None and (mesh.uvs.indices >= 0).all():
        st = values.CreatePrimvar("st", kinds.TexCoord2fArray, places.faceVarying)
        st.Set(pxr.Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(mesh.uvs.values[:, :2], np.float32)))
        st.SetIndices(pxr.Vt.IntArray.FromNumpy(mesh.uvs.indices))
    colors = mesh.vertex_attributes.get("colors")
    if colors is not None and colors.ndim == 2 and colors.shape[1] >= 3:
        scale = 255.0 if colors.dtype == np.uint8 else 1.0
        shown = values.CreatePrimvar("displayColor", kinds.Color3fArray, places.vertex)
        shown.Set(pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(colors[:, :3] / scale, np.float32)))
    _materials(pxr, stage, prim, mesh, folder)
    kept = {"colors", "normals"}
    losses = [f"the vertex attribute {name!r}" for name in mesh.vertex_attributes if name not in kept]
    losses += [f"the face attribute {name!r}" for name in mesh.face_attributes]
    losses += [f"{name}" for name in ("groups", "objects", "lines") if getattr(mesh, name) is not None]
    return tuple(losses)


def _materials(pxr: Any, stage: Any, prim: Any, mesh: PolygonMesh, folder: Path) -> None:
    """Preview surfaces with their pictures, and the faces that wear each."""
    for place, (name, material) in enumerate(mesh.material_library.items()):
        safe = f"m{place}_" + re.sub(r"\W", "_", name, flags=re.ASCII)
        made = pxr.UsdShade.Material.Define(stage, f"/scene/materials/{safe}")
        shader = pxr.UsdShade.Shader.Define(stage, f"/scene/materials/{safe}/surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        color = shader.CreateInput("diffuseColor", pxr.Sdf.ValueTypeNames.Color3f)
        color.Set(pxr.Gf.Vec3f(*map(float, material.color)))
        made.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        if material.texture is not None:
            reader = pxr.UsdShade.Shader.Define(stage, f"/scene/materials/{safe}/st")
            reader.CreateIdAttr("UsdPrimvarReader_float2")
            reader.CreateInput("varname", pxr.Sdf.ValueTypeNames.String).Set("st")
            picture = pxr.UsdShade.Shader.Define(stage, f"/scene/materials/{safe}/picture")
            picture.CreateIdAttr("UsdUVTexture")
            picture.CreateInput("file", pxr.Sdf.ValueTypeNames.Asset).Set(_beside(material.texture, folder))
            picture.CreateInput("st", pxr.Sdf.ValueTypeNames.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
            color.ConnectToSource(picture.ConnectableAPI(), "rgb")
        if mesh.materials is not None and name in mesh.materials.names:
            faces = mesh.materials.faces(name).astype(np.int32)
            subset = pxr.UsdShade.MaterialBindingAPI(prim).CreateMaterialBindSubset(
                safe, pxr.Vt.IntArray.FromNumpy(faces)
            )
            pxr.UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(made)


def _beside(picture: Path, folder: Path) -> str:
    """Where a picture is, seen from the file: scenes may be moved with what lies beside them."""
    try:
        return "./" + picture.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return picture.resolve().as_posix()


def _pxr() -> Any:
    """USD's Python modules, by one name."""
    try:
        import pxr
        from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdShade, Vt  # noqa: F401  (makes them attributes of pxr)
    except ImportError as error:
        raise MissingExtra("reading and writing USD", "usd") from error
    return pxr
