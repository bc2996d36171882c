"""What a transform format is: how its files are called and recognised, and what their numbers mean."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

from pliant.deformer import Deformer, SpaceDeformer
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.report import LossReport

if TYPE_CHECKING:
    from pliant.space.bspline_ffd import Edge
    from pliant.space.refit import Kind


class FormatModule(Protocol):
    """What the module of a format offers."""

    def read(self, path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
        """The deformer that the bytes of a file describe."""

    def write(self, deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
        """Write the deformer, and tell what the file could not hold."""


@dataclass(frozen=True)
class Conventions:
    """What the numbers of a format mean.

    Parameters
    ----------
    holds
        The maps that it can hold.
    space
        The coordinates of its files; pliant hands medical transforms out in RAS.
    direction
        What its owners use the map for.
    values
        What is stored for each control point, and in which order.
    outside
        What happens beyond its lattice or image.
    precision
        How numbers are written.
    """

    holds: str
    space: str
    direction: str
    values: str
    outside: str
    precision: str


@dataclass(frozen=True)
class TransformFormat:
    """A format: how it is called, how its files end and begin, the module that knows it, and what it means.

    ``shared`` endings are those of other files too: there, the content must say that it is this format. ``refit`` is
    the kind of map that stands in for one that the format does not hold, ``refit_edge`` what its lattice does beyond.
    """

    name: str
    endings: tuple[str, ...]
    signature: re.Pattern[bytes]
    module: str
    conventions: Conventions
    refit: Kind
    refit_edge: Edge = "clamp"
    shared: bool = False

    def load(self) -> FormatModule:
        """The format's module."""
        return cast(FormatModule, import_module(f"pliant.io.map_formats.{self.module}"))
