"""ITK's matrix transforms: y = M (x - c) + c + t, with M written in many ways.

Conventions from the ITK Software Guide, "Transforms": angles in radians; a versor is the vector part of a unit
quaternion; c, the centre, stands among the fixed parameters.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pliant.space.affine import Affine

Floats = NDArray[np.float64]

_Z_FIRST = 3  # place of Euler3DTransform's switch among the fixed parameters


def euler(angles: Floats, *, zyx: bool) -> Floats:
    """(3, 3) rotation by angles about x, y and z: Rz Rx Ry, or Rz Ry Rx."""
    x, y, z = (Affine.rotation(name, float(angle)).linear for name, angle in zip("xyz", angles, strict=True))
    return np.asarray(z @ y @ x if zyx else z @ x @ y)


def versor(vector: Floats) -> Floats:
    """(3, 3) rotation whose unit quaternion has this vector part."""
    length = float(np.linalg.norm(vector))
    if length == 0:
        return np.eye(3)
    return Affine.rotation(vector, 2 * float(np.arcsin(min(length, 1.0)))).linear


Pieces = tuple[Floats, Floats]  # M and t
Rule = Callable[[Floats, Floats], Pieces]  # of parameters and fixed parameters

_NONE = np.zeros(3)

RULES: dict[str, tuple[int, Rule]] = {
    "AffineTransform": (12, lambda p, _: (p[:9].reshape(3, 3), p[9:])),
    "MatrixOffsetTransformBase": (12, lambda p, _: (p[:9].reshape(3, 3), p[9:])),
    "Rigid3DTransform": (12, lambda p, _: (p[:9].reshape(3, 3), p[9:])),
    "Euler3DTransform": (6, lambda p, f: (euler(p[:3], zyx=len(f) > _Z_FIRST and f[_Z_FIRST] != 0), p[3:])),
    "VersorTransform": (3, lambda p, _: (versor(p), _NONE)),
    "VersorRigid3DTransform": (6, lambda p, _: (versor(p[:3]), p[3:])),
    "Similarity3DTransform": (7, lambda p, _: (p[6] * versor(p[:3]), p[3:6])),
    "ScaleVersor3DTransform": (9, lambda p, _: (versor(p[:3]) + np.diag(p[6:] - 1), p[3:6])),
    "ScaleTransform": (3, lambda p, _: (np.diag(p), _NONE)),
    "TranslationTransform": (3, lambda p, _: (np.eye(3), p)),
    "IdentityTransform": (0, lambda _p, _f: (np.eye(3), _NONE)),
}
"""For each kind: how many parameters it has, and M and t from them."""


def affine_of(kind: str, fixed: Floats, parameters: Floats) -> Affine:
    """The map of a matrix transform of one of the kinds in :data:`RULES`, whose counts have been checked."""
    linear, shift = RULES[kind][1](parameters, fixed)
    center = fixed[:3] if len(fixed) >= 3 else _NONE
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, shift + center - linear @ center
    return Affine(matrix, "pull-back")
