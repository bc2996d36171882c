"""What pages can ask for: small functions, registered by name when this package is imported."""

from pliant.studio.commands import (
    axial,
    dragging,
    exporting,
    extended,
    fields,
    history,
    layers,
    meshes,
    model,
    opening,
    points,
    sites,
    surface,
    time,
    transforms,
)

__all__ = [
    "axial",
    "dragging",
    "exporting",
    "extended",
    "fields",
    "history",
    "layers",
    "meshes",
    "model",
    "opening",
    "points",
    "sites",
    "surface",
    "time",
    "transforms",
]
