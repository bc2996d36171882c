"""Faces from photographs as scenes: a mesh that wears the photograph, and its caricature as a layer."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import blake2b
from importlib.util import find_spec
from pathlib import Path

from pliant.errors import InvalidParameter, MissingExtra
from pliant.face.caricature_deformer import FaceCaricature
from pliant.face.dense import dense_face
from pliant.face.face import chosen, faces_from_photo
from pliant.face.folding import Foldless, without_folds
from pliant.io.files import write_bytes
from pliant.mesh import Material, PolygonMesh
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.examples.samples import samples_folder

NAME = "Caricature"
PHOTOGRAPHS = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff")


def photograph_of(paths: Iterable[Path]) -> Path | None:
    """The first photograph among files; None where there is none."""
    return next((path for path in paths if path.name.lower().endswith(PHOTOGRAPHS)), None)


def example_photograph() -> Path | None:
    """The portrait that scikit-image carries; None where it is not installed."""
    found = find_spec("skimage")
    if found is None or found.origin is None:
        return None
    path = Path(found.origin).parent / "data" / "astronaut.png"
    return path if path.is_file() else None


def missing() -> str:
    """What is missing for looking at photographs, and how to get it; empty where nothing is."""
    from pliant.face.networks import LANDMARKS, network

    try:
        network(LANDMARKS)
    except MissingExtra as error:
        return str(error)
    return ""


def face_scene(photograph: Path, number: int = 0) -> tuple[Scene, int]:
    """The scene of a face in a photograph, and how many faces there are.

    Raises
    ------
    UnreadableFile, NoFace, MissingExtra
        No picture, no such face, or nothing to look with.
    """
    faces = faces_from_photo(photograph)
    face = chosen(faces, number)
    mesh = _dressed(dense_face(face).filled().mesh, face.picture.png())
    return Scene(mesh, Stack((Layer(NAME, FaceCaricature(face.landmarks)),))), len(faces)


def face_layer(stack: Stack, name: str) -> FaceCaricature:
    """The caricature of a layer.

    Raises
    ------
    InvalidParameter
        There is no such layer, or it holds something else.
    """
    deformer = stack[name].deformer
    if not isinstance(deformer, FaceCaricature):
        raise InvalidParameter(f"layer {name!r} is no caricature: open a photograph of a face first")
    return deformer


def _dressed(mesh: PolygonMesh, picture: bytes) -> PolygonMesh:
    """The mesh in a picture that pages may see."""
    path = samples_folder() / f"{blake2b(picture, digest_size=12).hexdigest()}.png"
    write_bytes(path, picture)
    return mesh.replace(material_library={"skin": Material("skin", (1.0, 1.0, 1.0), path)})


def looked_at(deformer: FaceCaricature, mesh: PolygonMesh) -> Foldless:
    """How far a caricature goes without folding the face."""
    return without_folds(deformer.sites(), mesh)
