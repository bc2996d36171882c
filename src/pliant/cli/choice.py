"""The deformer that the options of a command describe."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from pliant.cli.cage import CageChoice
from pliant.cli.deformer_options import BASES, Step, made
from pliant.cli.free_lattices import FreeLattice, site_move
from pliant.cli.options import Edge, MeshSpace, Placement, Variant, lattice_move, lattice_shape, three_numbers

if TYPE_CHECKING:
    from pliant.deformer import SpaceDeformer
    from pliant.mesh import PolygonMesh
    from pliant.space.affine import Affine


@dataclass(frozen=True)
class Choice:
    """Options as they were typed; :meth:`deformer` makes a deformer of them."""

    ffd: Path | None = None
    placement: Placement = Placement.physical
    variant: Variant | None = None
    edge: Edge = Edge.clamp
    origin: str | None = None
    lattice: str | None = None
    margin: float = 0.0
    moves: tuple[str, ...] = ()
    inverse: bool = False
    mesh_space: MeshSpace = MeshSpace.as_is
    steps: tuple[Step, ...] = ()
    tool: FreeLattice | None = None
    cage: CageChoice | None = None

    def deformer(self, mesh: PolygonMesh) -> SpaceDeformer | None:
        """The deformer, in the space of the mesh; None where no option asks for one.

        Raises
        ------
        typer.BadParameter
            Options that contradict each other, or a control point that the lattice has not.
        """
        if self.ffd is not None and self.lattice is not None:
            raise typer.BadParameter("give one of --ffd and --lattice, not both", param_hint="--lattice")
        if self.tool is not None and (self.ffd is not None or self.lattice is not None):
            other = "--lattice" if self.ffd is None else "--ffd"
            raise typer.BadParameter(f"give one of {other} and {self.tool.option}", param_hint=self.tool.option)
        if self.cage is not None and (self.ffd is not None or self.lattice is not None or self.tool is not None):
            raise typer.BadParameter("give a cage or a lattice, not both", param_hint="--cage")
        base = self._base(mesh)
        if base is None and (self.moves or (self.inverse and not self.steps)):
            raise typer.BadParameter("there is nothing to move or invert: add --ffd, --lattice or --cage")
        found = self._composed(base, mesh)
        if found is not None and self.inverse:
            from pliant.space.inverse import Inverse

            return Inverse(found)
        return found

    def required(self, mesh: PolygonMesh) -> SpaceDeformer:
        """As :meth:`deformer`, where there must be one."""
        found = self.deformer(mesh)
        if found is None:
            raise typer.BadParameter(
                "say how to deform: --ffd FILE, --lattice NxNxN with --move, --cage FILE with --posed FILE, "
                "or --twist angle=90 ..."
            )
        return found

    def _base(self, mesh: PolygonMesh) -> SpaceDeformer | None:
        """The lattice or the file's transform, moved and turned as asked for."""
        if self.cage is not None:
            return self.cage.made() if not self.moves else _moved(self.cage.made(), self.moves)
        if self.ffd is None and self.lattice is None and self.tool is None:
            return None
        found = self._read(mesh) if self.ffd is not None else self._new(mesh)
        if self.moves:
            found = _moved(found, self.moves)
        if self.mesh_space is MeshSpace.lps:
            from pliant.space.placed import place

            return place(found, half_turn())
        return found

    def _composed(self, base: SpaceDeformer | None, mesh: PolygonMesh) -> SpaceDeformer | None:
        """All deformations in the order of their options."""
        parts = [base if name in BASES else made((name, text), mesh) for name, text in self.steps] or [base]
        chain = [part for part in parts if part is not None]
        if len(chain) < 2:
            return chain[0] if chain else None
        from pliant.space.compose import compose

        return compose(*chain)

    def _read(self, mesh: PolygonMesh) -> SpaceDeformer:
        from pliant.io.transforms import read_transform

        assert self.ffd is not None
        return read_transform(
            self.ffd,
            placement=self.placement.value,
            variant=None if self.variant is None else self.variant.value,
            target=half_turn()(mesh) if self.mesh_space is MeshSpace.lps else mesh,
            edge=self.edge.value,
            origin=None if self.origin is None else three_numbers(self.origin, "--origin"),
        )

    def _new(self, mesh: PolygonMesh) -> SpaceDeformer:
        from pliant.space.bspline_ffd import BSplineFFD

        if self.mesh_space is MeshSpace.lps:
            raise typer.BadParameter("a lattice is made in the mesh's own space; --mesh-space goes with --ffd")
        if self.tool is not None:
            return self.tool.laid(mesh, self.margin)
        assert self.lattice is not None
        return BSplineFFD.around(mesh, shape=lattice_shape(self.lattice), margin=self.margin, edge=self.edge.value)


def half_turn() -> Affine:
    """From LPS to RAS and back: x and y change sign, a half turn about z."""
    from pliant.space.affine import Affine

    return Affine.scaling((-1.0, -1.0, 1.0))


def _moved(deformer: SpaceDeformer, moves: tuple[str, ...]) -> SpaceDeformer:
    controls = deformer.controls.copy()
    if controls.ndim == 2:
        for text in moves:
            at, offset = site_move(text, len(controls))
            controls[at] += offset
        return deformer.moved(controls)
    if controls.ndim != 4:
        raise typer.BadParameter(f"a {type(deformer).__name__} has no lattice of control points", param_hint="--move")
    for text in moves:
        index, offset = lattice_move(text)
        if any(i >= count for i, count in zip(index, controls.shape[:3], strict=True)):
            size = " x ".join(map(str, controls.shape[:3]))
            raise typer.BadParameter(f"{text!r}: the lattice has {size} control points", param_hint="--move")
        controls[index] += offset
    return deformer.moved(controls)
