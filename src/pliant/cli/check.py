"""``pliant check``: whether a transform folds, and what it does to volume."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli import options as opt
from pliant.cli.choice import half_turn
from pliant.cli.exits import Exit
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.deformer import SpaceDeformer
    from pliant.field.certificate import Certificate
    from pliant.mesh import PolygonMesh

MeshToCheck = Annotated[
    Path | None, typer.Option("--mesh", metavar="MESH", help="A closed mesh whose volume shall be kept.")
]
LeastOption = Annotated[float, typer.Option("--min-det", help="det J must be proved to be above this everywhere.")]
VolumeOption = Annotated[
    float | None,
    typer.Option("--max-volume-change", min=0.0, help="Largest change of the mesh's volume, as part of it."),
]


def check(
    file: Annotated[Path, typer.Argument(metavar="FILE", show_default=False, help="The transform to check.")],
    mesh: MeshToCheck = None,
    min_det: LeastOption = 0.0,
    max_volume_change: VolumeOption = None,
    placement: opt.PlacementOption = opt.Placement.physical,
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    origin: opt.OriginOption = None,
    mesh_space: opt.MeshSpaceOption = opt.MeshSpace.as_is,
    budget: Annotated[int, typer.Option(min=0, help="How many boxes a proof may halve.")] = 20_000,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Prove that a transform does not fold, and measure how it changes volume.

    Exits with 5 where a gate fails: det J is not proved to be above --min-det, or the volume of --mesh changes by
    more than --max-volume-change.
    """
    if max_volume_change is not None and mesh is None:
        raise typer.BadParameter("the volume of which mesh? add --mesh MESH", param_hint="--max-volume-change")
    with Session(json=json, quiet=quiet) as session:
        from pliant.field.certifying import certify
        from pliant.io.meshes import read
        from pliant.io.transforms import read_transform

        shape = None if mesh is None else read(mesh)
        if shape is not None and mesh_space is opt.MeshSpace.lps:
            shape = half_turn()(shape)
        deformer = read_transform(
            file,
            placement=placement.value,
            variant=None if variant is None else variant.value,
            target=shape,
            edge=edge.value,
            origin=None if origin is None else opt.three_numbers(origin, "--origin"),
        )
        with session.patience():
            proof = certify(deformer, budget=budget, bounds=None if shape is None else shape.bounds)
        found: dict[str, Any] = {"file": str(file), **_of_proof(proof)}
        failures = _det_failures(proof, min_det)
        if shape is not None:
            change = _volume_change(deformer, shape)
            found["volume_change"] = change
            if max_volume_change is not None and abs(change) > max_volume_change:
                failures.append(f"the volume changes by {change:+.3%}; {max_volume_change:.3%} are allowed")
        session.result(**found, failures=failures)
        session.table({name.replace("_", " "): _shown(value) for name, value in found.items()})
        for failure in failures:
            session.warn(f"failed: {failure}")
    if failures:
        raise typer.Exit(int(Exit.REFUSED))


def _of_proof(proof: Certificate) -> dict[str, Any]:
    return {
        "status": proof.status,
        "method": proof.method,
        "injective": proof.injective,
        "det_J_bounds": [proof.lower, proof.upper],
        "det_J_found": [proof.least, proof.greatest],
        "least_at": None if proof.point is None else proof.point.tolist(),
        "largest_local_volume_error": list(proof.volume_error),
        "subdivisions": proof.subdivisions,
    }


def _det_failures(proof: Certificate, least: float) -> list[str]:
    """Why det J is not proved to be above a limit; nothing if it is."""
    if proof.lower > least:
        return []
    if proof.least is not None and proof.least <= least:
        assert proof.point is not None
        place = ", ".join(f"{x:.6g}" for x in proof.point)
        folds = ": the map folds" if proof.status == "folds" else ""
        return [f"det J is {proof.least:.6g} at ({place}){folds}"]
    return [f"det J is only proved to be above {proof.lower:.6g}, not {least:g}; raise --budget to prove more"]


def _volume_change(deformer: SpaceDeformer, mesh: PolygonMesh) -> float:
    """By which part of itself the volume of a mesh changes."""
    from pliant.errors import InvalidMesh
    from pliant.field.volumes import volume

    before = volume(mesh)
    if before == 0:
        raise InvalidMesh("the mesh encloses no volume: there is nothing to keep")
    return volume(deformer(mesh)) / before - 1


def _shown(value: Any) -> str:
    """A value for people."""
    if value is None:
        return "not known"
    if isinstance(value, list):
        return " ".join(_shown(entry) for entry in value) if len(value) == 3 else " to ".join(map(_shown, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
