"""Meshes larger than memory on the command line: what ``deform`` and ``apply`` do with ``--stream``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, cast

from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.deformer import Deformer, SpaceDeformer
    from pliant.mesh import PolygonMesh


def deform_in_pieces(session: Session, path: Path, output: Path, chosen: Callable[[PolygonMesh], Deformer]) -> None:
    """Lay a deformation around the box of a mesh file, and deform the file piece by piece."""
    from pliant.batch.mesh_streaming import box_of, stream_mesh

    box = box_of(path)
    low, high = box.bounds
    session.say(f"read {path}: from {low.tolist()} to {high.tolist()}")
    with session.patience():
        count = stream_mesh(cast("SpaceDeformer", chosen(box)), path, output)
    session.say(f"wrote {output}: {count:,} points")
    session.result(input=path, output=output, points=count)
