"""glTF and GLB: the mesh at rest, a morph target a frame, and weights that fade from each to the next.

At most two targets have a weight at any time, so that clients which evaluate few of them at once still play the clip.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.files import read_bytes, write_bytes
from pliant.io.mesh_formats import gltf_builder
from pliant.io.mesh_formats.carrier import carrier_of
from pliant.io.mesh_formats.format import Encoded, Source
from pliant.io.mesh_formats.gltf import Gltf
from pliant.io.mesh_formats.gltf_file import GltfFile, item, opened
from pliant.io.mesh_formats.gltf_scene import placed_nodes
from pliant.io.mesh_formats.gltf_writer import Layout, same_file
from pliant.io.report import LossReport
from pliant.mesh import PolygonMesh
from pliant.scene.animation.gltf_morphs import MorphWriter, Share
from pliant.scene.animation.gltf_reading import animated_points
from pliant.scene.animation.gltf_tracks import Which
from pliant.scene.clip import Clip, Progress
from pliant.scene.sequence import MeshSequence


def write_clip(clip: Clip, path: Path, progress: Progress | None, *, name: str = "frame") -> LossReport:
    """A morph target a frame, of normals too where the mesh has some; they are called ``name`` and their number."""
    at_rest, file, shares = at_rest_file(clip.mesh, path)
    writer = MorphWriter(file, shares, clip.mesh)
    for i, frame in enumerate(clip.frames(progress)):
        writer.add_target(f"{name} {i}", clip.posed(frame))
    write_bytes(path, writer.finish(clip.times, np.eye(len(clip.times))))
    return LossReport(path, Gltf.name, at_rest.losses, at_rest.notes)


def read(path: Path, fps: float, *, animation: Which = 0) -> MeshSequence:
    """The motion that morph targets, moving nodes and skins make.

    Raises
    ------
    UnreadableFile
        A description that contradicts itself.
    """
    source = Source(read_bytes(path), path, path.parent)
    try:
        times, points = animated_points(opened(source), fps, animation)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        cause = f"the description contradicts itself ({type(error).__name__}: {error})"
        raise UnreadableFile(path, cause[:200], "export the file again") from error
    return MeshSequence(points, times)


def at_rest_file(mesh: PolygonMesh, path: Path) -> tuple[Encoded, GltfFile, list[Share]]:
    """A file of the mesh at rest: the one that it was read from, as far as that can have targets, or a new one."""
    carrier = carrier_of(mesh, Gltf.name)
    if carrier is not None:
        kept = same_file(mesh, carrier, path)
        if kept is not None and not kept.companions:
            file = _opened(kept, path)
            found = _shares_of(file, carrier.layout, mesh)
            if found is not None:
                return kept, file, found
    made = gltf_builder.new_file(mesh, Gltf.keeps, path)
    file = _opened(made, path)
    vertices, corners, _ = gltf_builder.split(mesh)
    count = len(file.json["meshes"][0]["primitives"])
    return made, file, [Share(0, i, 0, vertices, corners, np.eye(3)) for i in range(count)]


def _opened(encoded: Encoded, path: Path) -> GltfFile:
    return opened(Source(b"".join(encoded.parts), path, path.parent))


def _shares_of(file: GltfFile, layout: Layout, mesh: PolygonMesh) -> list[Share] | None:
    """Where the vertices of a file that was read are; None where a mesh stands in two places, or has targets."""
    if len(file.json.get("buffers", [])) != 1 or file.json.get("animations"):
        return None
    rows = {(part.first, part.accessor): part for part in layout.parts}
    waiting, shares, seen = list(layout.parts), [], set()
    corners = gltf_builder.corners_of(mesh)
    for node, matrix in placed_nodes(file):
        at = item(file.json["nodes"], node)["mesh"]
        if at in seen or np.linalg.matrix_rank(matrix[:3, :3]) < 3:
            return None
        seen.add(at)
        known: dict[Any, NDArray[np.int64]] = {}
        for i, primitive in enumerate(item(file.json["meshes"], at)["primitives"]):
            key = tuple(sorted(primitive["attributes"].items()))
            if key not in known:
                part = waiting.pop(0)
                assert (part.first, part.accessor) in rows
                known[key] = np.arange(part.first, part.first + part.count)
            if "targets" in primitive:
                return None
            shares.append(Share(at, i, node, known[key], corners[known[key]], matrix[:3, :3]))
    return shares
