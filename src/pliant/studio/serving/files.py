"""Files from pages: sent in pieces, kept in a folder of their own, and never anywhere else."""

from __future__ import annotations

import re
import secrets
import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from numpy.typing import NDArray

from pliant.errors import InvalidParameter

MOST_BYTES = 256 << 20  # of one upload
MOST_FILES = 64
CHUNK = 1 << 20
_MOST_KEPT = 4  # uploads; older ones are removed


@dataclass
class Upload:
    """Files that belong together, as an OBJ and its materials do.

    Parameters
    ----------
    folder
        Where they are.
    names
        What they are called.
    sizes
        How many bytes each will have.
    """

    folder: Path
    names: list[str]
    sizes: list[int]
    received: list[int] = field(default_factory=list)

    def path(self, at: int) -> Path:
        """Where a file is."""
        return self.folder / self.names[at]

    @property
    def complete(self) -> bool:
        """Whether everything has come."""
        return self.received == self.sizes


class Uploads:
    """What pages have sent, the latest few."""

    def __init__(self) -> None:
        self._folder: Path | None = None
        self._kept: dict[str, Upload] = {}

    @property
    def folder(self) -> Path | None:
        """Where the uploads are; None where there are none."""
        return self._folder

    def begin(self, files: list[Any]) -> str:
        """Make room for files; gives the name of the upload.

        Raises
        ------
        InvalidParameter
            No files, too many, too large, or names that are none.
        """
        if not 1 <= len(files) <= MOST_FILES:
            raise InvalidParameter(f"an upload is 1 to {MOST_FILES} files; there are {len(files)}")
        try:
            sizes = [int(each["size"]) for each in files]
            names = [safe_name(str(each["name"])) for each in files]
        except (TypeError, KeyError, ValueError) as error:
            raise InvalidParameter("an upload is a list of names and sizes") from error
        if min(sizes) < 0 or sum(sizes) > MOST_BYTES:
            raise InvalidParameter(f"an upload may have {MOST_BYTES >> 20} MB; this one has {sum(sizes) / 2**20:.0f}")
        if len(set(names)) < len(names):
            raise InvalidParameter("two files of an upload have the same name")
        name = secrets.token_hex(8)
        folder = self._root() / name
        folder.mkdir()
        self._kept[name] = Upload(folder, names, sizes, [0] * len(files))
        for at in range(len(files)):
            self._kept[name].path(at).touch()
        self._forget_old()
        return name

    def write(self, name: str, at: int, data: NDArray[Any]) -> None:
        """Append bytes to a file of an upload.

        Raises
        ------
        InvalidParameter
            No such upload or file, or more bytes than were announced.
        """
        found = self.get(name)
        if not 0 <= at < len(found.names):
            raise InvalidParameter(f"the upload has no file {at}")
        if found.received[at] + data.nbytes > found.sizes[at]:
            raise InvalidParameter(f"{found.names[at]} is longer than its {found.sizes[at]:,} bytes")
        with found.path(at).open("ab") as stream:
            stream.write(data.tobytes())
        found.received[at] += data.nbytes

    def get(self, name: str) -> Upload:
        """An upload.

        Raises
        ------
        InvalidParameter
            There is none of that name, any more.
        """
        if name not in self._kept:
            raise InvalidParameter("this upload is gone: send the files again")
        return self._kept[name]

    def remove(self) -> None:
        """Remove everything."""
        self._kept.clear()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None

    def _root(self) -> Path:
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="pliant-studio-"))
        return self._folder

    def _forget_old(self) -> None:
        while len(self._kept) > _MOST_KEPT:
            oldest = next(iter(self._kept))
            shutil.rmtree(self._kept.pop(oldest).folder, ignore_errors=True)


def safe_name(name: str) -> str:
    """The last part of a file's name, if that is one.

    Raises
    ------
    InvalidParameter
        It is empty, a folder's, or holds characters that no file's name should.
    """
    last = PureWindowsPath(PurePosixPath(name).name).name.strip()
    if (
        last in ("", ".", "..")
        or len(last) > 200
        or any(ord(character) < 32 or character in '<>:"|?*' for character in last)
    ):
        raise InvalidParameter(f"{name[:80]!r} is no name for a file")
    return last


def file_stem(name: str) -> str:
    """A document's name as the beginning of a file's."""
    return re.sub(r"[^\w.-]+", "-", name).strip("-.") or "shape"


def inside(root: Path | None, name: str) -> Path:
    """A path below the studio's folder.

    Raises
    ------
    InvalidParameter
        The studio has no folder, or the path leads out of it.
    """
    if root is None:
        raise InvalidParameter("this studio opens no files of the server: start it with --root DIR")
    try:
        path = (root / name).resolve()
        path.is_file()  # a name that is too long for the system is told here
    except (OSError, ValueError) as error:
        raise InvalidParameter(f"{name[:80]!r} is no path") from error
    if not path.is_relative_to(root):
        raise InvalidParameter(f"{name!r} lies outside the studio's folder")
    return path
