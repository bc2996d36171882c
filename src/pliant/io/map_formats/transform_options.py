"""How a transform file is to be understood, where the file alone does not say."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import PolygonMesh

Placement = Literal["physical", "fit"]
Variant = Literal["A", "B", "C", "D"]
Edge = Literal["clamp", "zero", "identity"]


@dataclass(frozen=True)
class ReadOptions:
    """Choices of the caller of :func:`pliant.read_transform`, which explains them.

    Raises
    ------
    InvalidParameter
        A choice that there is not, or an origin that is no position.
    InvalidTarget
        ``placement="fit"`` without a target to fit to.
    """

    placement: Placement = "physical"
    variant: Variant | None = None
    target: PolygonMesh | None = None
    edge: Edge = "clamp"
    origin: ArrayLike | None = None

    def __post_init__(self) -> None:
        _require_choice("placement", self.placement, get_args(Placement))
        _require_choice("edge", self.edge, get_args(Edge))
        if self.variant is not None:
            _require_choice("variant", self.variant, get_args(Variant))
        if self.placement == "fit" and self.target is None:
            raise InvalidTarget("placement='fit' lays the lattice around a mesh: pass it as target=")
        if self.origin is not None:
            object.__setattr__(self, "origin", _position(self.origin))

    @property
    def fit_to(self) -> PolygonMesh | None:
        """The mesh to lay the lattice around; None where it lies as the file says."""
        return self.target if self.placement == "fit" else None

    def require_physical(self, path: Path) -> None:
        """Refuse to fit what lies where its file says.

        Raises
        ------
        InvalidParameter
            ``placement="fit"``.
        """
        if self.placement == "fit":
            raise InvalidParameter(f"{path}: this format says where its map lies: use placement='physical'")


def _require_choice(name: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InvalidParameter(f"{name}={value!r} is no choice; there are: {', '.join(map(repr, choices))}")


def _position(values: ArrayLike) -> NDArray[np.float64]:
    try:
        position = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        position = np.empty(0)
    if position.shape != (3,) or not np.isfinite(position).all():
        raise InvalidParameter(f"origin={values!r} is no position: three finite numbers are needed")
    return position
