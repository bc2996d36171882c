"""What can be taken hold of: a small table of what each deformer's fields mean.

No handle needs an inverse, and a deformer that is new needs a line here: where its handle shall be seen.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.space.bend import Bend
from pliant.space.flare import Flare
from pliant.space.profile import as_profile
from pliant.space.scale import Scale
from pliant.space.sine import Sine
from pliant.space.squash import Squash
from pliant.space.tangent_frames import TangentFrames
from pliant.space.taper import Taper
from pliant.space.twist import Twist
from pliant.space.wave import Wave
from pliant.studio.modes.axial.handle import Handle, Place, Unit
from pliant.studio.modes.axial.moving import moved_to, rolled_to, turned_to
from pliant.studio.modes.axial.segments import segment_handles
from pliant.studio.modes.axial.tool import Tool

Floats = NDArray[np.float64]

_ALONG = np.linspace(0.0, 1.0, 65)  # where profiles are looked at
_WAVES = 64  # that are looked at


def handles_of(tool: Tool) -> tuple[Handle, ...]:
    """The handles of a tool: its own first, then those of its axis."""
    deformer = tool.deformer
    own = next((rows for kind, rows in TABLE.items() if isinstance(deformer, kind)), ())
    if isinstance(deformer, TangentFrames):
        own = segment_handles(tool)
    if isinstance(deformer, Scale):
        return (*own, _ORIGIN)
    bounds = _RADII if deformer.radial else _BOUNDS
    normal = (_NORMAL,) if getattr(deformer, "normal", None) is not None else ()
    return (*own, *bounds, _ORIGIN, _AXIS, *normal)


def number(name: str, place: Place, unit: Unit = "factor") -> Handle:
    """A number of the deformer."""
    return Handle(
        name,
        unit,
        lambda tool: np.array([getattr(tool.deformer, name) or 0.0]),
        lambda tool, value: tool.having(**{name: float(value[0])}),
        place,
    )


def carried(u: float, v: float, t: float) -> Place:
    """Where the deformer takes a place: sizes across the axis, and 0 to 1 between the bounds."""
    return lambda tool: tool.carried(tool.at(u, v, tool.between(t))[None])


def rim(tool: Tool) -> Points:
    """The rim where the deformer acts most, at the high bound where it does there."""
    return tool.carried(tool.at(1.0, 0.0, tool.between(strongest(tool.deformer, _ALONG[::-1])))[None])


def crest(tool: Tool) -> Points:
    """The top or bottom of a sine's first wave, or of the highest."""
    t = strongest(tool.deformer, _waves(tool.deformer, np.pi / 2))
    return tool.carried(tool.at(0.0, 0.0, tool.between(t))[None])


def strongest(deformer: Any, places: Floats) -> float:
    """The first of (k,) places, 0 to 1 between the bounds, at which a deformer's profile is as strong as at any."""
    strength = np.abs(np.broadcast_to(as_profile(deformer.profile).value(places), places.shape))
    return float(places[np.argmax(strength >= (1 - 1e-9) * strength.max())])


def _waves(deformer: Any, top: float) -> Floats:
    """(k,) tops and bottoms of waves between the bounds, a top being at an angle; the nearest, where there is none."""
    turns = (top + deformer.phase + np.pi * np.arange(-_WAVES, _WAVES)) / (2 * np.pi * deformer.waves or 1.0)
    inside = np.sort(turns[(turns >= 0) & (turns <= 1)])
    return inside if len(inside) else np.clip(turns[[np.abs(turns - 0.5).argmin()]], 0.0, 1.0)


def wave_end(tool: Tool) -> Points:
    """Where a sine's first wave ends."""
    return tool.above(tool.at(0.0, 0.5, tool.between(1.0 / (tool.deformer.waves or 1.0)))[None])


def ripple(t: Callable[[Any], float]) -> Place:
    """A place of a pond's surface, at a distance from its middle."""

    def place(tool: Tool) -> Points:
        distance = tool.between(t(tool.deformer)) / tool.size
        return tool.carried(tool.at(distance, 0.0, tool.origin @ tool.along)[None])

    return place


def stretched(column: int) -> Place:
    """Where a scale takes the end of one of its axes."""
    return lambda tool: tool.carried((tool.origin + tool.size * tool.axes[:, column])[None])


def _center(tool: Tool) -> Points:
    center = tool.deformer.center
    return tool.carried(tool.at(0.0, 0.55, tool.between(0.5) if center is None else center)[None])


def _bound(end: int, place: Place) -> Handle:
    def write(tool: Tool, value: Floats) -> Tool:
        bounds = list(tool.deformer.bounds)
        bounds[end] = float(value[0])
        return tool.having(bounds=tuple(bounds))

    return Handle(("low", "high")[end], "length", lambda tool: np.array([tool.deformer.bounds[end]]), write, place)


def _reach(tool: Tool) -> Floats:
    """(3,) from the origin to the tip of the axis, beyond the high bound."""
    deformer, along = tool.deformer, tool.along
    beyond = 0.0 if deformer.radial else max(deformer.bounds[1] - tool.origin @ along, 0.0)
    return np.asarray((beyond + 0.35 * tool.size) * along)


TABLE: dict[type, tuple[Handle, ...]] = {
    Twist: (number("angle", rim, "radians"),),
    Taper: (number("factor", rim),),
    Flare: (
        number("start", carried(1, 0, 0)),
        number("end", carried(1, 0, 1)),
        number("bulge", carried(1, 0, 0.5)),
    ),
    Squash: (number("factor", carried(1, 0, 1)),),
    Bend: (number("angle", carried(0, 0, 1), "radians"), number("center", _center, "length")),
    Sine: (number("amplitude", crest, "length"), number("waves", wave_end)),
    Wave: (
        number("amplitude", ripple(lambda deformer: strongest(deformer, _waves(deformer, 0.0))), "length"),
        number("waves", ripple(lambda deformer: 1.0 / (deformer.waves or 1.0))),
    ),
    Scale: (number("x", stretched(0)), number("y", stretched(1)), number("z", stretched(2))),
}
_BOUNDS = tuple(
    _bound(end, lambda tool, end=end: tool.above(tool.at(0.0, -1.0, tool.between(end))[None]))  # type: ignore[misc]
    for end in (0, 1)
)
_RADII = tuple(
    _bound(
        end,
        lambda tool, end=end: tool.above(  # type: ignore[misc]
            tool.at(0.0, -tool.deformer.bounds[end] / tool.size, tool.origin @ tool.along)[None]
        ),
    )
    for end in (0, 1)
)
_ORIGIN = Handle("origin", "place", lambda tool: tool.origin, moved_to, lambda tool: tool.above(tool.origin[None]))
_AXIS = Handle("axis", "direction", _reach, turned_to, lambda tool: tool.above((tool.origin + _reach(tool))[None]))
_NORMAL = Handle(
    "normal",
    "direction",
    lambda tool: 1.2 * tool.size * tool.axes[:, 0],
    rolled_to,
    lambda tool: tool.above((tool.origin + 1.2 * tool.size * tool.axes[:, 0])[None]),
)
