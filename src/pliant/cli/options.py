"""Arguments and options that commands share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

_MOST_CONTROLS = 10_000_000  # 240 MB, several times


class Placement(StrEnum):
    """Where a lattice that a file describes lies."""

    physical = "physical"
    fit = "fit"


class Variant(StrEnum):
    """Layouts of zxhproj files."""

    A = "A"
    B = "B"
    C = "C"
    D = "D"


class Edge(StrEnum):
    """What a B-spline lattice does beyond its edge."""

    clamp = "clamp"
    zero = "zero"
    identity = "identity"


class MeshSpace(StrEnum):
    """Which way a mesh's x and y axes point, beside a transform in RAS."""

    as_is = "as-is"
    ras = "RAS"
    lps = "LPS"


MeshArgument = Annotated[Path, typer.Argument(metavar="MESH", show_default=False, help="The mesh to read.")]
FFDOption = Annotated[
    Path | None, typer.Option("--ffd", metavar="FILE", help="A transform file to apply (.FFD, .AFF, ...).")
]
PlacementOption = Annotated[
    Placement, typer.Option(help="Lattice of --ffd: where its file says, or its box fitted around the mesh's box.")
]
VariantOption = Annotated[
    Variant | None, typer.Option(help="Layout of an .FFD file, where the guess is wrong.", show_default=False)
]
EdgeOption = Annotated[
    Edge, typer.Option(help="Beyond the lattice: repeat its outermost points, add none, or move nothing.")
]
OriginOption = Annotated[
    str | None, typer.Option(metavar="X,Y,Z", help="Where the lattice begins, if its file does not say.")
]
LatticeOption = Annotated[
    str | None, typer.Option("--lattice", metavar="NxNxN", help="A new lattice of control points around the mesh.")
]
MarginOption = Annotated[
    float, typer.Option(help="Room around the mesh in --lattice, as part of its size.", min=0.0, max=1e6)
]
MoveOption = Annotated[
    list[str] | None,
    typer.Option("--move", metavar="I,J,K:DX,DY,DZ", help="Move control point (I, J, K), counted from 0; repeatable."),
]
InverseOption = Annotated[bool, typer.Option("--inverse", help="Apply the inverse: where each point came from.")]
MeshSpaceOption = Annotated[
    MeshSpace, typer.Option(help="Axes of the mesh; transform files are RAS. LPS turns x and y before and after.")
]
StreamOption = Annotated[
    bool, typer.Option("--stream", help="Binary PLY and STL piece by piece: meshes larger than memory.")
]
StrictOption = Annotated[bool, typer.Option("--strict", help="Refuse to write a file that would lose something.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as JSON on stdout.")]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress on stderr.")]


def three_numbers(text: str, option: str) -> tuple[float, float, float]:
    """Three finite numbers separated by commas.

    Raises
    ------
    typer.BadParameter
        Anything else.
    """
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not three numbers, as in 0.5,0,-2", param_hint=option) from None
    if not all(abs(value) < float("inf") for value in (x, y, z)):
        raise typer.BadParameter(f"{text!r} holds numbers that are not finite", param_hint=option)
    return x, y, z


def lattice_shape(text: str) -> tuple[int, int, int]:
    """Numbers of control points, as in 4x4x6.

    Raises
    ------
    typer.BadParameter
        Anything else.
    """
    words = text.lower().split("x")
    if len(words) != 3 or not all(word.isdecimal() and int(word) > 0 for word in words):
        raise typer.BadParameter(f"{text!r} is no lattice, as in 4x4x6", param_hint="--lattice")
    nx, ny, nz = map(int, words)
    if nx * ny * nz > _MOST_CONTROLS:
        raise typer.BadParameter(f"{text!r} has more than {_MOST_CONTROLS:,} control points", param_hint="--lattice")
    return nx, ny, nz


def lattice_move(text: str) -> tuple[tuple[int, int, int], tuple[float, float, float]]:
    """A control point and its displacement, as in 0,1,2:0.5,0,0.

    Raises
    ------
    typer.BadParameter
        Anything else.
    """
    index, _, offset = text.partition(":")
    words = index.split(",")
    if len(words) != 3 or not all(word.strip().isdecimal() for word in words):
        raise typer.BadParameter(f"{text!r} is no move, as in 0,1,2:0.5,0,0", param_hint="--move")
    i, j, k = map(int, words)
    return (i, j, k), three_numbers(offset, "--move")
