"""What a mesh format is: it recognises its files, reads bytes, and turns a mesh into bytes.

Formats touch no disk but for the files that theirs refer to. That leaves detection, atomic writing and strictness
to :mod:`pliant.io.meshes`, and a stream or a compressed file is one more :class:`Source`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from pliant.errors import UnreadableFile
from pliant.mesh import PolygonMesh


@dataclass(frozen=True)
class Source:
    """The bytes of a file, and the name by which the user knows them.

    ``folder`` is where files that it refers to are looked for; None where there is no such place. ``freeze`` allows
    for a shape at rest where a skin or morph targets would move it.
    """

    data: bytes
    name: Path | str
    folder: Path | None = None
    freeze: bool = False

    def unreadable(self, cause: str, cure: str = "", *, at: int | None = None, text: bool = True) -> UnreadableFile:
        """The error that says what is wrong at a byte offset: by its line where the file is text."""
        if at is None or not text:
            return UnreadableFile(self.name, cause, cure, byte=at)
        return UnreadableFile(self.name, cause, cure, line=self.line(at))

    def line(self, at: int) -> int:
        """The line, counted from 1, of a byte offset; lines end in LF, CR LF or CR."""
        before = self.data[:at]
        return 1 + before.count(b"\n") + before.count(b"\r") - before.count(b"\r\n")


@dataclass(frozen=True)
class Keeps:
    """What a format can hold. Losses are told from this table, so it and they cannot disagree.

    ``cells`` are those of a volume mesh; ``precision`` says how coordinates are stored when a mesh of another format
    is written.
    """

    faces: bool = True
    polygons: bool = False
    cells: bool = False
    shared_vertices: bool = True
    lines: bool = False
    corner_uvs: bool = False
    corner_normals: bool = False
    vertex_normals: bool = False
    vertex_colors: bool = False
    face_colors: bool = False
    groups: bool = False
    objects: bool = False
    materials: bool = False
    textures: bool = False
    vertex_attributes: bool = False
    face_attributes: bool = False
    precision: str = "float64"


@dataclass(frozen=True)
class Encoded:
    """A file ready to be written: its bytes, what they could not hold, and the files that must stand beside it."""

    parts: Sequence[bytes | memoryview]
    losses: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    companions: Mapping[Path, bytes] = field(default_factory=dict)


class MeshFormat(ABC):
    """One file format of meshes."""

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]
    keeps: ClassVar[Keeps]
    written: ClassVar[bool] = True

    @abstractmethod
    def sniff(self, data: bytes) -> bool:
        """Whether the bytes of a file say that they are of this format."""

    @abstractmethod
    def read(self, source: Source) -> PolygonMesh:
        """The mesh that a file holds.

        Raises
        ------
        UnreadableFile
            With the line or byte, the cause and the cure.
        """

    @abstractmethod
    def encode(self, mesh: PolygonMesh, path: Path) -> Encoded:
        """A mesh as this format stores it, for a file that will stand at ``path``."""
