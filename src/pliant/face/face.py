"""A face: a mesh in centimetres that wears a piece of the photograph it was made from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.face.grouping import groups_of_faces
from pliant.face.landmarks import FaceLandmarks, NoFace, find_landmarks
from pliant.face.photograph import read_photograph
from pliant.face.picture import Picture
from pliant.face.pose import pose_of, to_face, to_photograph
from pliant.face.topology import boundary_loops, mean_face
from pliant.io.files import write_bytes
from pliant.io.meshes import write
from pliant.io.report import LossReport
from pliant.mesh import CornerValues, FaceLabels, Material, Points, PolygonMesh

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Face:
    """A face from a photograph.

    Parameters
    ----------
    mesh
        Triangles with texture coordinates, and groups that name the features. It looks along z, its up is y. Its unit
        is the centimetre under the assumption that the mean face is 14 cm wide: a photograph does not tell sizes.
    landmarks
        (468, 3) the landmarks in the frame of the mesh.
    picture
        What it wears.
    pose
        (4, 4) from the photograph, in pixels (x right, y down, z away from the viewer), to the frame of the mesh.
    score
        How certain the network is that this is a face; 15 and more are accepted.
    """

    mesh: PolygonMesh
    landmarks: Points
    picture: Picture
    pose: Floats
    score: float

    def with_mesh(self, mesh: PolygonMesh) -> Self:
        """The same face with another mesh.

        Parameters
        ----------
        mesh
            With the texture coordinates of the picture.
        """
        return replace(self, mesh=mesh)

    def filled(self) -> Self:
        """The same face with eyes and mouth closed by one polygon each, which wears what the photograph shows there."""
        loops = sorted(boundary_loops(self.mesh.triangles), key=len)[:-1]  # all but the outline
        faces = [*self.mesh.triangles, *loops]
        mesh, groups = self.mesh, self.mesh.groups
        assert mesh.uvs is not None
        assert groups is not None
        kinds = [groups.names.index("mouth" if 13 in loop else "eyes") for loop in loops]
        flat = np.concatenate(faces)
        closed = mesh.replace(
            faces=faces,
            uvs=CornerValues(mesh.uvs.values, flat),
            groups=FaceLabels(groups.names, np.concatenate([groups.indices, kinds]).astype(np.int32)),
            materials=FaceLabels(("skin",), np.zeros(len(faces), np.int32)),
        )
        return self.with_mesh(closed)

    def write(self, path: Path | str, *, strict: bool = False) -> LossReport:
        """Write mesh, material and picture: an ``.obj`` with its ``.mtl`` and ``.png``, a ``.glb`` that holds all.

        Each file appears whole or not at all. What a format does not hold is returned, or refused where ``strict``,
        as by :func:`pliant.write`.

        Parameters
        ----------
        path
            Ends in ``.obj`` or ``.glb``.
        strict
            Refuse to write what would lose something.

        Returns
        -------
        LossReport
            What the format does not hold.
        """
        path = Path(path)
        with TemporaryDirectory() as folder:
            stem = path.name.split(".")[0].replace(" ", "_") or "face"
            picture = Path(folder) / f"{stem}.png"
            write_bytes(picture, self.picture.png())
            skin = Material("skin", (1.0, 1.0, 1.0), picture)
            dressed = self.mesh.replace(material_library={"skin": skin}, source=picture.with_suffix(".obj"))
            return write(dressed, path, strict=strict)


def face_from_photo(source: Path | str | ArrayLike, number: int = 0) -> Face:
    """A face from a photograph.

    Parameters
    ----------
    source
        A picture file, or an array of pixels: see :func:`pliant.face.photograph.read_photograph`.
    number
        Which face, where there are several: 0 is the largest.

    Raises
    ------
    UnreadableFile
        No picture, or a part of one.
    NoFace
        No face is found, or fewer than ``number + 1``.
    MissingExtra
        The extra ``face`` is not installed.
    """
    return chosen(faces_from_photo(source), number)


def faces_from_photo(source: Path | str | ArrayLike) -> list[Face]:
    """All faces in a photograph, the largest first.

    Parameters
    ----------
    source
        A picture file, or an array of pixels: see :func:`pliant.face.photograph.read_photograph`.

    Raises
    ------
    UnreadableFile
        No picture, or a part of one.
    NoFace
        No face is found.
    MissingExtra
        The extra ``face`` is not installed.
    """
    image = read_photograph(source)
    return [_face(found, Picture.around(image, found.points)) for found in find_landmarks(image)]


def chosen(faces: list[Face], number: int) -> Face:
    """One of several faces.

    Raises
    ------
    NoFace
        There are fewer.
    """
    if not 0 <= number < len(faces):
        count = "one face is" if len(faces) == 1 else f"{len(faces)} faces are"
        raise NoFace(f"there is no face {number}: {count} found, numbered from 0, the largest first")
    return faces[number]


def _face(found: FaceLandmarks, picture: Picture) -> Face:
    pose = pose_of(found.points)
    landmarks = to_face(pose, found.points)
    mesh = dressed(landmarks, mean_face(), picture, pose, groups_of_faces(mean_face().points, mean_face()))
    return Face(mesh, landmarks, picture, pose, found.score)


def dressed(points: Points, shape: PolygonMesh, picture: Picture, pose: Floats, groups: FaceLabels) -> PolygonMesh:
    """Points with the triangles of a shape, and the piece of a photograph that lies on each."""
    uvs = picture.coordinates(to_photograph(pose, points)[:, :2])
    return PolygonMesh(
        points,
        shape.faces,
        uvs=CornerValues(uvs, shape.faces.flat),
        groups=groups,
        materials=FaceLabels(("skin",), np.zeros(len(shape.faces), np.int32)),
        material_library={"skin": Material("skin", (1.0, 1.0, 1.0), picture.file)},
    )
