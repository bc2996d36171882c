"""The optional packages that cages are built with."""

from __future__ import annotations

from typing import Any

from pliant.errors import MissingExtra


def import_igl() -> Any:
    """The permissive part of libigl (MPL-2.0): distances, winding numbers, decimation."""
    try:
        import igl
    except ImportError:
        raise MissingExtra("building a cage", "cages") from None
    return igl


def import_measure() -> Any:
    """scikit-image's marching cubes."""
    try:
        from skimage import measure
    except ImportError:
        raise MissingExtra("building a cage", "cages") from None
    return measure


def import_manifold() -> Any:
    """manifold3d, or None: it confirms what is checked here."""
    try:
        import manifold3d
    except ImportError:
        return None
    return manifold3d
