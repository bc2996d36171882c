"""What there is to tell of a mesh and of a deformer, as plain values."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.io.images import Image
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.zxhproj_header import AFFHeader, FFDHeader
from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.space.compose import Composition
from pliant.space.summed import Summed

_SAMPLES = 40_000  # points at which det J is looked at


def of_mesh(mesh: PolygonMesh) -> dict[str, Any]:
    """Counts, size, manifoldness, and what rides along."""
    boundary, tangled = mesh.edge_use
    sides, counts = np.unique(mesh.faces.lengths, return_counts=True)
    used = np.zeros(len(mesh.points), bool)
    used[mesh.faces.flat] = True
    found: dict[str, Any] = {
        "kind": "mesh",
        "points": len(mesh.points),
        "faces": len(mesh.faces),
        "corners_a_face": {str(side): int(count) for side, count in zip(sides, counts, strict=True)},
        "unused_points": int((~used).sum()),
    }
    if len(mesh.points):
        low, high = mesh.bounds
        found |= {"lowest": low.tolist(), "highest": high.tolist(), "size": (high - low).tolist()}
    return found | {
        "closed": boundary == 0 and len(mesh.faces) > 0,
        "boundary_edges": boundary,
        "non_manifold_edges": tangled,
        "carries": _carried(mesh),
    }


def of_transform(deformer: SpaceDeformer) -> dict[str, Any]:
    """Kind, lattice or matrix, conventions, and how strongly it deforms."""
    found: dict[str, Any] = {"kind": type(deformer).__name__}
    header = getattr(deformer, "carrier", None)
    if isinstance(header, FFDHeader):
        found |= {"variant": header.variant, "variant_because": header.reason, "dimension": header.dimension}
    if isinstance(header, FileFacts):
        found |= header.facts
    for name in ("direction", "edge", "interpolation", "outside"):
        if hasattr(deformer, name):
            found[name] = getattr(deformer, name)
    if isinstance(deformer, Composition | Summed):
        return found | {"parts": [type(part).__name__ for part in deformer.deformers]}
    if isinstance(deformer, Affine):
        found |= {"matrix": deformer.matrix.tolist(), "det_J": float(np.linalg.det(deformer.linear))}
        return found | (
            {"parameters": {name: " ".join(text.split()) for name, text in header.parameters.items()}}
            if isinstance(header, AFFHeader)
            else {}
        )
    affine = getattr(deformer, "affine", np.eye(4))
    if not np.array_equal(affine, np.eye(4)):
        found["affine_part"] = affine.tolist()
    rest = deformer.rest
    return found | _lattice(rest) | _strength(deformer, rest)


def of_image(image: Image) -> dict[str, Any]:
    """Size, place and values."""
    low, high = float(image.values.min()), float(image.values.max())
    return {
        "kind": "image",
        "space": "RAS, mm",
        "voxels": list(image.values.shape),
        "spacing": image.spacing.tolist(),
        "origin": image.origin.tolist(),
        "axes": [_direction(axis) for axis in image.axes.T],
        "hand": "right" if np.linalg.det(image.axes) > 0 else "left",
        "type": str(image.values.dtype),
        "values": {"from": low, "to": high},
    }


def _carried(mesh: PolygonMesh) -> list[str]:
    named = ("uvs", "normals", "groups", "objects", "materials", "lines")
    return [name for name in named if getattr(mesh, name) is not None] + [
        *mesh.vertex_attributes,
        *mesh.face_attributes,
    ]


def _lattice(rest: NDArray[np.float64]) -> dict[str, Any]:
    """The lattice from its control points at rest (nx, ny, nz, 3)."""
    steps = [np.diff(rest, axis=axis).reshape(-1, 3)[:1].sum(axis=0) for axis in range(3)]
    lengths = np.linalg.norm(steps, axis=1)
    found = {
        "control_points": list(rest.shape[:3]),
        "spacing": lengths.tolist(),
        "origin": rest[0, 0, 0].tolist(),
        "far_corner": rest[-1, -1, -1].tolist(),
    }
    if (lengths > 0).all():
        axes = (np.array(steps) / lengths[:, None]).T
        found["axes"] = [_direction(axis) for axis in axes.T]
        found["hand"] = "right" if np.linalg.det(axes) > 0 else "left"
    return found


def _direction(axis: NDArray[np.float64]) -> str:
    """Where an axis points: +x, or its three numbers where it is oblique."""
    main = int(np.argmax(np.abs(axis)))
    if abs(axis[main]) > 1 - 1e-9:
        return f"{'+' if axis[main] > 0 else '-'}{'xyz'[main]}"
    return "(" + " ".join(f"{value:.4f}" for value in axis) + ")"


def _strength(deformer: SpaceDeformer, rest: NDArray[np.float64]) -> dict[str, Any]:
    """How far control points and space move, and how space is squeezed, at points sampled over the lattice."""
    offset = np.linalg.norm(deformer.controls - rest, axis=-1)
    points = _samples(rest)
    moved = np.linalg.norm(deformer(points) - points, axis=1)
    ratio = np.linalg.det(deformer.jacobian(points))
    return {
        "largest_control_offset": float(offset.max()),
        "displacement": {"from": float(moved.min()), "to": float(moved.max())},
        "det_J": {"from": float(ratio.min()), "to": float(ratio.max()), "sampled_at": len(points)},
        "folds": f"{int((ratio <= 0).sum()):,} of {len(points):,} samples",
    }


def _samples(rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 3) a regular grid over the box of a lattice, at most 4 points a cell and axis."""
    counts = [max(1, 4 * (n - 1) + 1) for n in rest.shape[:3]]
    while np.prod(counts) > _SAMPLES:
        counts = [max(2, n * 3 // 4) if n > 1 else 1 for n in counts]
    corner = rest[0, 0, 0]
    grid = corner + np.zeros((*counts, 3))
    for axis, count in enumerate(counts):
        end = [0, 0, 0]
        end[axis] = -1
        along = np.linspace(0, 1, count).reshape([-1 if a == axis else 1 for a in range(3)] + [1])
        grid = grid + along * (rest[tuple(end)] - corner)
    return np.ascontiguousarray(grid.reshape(-1, 3))
