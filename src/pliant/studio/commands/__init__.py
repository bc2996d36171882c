"""What pages can ask for: small functions, registered by name when this package is imported."""

from pliant.studio.commands import (
    dragging,
    exporting,
    fields,
    history,
    layers,
    meshes,
    opening,
    points,
    transforms,
)

__all__ = ["dragging", "exporting", "fields", "history", "layers", "meshes", "opening", "points", "transforms"]
