"""What rides along on a mesh: values at corners, names of faces, materials."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidMesh, InvalidParameter
from pliant.numerics.ragged import frozen

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CornerValues:
    """Values kept per corner of a face, shared through a pool as in Wavefront OBJ.

    Parameters
    ----------
    values
        (k, d) the pool.
    indices
        (c,) which value each corner has, in the order of ``mesh.faces.flat``; -1 where a corner has none.
    """

    values: Floats
    indices: NDArray[np.int32]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))
        object.__setattr__(self, "indices", frozen(self.indices, np.int32))
        if self.values.ndim != 2:
            raise InvalidMesh(f"corner values have shape {self.values.shape}; one row a value is needed")
        if self.indices.size and not -1 <= self.indices.min() <= self.indices.max() < len(self.values):
            raise InvalidMesh(f"corners use value {_worst(self.indices)}; there are {len(self.values)}")

    @property
    def per_corner(self) -> Floats:
        """(c, d) the value at each corner; NaN where there is none."""
        padded = np.vstack([self.values, np.full((1, self.values.shape[1]), np.nan)])
        return padded[self.indices]


@dataclass(frozen=True, eq=False)
class FaceLabels:
    """A partition of the faces by name: groups, objects or materials.

    Parameters
    ----------
    names
        The names that occur.
    indices
        (f,) which name each face has; -1 where it has none.
    """

    names: tuple[str, ...]
    indices: NDArray[np.int32]

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "indices", frozen(self.indices, np.int32))
        if self.indices.size and not -1 <= self.indices.min() <= self.indices.max() < len(self.names):
            raise InvalidMesh(f"faces use label {_worst(self.indices)}; there are {len(self.names)}")

    def faces(self, name: str) -> NDArray[np.int64]:
        """The faces that carry a name.

        Parameters
        ----------
        name
            One of the names.

        Returns
        -------
        ndarray
            (k,) faces, ascending.

        Raises
        ------
        InvalidParameter
            It is none of them.
        """
        if name not in self.names:
            raise InvalidParameter(f"no label {name!r}; there are: {', '.join(self.names) or 'none'}")
        return np.flatnonzero(self.indices == self.names.index(name))


@dataclass(frozen=True)
class Material:
    """What a material library says of one material, as far as pliant draws it.

    Parameters
    ----------
    name
        What faces call it by.
    color
        The diffuse colour: red, green and blue in [0, 1].
    texture
        The image of the diffuse colour.
    properties
        Every line of the library as it stood: its word, and what follows.
    """

    name: str
    color: tuple[float, float, float] = (0.8, 0.8, 0.8)
    texture: Path | None = None
    properties: tuple[tuple[str, str], ...] = ()


def _worst(indices: NDArray[np.int32]) -> int:
    """The index that is too low, else the largest."""
    return int(indices.min() if indices.min() < -1 else indices.max())
