"""Files read whole and written atomically."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from pliant.errors import UnreadableFile, UnwritableFile


def read_bytes(path: Path | str) -> bytes:
    """The bytes of a file.

    Raises
    ------
    UnreadableFile
        It is not there, is a folder, is empty, or the system refuses it.
    """
    try:
        data = (path if isinstance(path, Path) else Path(path)).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        cause = getattr(error, "strerror", None) or str(error)
        raise UnreadableFile(path, cause, "check the path and its permissions") from error
    if not data:
        raise UnreadableFile(path, "the file is empty", "write or copy it again")
    return data


@contextmanager
def replacing(path: Path | str, *, durable: bool = False) -> Iterator[Path]:
    """A temporary path beside the target, renamed over it on success and removed on failure.

    Whoever reads the target sees the old file or the new one, never a part. ``durable`` waits until the disk has
    it, for what nobody can make again: a loss of power then costs nothing either.

    Raises
    ------
    UnwritableFile
        The disk is full, or the place is not writable.
    """
    try:
        with _renamed(path if isinstance(path, Path) else Path(path), durable=durable) as temporary:
            yield temporary
    except OSError as error:
        raise UnwritableFile(path, error.strerror or str(error)) from error


@contextmanager
def _renamed(target: Path, *, durable: bool) -> Iterator[Path]:
    temporary = _begun(target)
    try:
        yield temporary
        if durable:
            with temporary.open("rb") as written:
                os.fsync(written.fileno())
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    if durable:
        _settle(target.parent)


def _begun(target: Path) -> Path:
    """An empty file of a new name beside the target; folders are made where they are missing."""
    while True:
        path = target.parent / f".{target.stem}-{token_hex(4)}{target.suffix}"
        try:
            os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        except FileExistsError:
            pass
        except FileNotFoundError:
            target.parent.mkdir(parents=True, exist_ok=True)
        else:
            return path


def write_bytes(path: Path | str, parts: bytes | Iterable[bytes | memoryview]) -> None:
    """Write a file atomically from its bytes, or from pieces of them; raises as :func:`replacing` does."""
    with replacing(path) as temporary, temporary.open("r+b") as stream:  # cut to nothing, it would go to disk at once
        if isinstance(parts, bytes):
            stream.write(parts)
        else:
            stream.writelines(parts)


def _settle(folder: Path) -> None:
    """Have the system write down that a file was renamed, where it offers that."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
