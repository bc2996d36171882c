"""Lattices other than boxes on the command line: sites anywhere, and lattices around an axis."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli.options import lattice_shape, three_numbers

if TYPE_CHECKING:
    from pliant.deformer import SpaceDeformer
    from pliant.mesh import PolygonMesh

DirichletOption = Annotated[
    Path | None,
    typer.Option("--dirichlet", metavar="SITES", help="Control points anywhere: a landmark file (.csv, .json, .fcsv)."),
]
SitesToOption = Annotated[
    Path | None, typer.Option("--sites-to", metavar="FILE", help="Where the sites of --dirichlet go, in their order.")
]
CylinderOption = Annotated[
    str | None,
    typer.Option("--cylinder", metavar="NxNxN", help="A cylinder about z: control points around, outwards, along."),
]
PrismOption = Annotated[int | None, typer.Option("--prism", metavar="SIDES", help="A prism about z.")]
SphereOption = Annotated[
    str | None,
    typer.Option("--sphere", metavar="NxNxN", help="A sphere: control points around, outwards, from pole to pole."),
]


@dataclass(frozen=True)
class FreeLattice:
    """One of these options, as it was typed."""

    option: str
    value: Any
    sites_to: Path | None = None

    def laid(self, mesh: PolygonMesh, margin: float) -> SpaceDeformer:
        """The lattice around a mesh, its sites moved where a file says so."""
        from pliant.space.dirichlet_ffd import DirichletFFD
        from pliant.space.extended_ffd import ExtendedFFD

        if self.option == "--dirichlet":
            found = DirichletFFD(_positions(self.value), smooth=True)
            return found if self.sites_to is None else found.moved(_positions(self.sites_to))
        if self.option == "--prism":
            return ExtendedFFD.prism(mesh, sides=self.value, margin=margin)
        make = ExtendedFFD.cylinder if self.option == "--cylinder" else ExtendedFFD.sphere
        return make(mesh, shape=lattice_shape(self.value), margin=margin)


def free_lattice(
    dirichlet: Path | None, sites_to: Path | None, cylinder: str | None, prism: int | None, sphere: str | None
) -> FreeLattice | None:
    """The one option that was given, or none.

    Raises
    ------
    typer.BadParameter
        Two of them, or ``--sites-to`` without sites.
    """
    values = {"--dirichlet": dirichlet, "--cylinder": cylinder, "--prism": prism, "--sphere": sphere}
    given = [(option, value) for option, value in values.items() if value is not None]
    if len(given) > 1:
        raise typer.BadParameter(f"give one of {' and '.join(option for option, _ in given)}", param_hint=given[1][0])
    if sites_to is not None and dirichlet is None:
        raise typer.BadParameter("there are no sites to move: add --dirichlet FILE", param_hint="--sites-to")
    return FreeLattice(*given[0], sites_to) if given else None


def site_move(text: str, count: int) -> tuple[int, tuple[float, float, float]]:
    """A control point among ``count`` and its displacement, as in 12:0.5,0,0.

    Raises
    ------
    typer.BadParameter
        Anything else.
    """
    index, _, offset = text.partition(":")
    if not index.strip().isdecimal():
        raise typer.BadParameter(
            f"{text!r} is no move of one of {count} controls, as in 12:0.5,0,0", param_hint="--move"
        )
    if int(index) >= count:
        raise typer.BadParameter(f"{text!r}: there are {count} control points", param_hint="--move")
    return int(index), three_numbers(offset, "--move")


def _positions(path: Path) -> Any:
    from pliant.io.landmarks import read_landmarks

    return read_landmarks(path).points
