"""Regions of a mesh as they are typed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from pliant.cli.options import three_numbers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from pliant.mesh import PolygonMesh

FORMS = "all | 0-99,120 | sphere:X,Y,Z:R | geodesic:VERTEX:R | @FILE of indices"


def vertices(text: str, mesh: PolygonMesh, option: str) -> NDArray[np.int64]:
    """The vertices that a text names, one of :data:`FORMS`.

    Raises
    ------
    typer.BadParameter
        None of the forms.
    UnreadableFile
        A file of indices that is not there.
    """
    import numpy as np

    from pliant.surface import regions

    kind, _, rest = text.partition(":")
    if text == "all":
        return np.arange(len(mesh.points))
    if kind == "sphere":
        center, _, radius = rest.rpartition(":")
        return regions.sphere(mesh, three_numbers(center, option), _number(radius, option))
    if kind == "geodesic":
        start, _, radius = rest.partition(":")
        return regions.geodesic_ball(mesh, _indices(start, option), _number(radius, option))
    if text.startswith("@"):
        from pliant.io.files import read_bytes

        return _indices(
            ",".join(read_bytes(Path(text[1:])).decode("utf-8", "replace").replace(",", " ").split()), option
        )
    return _indices(text, option)


def _indices(text: str, option: str) -> NDArray[np.int64]:
    import numpy as np

    pieces = []
    for word in text.split(","):
        first, dash, last = word.strip().partition("-")
        if not first.isdecimal() or (dash and not last.isdecimal()) or len(first) + len(last) > 20:
            raise typer.BadParameter(f"{word!r} is no region; forms: {FORMS}", param_hint=option)
        low, high = int(first), int(last or first)
        if high - low > 1e9:
            raise typer.BadParameter(f"{word!r} names more vertices than any mesh has", param_hint=option)
        pieces.append(np.arange(low, high + 1))
    return np.unique(np.concatenate(pieces))


def _number(text: str, option: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a radius; forms: {FORMS}", param_hint=option) from None
    return value
