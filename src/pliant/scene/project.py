"""Project files: a scene in one file, ``.pliant``.

A project is a zip of a JSON manifest, which has a version, and of arrays as .npy. The mesh is embedded, or stands in a
file of its own in the project's folder, whose hash is kept. Textures in that folder are referred to, others embedded.
"""

from __future__ import annotations

import dataclasses
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np

from pliant._version import __version__
from pliant.errors import InvalidDeformer, InvalidMesh, InvalidParameter, PliantError, UnreadableFile
from pliant.io.files import read_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.archive import read_archive, write_archive
from pliant.scene.clip_data import clip_data, clip_of
from pliant.scene.layer_data import stack_data, stack_of
from pliant.scene.pictures import packed, unpacked
from pliant.scene.places import inside, located, portable, stored_place
from pliant.scene.scene import Scene
from pliant.scene.upgrades import VERSION, upgraded
from pliant.scene.values import Arrays, decode, encode

FORMAT = "pliant project"


def save_project(scene: Scene, path: Path | str, *, embed: bool = True) -> None:
    """Save a scene. Whatever happens meanwhile, the file that was there stays until the new one is complete.

    Parameters
    ----------
    scene
        The scene.
    path
        Where to; ``.pliant`` is the usual ending.
    embed
        Whether the mesh is part of the file. Else the file that it was read from is referred to: it must lie in the
        project's folder, or below, and still hold this mesh.

    Raises
    ------
    UnwritableFile
        The disk is full, or the place is not writable.
    InvalidParameter
        Something that no file can hold, such as a function; or a mesh that cannot be referred to.

    Warns
    -----
    PliantWarning
        A texture lies outside the project's folder and cannot be read: the project cannot take it along.
    """
    target, arrays = Path(path), Arrays()
    try:
        shape, pictures = packed(scene.mesh, target.parent, arrays) if embed else (scene.mesh, {})
        mesh = encode(portable(shape, target.parent), arrays, "mesh") if embed else _reference(shape, target)
        selections = {name: encode(ids, arrays, f"selections/{name}") for name, ids in scene.selections.items()}
        manifest = {
            "format": FORMAT,
            "version": VERSION,
            "software": f"pliant {__version__}",
            "mesh": mesh,
            "pictures": pictures,
            "stack": stack_data(scene.stack, arrays),
            "clip": None if scene.clip is None else clip_data(scene.clip, arrays),
            "selections": selections,
        }
    except RecursionError as error:
        raise InvalidParameter("something in the scene contains itself: no file can hold that") from error
    write_archive(target, manifest, arrays)


def load_project(path: Path | str, *, mesh: PolygonMesh | None = None) -> Scene:
    """The scene that a project file holds.

    Parameters
    ----------
    path
        The file.
    mesh
        A mesh to use instead of the project's, as where that is missing.

    Raises
    ------
    UnreadableFile
        It is damaged, hostile, of a newer version, or the mesh that it refers to is missing or another one; or a
        layer is of a kind that is not installed.
    """
    manifest, arrays = read_archive(path)
    if manifest.get("format") != FORMAT:
        raise UnreadableFile(path, f"it is a {manifest.get('format')!r}, not a {FORMAT!r}")
    try:
        manifest = upgraded(manifest)
        stored = mesh if mesh is not None else _mesh(manifest.get("mesh"), arrays, Path(path))
        shape = stored if mesh is not None else unpacked(stored, manifest.get("pictures"), arrays)
        chosen = manifest.get("selections")
        if not isinstance(chosen, dict):
            raise InvalidParameter("its selections are no names and vertices")
        stack = stack_of(manifest.get("stack"), arrays)
        clip = manifest.get("clip")
        return Scene(
            shape,
            stack,
            None if clip is None else clip_of(clip, arrays, shape, stack),
            {name: np.asarray(decode(value, arrays)) for name, value in chosen.items()},
        )
    except (InvalidParameter, InvalidMesh, InvalidDeformer) as error:
        raise UnreadableFile(path, str(error), "the file itself is as it was") from error
    except UnreadableFile:
        raise
    except PliantError as error:
        raise UnreadableFile(path, str(error)) from error
    except ValueError as error:
        raise UnreadableFile(path, str(error)) from error
    except RecursionError as error:
        raise UnreadableFile(path, "its manifest is nested too deeply to be honest") from error


def _reference(mesh: PolygonMesh, project: Path) -> dict[str, Any]:
    """The file that a mesh was read from, by its place beside the project and its hash."""
    from pliant.io.meshes import read

    if mesh.source is None:
        raise InvalidParameter("the mesh was not read from a file, so that there is none to refer to: embed it")
    data = read_bytes(mesh.source)
    again = read(mesh.source)
    if not (np.array_equal(again.points, mesh.points) and np.array_equal(again.faces.flat, mesh.faces.flat)):
        raise InvalidParameter(f"{mesh.source} no longer holds this mesh: write the mesh to a file first, or embed it")
    return {"file": inside(mesh.source, project.parent), "hash": _hash(data)}


def _mesh(data: Any, arrays: Arrays, project: Path) -> PolygonMesh:
    if isinstance(data, dict) and "file" in data:
        return _referred(data, project)
    mesh = decode(data, arrays)
    if not isinstance(mesh, PolygonMesh):
        raise InvalidParameter("it holds no mesh")
    return located(mesh, project.parent)


def _referred(data: dict[str, Any], project: Path) -> PolygonMesh:
    from pliant.io.meshes import read_mesh_bytes

    place = project.parent / stored_place(str(data["file"]))
    if not place.is_file():
        raise UnreadableFile(
            project, f"its mesh {place} is missing", "put the file back, or pass the mesh: load_project(path, mesh=…)"
        )
    content = read_bytes(place)
    if _hash(content) != data.get("hash"):
        raise UnreadableFile(
            project,
            f"its mesh {place} has changed since",
            "restore the file, or pass the mesh: load_project(path, mesh=…)",
        )
    return dataclasses.replace(read_mesh_bytes(content, place, folder=place.parent), source=place)


def _hash(data: bytes) -> str:
    return blake2b(data, digest_size=16).hexdigest()
