"""A process of its own in which meshio reads one gmsh file, so that a damaged one harms nobody.

Called as ``python -m pliant.io.mesh_formats.gmsh_child FILE OUT KIND BYTES SECONDS``, like its sibling for VTK.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.polydata_child import hand_over, limit


def main(path: str, out: str, memory: int, seconds: int) -> int:
    """Read a file within limits; returns the exit code."""
    limit(memory, seconds)
    import meshio

    mesh = meshio.gmsh.read(path)
    arrays: dict[str, NDArray[Any]] = {"points": np.asarray(mesh.points, np.float64)}
    for i, block in enumerate(mesh.cells):
        arrays[f"cells.{i}"] = np.asarray(block.data, np.int64)
    for i, values in enumerate(mesh.point_data.values()):
        arrays[f"point.{i}"] = np.asarray(values)
    for i, blocks in enumerate(mesh.cell_data.values()):
        arrays |= {f"cell.{i}.{j}": np.asarray(values) for j, values in enumerate(blocks)}
    meta = {
        "kinds": [block.type for block in mesh.cells],
        "point": list(mesh.point_data),
        "cell": list(mesh.cell_data),
        "physical": {name: [int(number) for number in pair] for name, pair in mesh.field_data.items()},
    }
    hand_over(out, arrays, meta)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[4]), int(sys.argv[5])))
