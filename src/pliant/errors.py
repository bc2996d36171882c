"""What can go wrong, named by cause.

Every error that pliant raises on purpose is a :class:`PliantError`; its message names the cause and the cure.
The command line turns the kinds into exit codes.
"""

from __future__ import annotations

from pathlib import Path


class PliantError(Exception):
    """Any error that pliant raises on purpose."""


class UnreadableFile(PliantError):
    """A file that cannot be understood: truncated, inconsistent, of another format.

    Parameters
    ----------
    path
        The file, or any name by which the user knows the stream.
    cause
        What is wrong, with the values found and expected.
    cure
        What the user can do about it.
    line, byte
        Where it is wrong: a line counted from 1, or an offset counted from 0.
    """

    def __init__(
        self,
        path: Path | str,
        cause: str,
        cure: str = "",
        *,
        line: int | None = None,
        byte: int | None = None,
    ) -> None:
        self.path, self.cause, self.cure, self.line, self.byte = path, cause, cure, line, byte
        place = f", line {line}" if line is not None else f", byte {byte}" if byte is not None else ""
        super().__init__(f"{path}{place}: {cause}" + (f" ({cure})" if cure else ""))

    def __reduce__(self) -> tuple[object, ...]:
        return _unreadable, (self.path, self.cause, self.cure, self.line, self.byte)


def _unreadable(path: Path | str, cause: str, cure: str, line: int | None, byte: int | None) -> UnreadableFile:
    return UnreadableFile(path, cause, cure, line=line, byte=byte)


class UnwritableFile(PliantError):
    """A file that the system does not let be written; what stood there before still does."""

    def __init__(self, path: Path | str, cause: str) -> None:
        self.path, self.cause = path, cause
        super().__init__(f"{path} could not be written: {cause} (what was there before is as it was; make room, or "
                         "choose another place)")  # fmt: skip

    def __reduce__(self) -> tuple[object, ...]:
        return UnwritableFile, (self.path, self.cause)


class UnsupportedFormat(PliantError):
    """A file format, or a part of one, that pliant does not read or write."""


class LossRefused(PliantError):
    """A strict write met something that the target format cannot hold."""


class InvalidMesh(PliantError):
    """Points, faces or attributes that contradict each other."""


class InvalidTarget(PliantError):
    """A target that this deformer cannot bind to."""


class InvalidControls(PliantError):
    """Controls of another shape than the deformer's, or not finite."""


class InvalidDeformer(PliantError):
    """A deformer whose structure is degenerate: a flat lattice, a zero axis, a repeated site."""


class InvalidParameter(PliantError):
    """An argument outside what it may be: an empty box, a spacing of zero, an unknown name."""


class OutsideDomain(PliantError):
    """Points where the deformer is not defined."""


class NotConverged(PliantError):
    """An iteration that stopped before its tolerance."""


class SingularSystem(PliantError):
    """Equations that do not determine their unknowns."""


class NonFiniteResult(PliantError):
    """A computation that left the finite numbers."""


class NotDifferentiable(PliantError):
    """A derivative asked of something that has none."""


class MissingExtra(PliantError):
    """An optional dependency that is not installed."""

    def __init__(self, purpose: str, extra: str) -> None:
        self.purpose, self.extra = purpose, extra
        super().__init__(f"{purpose} needs the optional extra '{extra}': pip install 'pliant[{extra}]'")

    def __reduce__(self) -> tuple[object, ...]:
        return MissingExtra, (self.purpose, self.extra)


class NoGraphics(PliantError):
    """A machine on which nothing can draw: no display and no off-screen driver."""


class PliantWarning(UserWarning):
    """Something that worked, but not as the user may think."""
