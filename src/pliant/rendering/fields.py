"""What deforms a shape, added to a plotter: the lattice, the warped grid, the arrows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.field.grids import WarpedGrid
from pliant.field.vectors import Arrows
from pliant.mesh import Points
from pliant.numerics.ragged import Ragged
from pliant.rendering.palette import CONTROL, MOVED, Theme, color_table
from pliant.rendering.quantities import Quantity, painted
from pliant.rendering.solids import add_balls, add_lines
from pliant.rendering.window import import_pyvista


def add_lattice(drawing: Any, deformer: Deformer, size: float, theme: Theme) -> Points:
    """Draw control points with their lattice; where they are.

    The few that moved are marked, and drawn faintly also at rest; where most moved, marks would only be noise.
    Controls of shape (k, 3) have a lattice only where the deformer knows their ``links``; parameters and coefficients
    are not drawn at all.
    """
    rest, controls = deformer.rest, deformer.controls
    if controls.ndim not in {2, 4} or controls.shape[-1] != 3 or not controls.size:
        return np.empty((0, 3))
    at, before = controls.reshape(-1, 3), rest.reshape(-1, 3)
    moved = np.linalg.norm(at - before, axis=1) > 1e-9 * size
    if moved.mean() > 0.5:
        moved[:] = False
    ball = min(0.0085 * size, 0.16 * _closest(rest))
    wire = 0.17 * ball
    edges = lattice_edges(controls.shape[:3]) if controls.ndim == 4 else getattr(deformer, "links", None)
    if edges is not None:
        stretched = moved[edges].any(axis=1)
        add_lines(drawing, at, Ragged.of(edges), wire, theme.ink)
        if stretched.any():
            add_lines(drawing, before, Ragged.of(edges[stretched]), 0.7 * wire, theme.faint)
    if moved.any():
        ends = np.arange(2 * moved.sum(), dtype=np.int32).reshape(2, -1).T
        add_lines(drawing, np.vstack([before[moved], at[moved]]), Ragged.of(ends), 1.3 * wire, MOVED)
    add_balls(drawing, before[moved], 0.6 * ball, theme.faint)
    add_balls(drawing, at[~moved], ball, CONTROL)
    add_balls(drawing, at[moved], 1.3 * ball, MOVED)
    return at


def add_grid(drawing: Any, grid: WarpedGrid, size: float, theme: Theme) -> Points:
    """Draw a warped grid as fine lines, faint where nothing moves; where they are."""
    faint, strong = np.array(theme.faint), np.array(theme.grid)
    reach = float(grid.magnitude.max(initial=0.0)) or 1.0
    table = faint + np.sqrt(np.linspace(0, 1, 256))[:, None] * (strong - faint)
    add_lines(drawing, grid.points, grid.lines, 0.0011 * size, painted(Quantity("", grid.magnitude, 0.0, reach, table)))
    return grid.points


def add_arrows(drawing: Any, field: Arrows, spacing: float, theme: Theme) -> Points:
    """Draw displacements; where they are.

    They are to scale, unless the longest would be lost in the space between them, or outgrow it.
    """
    longest = float(field.magnitude.max(initial=0.0))
    if not longest:
        return np.empty((0, 3))
    pyvista = import_pyvista()
    kept = field.magnitude > 0.1 * longest
    scale = np.clip(longest, 0.8 * spacing, 1.15 * spacing) / longest
    positions, vectors = field.positions[kept], field.vectors[kept] * scale
    cloud = pyvista.PolyData(positions)
    cloud["vectors"] = vectors
    cloud["colors"] = painted(Quantity("", field.magnitude[kept], 0.0, longest, color_table(theme.sequence)))
    shape = pyvista.Arrow(tip_length=0.30, tip_radius=0.085, shaft_radius=0.026, tip_resolution=24, shaft_resolution=16)
    glyphs = cloud.glyph(orient="vectors", scale="vectors", geom=shape)
    style = {"smooth_shading": True, "split_sharp_edges": True, "ambient": 0.35, "diffuse": 0.7}
    drawing.add_mesh(glyphs, scalars="colors", rgb=True, **style)
    return np.vstack([positions, positions + vectors])


def lattice_edges(shape: tuple[int, ...]) -> NDArray[np.int32]:
    """(e, 2) pairs of neighbours in a lattice, as flat indices."""
    index = np.arange(np.prod(shape), dtype=np.int32).reshape(shape)
    ends = [(np.delete(index, -1, axis), np.delete(index, 0, axis)) for axis in range(3)]
    return np.vstack([np.stack([first.ravel(), second.ravel()], axis=1) for first, second in ends])


def _closest(rest: NDArray[np.float64]) -> float:
    """About how far neighbouring control points are apart."""
    if rest.ndim == 4:
        steps = [np.linalg.norm(np.diff(rest, axis=axis), axis=-1) for axis in range(3)]
        return min((float(np.median(step[step > 0])) for step in steps if (step > 0).any()), default=np.inf)
    return float(np.linalg.norm(np.ptp(rest, axis=0)) / len(rest) ** (1 / 3)) or np.inf
