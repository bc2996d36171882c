"""Clip: a stack over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from pliant.errors import InvalidParameter
from pliant.io.report import LossReport
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_number
from pliant.scene.easing import Easing
from pliant.scene.keyed import keyed_layer
from pliant.scene.sequence import MeshSequence
from pliant.scene.stack import Stack
from pliant.scene.stack_binding import StackBinding
from pliant.scene.timing import Ending, Timing
from pliant.scene.track import Track
from pliant.scene.tracks import require_tracks, with_keys, without_key

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a clip: its time in seconds, and (n, 3) points, read-only."""

    time: float
    points: Points


@dataclass(frozen=True, eq=False)
class Clip:
    """A mesh under a stack whose values have keys in time. Every edit gives another clip.

    Parameters
    ----------
    mesh, stack
        What moves, and how it is deformed where no key says otherwise.
    duration
        Seconds; positive.
    fps
        Frames a second; positive.
    tracks
        The keys, see :meth:`key`.
    ending
        ``"once"``: it ends at the duration. ``"loop"``: it begins anew; the last frame is the first again.
        ``"ping-pong"``: it goes back; a period is twice the duration.
    intensity
        How much of all deformation there is: displacements are multiplied by it.
    motion
        A motion that the mesh has without the stack, which then deforms each of its frames.
    amplify
        How much that motion is exaggerated, away from the mesh at rest.

    Raises
    ------
    InvalidParameter
        An empty clip, values that are not finite, tracks of layers that are not there, a motion of another mesh.
    """

    mesh: PolygonMesh
    stack: Stack
    duration: float = 1.0
    fps: float = 24.0
    tracks: tuple[Track, ...] = ()
    ending: Ending = "once"
    intensity: float = 1.0
    motion: MeshSequence | None = None
    amplify: float = 1.0

    def __post_init__(self) -> None:
        self._timing  # noqa: B018 -- what no clip lasts is refused now, not later
        for name in ("intensity", "amplify"):
            as_number(f"the clip's {name}", getattr(self, name), InvalidParameter)
        if self.motion is not None and self.motion.count != len(self.mesh.points):
            raise InvalidParameter(
                f"the motion is one of {self.motion.count:,} points; the mesh has {len(self.mesh.points):,}"
            )
        object.__setattr__(self, "tracks", tuple(self.tracks))
        require_tracks(self.tracks, self.stack)

    def key(
        self, layer: str, time: float, values: Mapping[str, Any], easing: Easing | Sequence[float] = "linear"
    ) -> Clip:
        """The clip with one more key.

        Parameters
        ----------
        layer
            The layer's name.
        time
            In seconds.
        values
            By name: fields of the deformer that are numbers, as ``{"angle": 1.5}``; ``"controls"``, all of them, shaped
            as the deformer's; ``"envelope"``; ``"muted"``; or ``"frame"``, an :class:`~pliant.space.affine.Affine`
            by which the deformer moves over the object.
        easing
            How the values are reached from the key before: ``"step"``, ``"linear"``, ``"cubic"`` (a curve through the
            keys), ``"smooth"``, ``"ease_in_out"`` and others, or the handles (x1, y1, x2, y2) of a Bézier curve.

        Raises
        ------
        InvalidParameter
            No such layer or field, a value of another shape, an unknown easing.
        """
        return replace(self, tracks=with_keys(self.tracks, self.stack, layer, time, values, easing))

    def without_key(self, layer: str, field: str, time: float) -> Clip:
        """The clip without a key; a track without keys is gone.

        Parameters
        ----------
        layer, field
            Whose key.
        time
            When it is, in seconds.

        Raises
        ------
        InvalidParameter
            There is no such key.
        """
        return replace(self, tracks=without_key(self.tracks, layer, field, time))

    def on(self, mesh: PolygonMesh, stack: Stack) -> Clip:
        """The clip with another mesh and stack; keys of layers that are not there any more are left out.

        Parameters
        ----------
        mesh
            With as many points as the motion, where there is one.
        stack
            The layers.
        """
        tracks = tuple(track for track in self.tracks if track.layer in stack.names)
        return replace(self, mesh=mesh, stack=stack, tracks=tracks)

    def renamed(self, old: str, new: str, stack: Stack) -> Clip:
        """The clip on a stack in which a layer has another name: its keys go with it.

        Parameters
        ----------
        old, new
            The names.
        stack
            The stack with the new one.
        """
        tracks = tuple(replace(track, layer=new) if track.layer == old else track for track in self.tracks)
        return replace(self, stack=stack, tracks=tracks)

    @property
    def period(self) -> float:
        """Seconds after which it has been all through."""
        return self._timing.period

    @property
    def times(self) -> tuple[float, ...]:
        """The times of its frames: of a clip that returns to its beginning, each moment once."""
        return self._timing.times

    def stack_at(self, time: float) -> Stack:
        """The stack as the keys say at a time.

        Parameters
        ----------
        time
            In seconds; beyond the end, as the clip's ending says.
        """
        moment, stack = self._timing.moment(time), self.stack
        for name in dict.fromkeys(track.layer for track in self.tracks):
            values = {track.field: track.at(moment) for track in self.tracks if track.layer == name}
            stack = stack._exchanged(name, keyed_layer(stack[name], values))
        return stack

    def base_at(self, time: float) -> Points | None:
        """(n, 3) where the mesh's own motion has put its points at a time; None where it has none.

        Parameters
        ----------
        time
            In seconds.
        """
        if self.motion is None:
            return None
        frame = self.motion.at(self._timing.moment(time))
        return frame if self.amplify == 1.0 else self.mesh.points + self.amplify * (frame - self.mesh.points)

    def sample(self, time: float) -> PolygonMesh:
        """The mesh at a time, its normals too.

        Parameters
        ----------
        time
            In seconds; beyond the end, as the clip's ending says.
        """
        return self.posed(Frame(time, self._points(self._binding(), time)))

    def posed(self, frame: Frame) -> PolygonMesh:
        """The mesh as a frame of this clip has it, its normals too.

        Parameters
        ----------
        frame
            One of :meth:`frames`.
        """
        points = frame.points
        if self.motion is None and self.intensity == 1.0:
            return self.mesh.with_points(points, normals=self.stack_at(frame.time)._normals(self.mesh, points))
        from pliant.surface.shading import shading_normals

        return self.mesh.with_points(points, normals=shading_normals(self.mesh, points))

    def frames(self, progress: Progress | None = None) -> Iterator[Frame]:
        """Every frame, one after another.

        Parameters
        ----------
        progress
            Called with how many frames are done, and how many there are.
        """
        binding, times = self._binding(), self.times
        for done, time in enumerate(times, start=1):
            points = self._points(binding, time)
            if progress is not None:
                progress(done, len(times))
            yield Frame(time, points)

    def sequence(self, progress: Progress | None = None) -> MeshSequence:
        """All frames at once, as another clip's motion, or to be written.

        Parameters
        ----------
        progress
            As for :meth:`frames`.
        """
        frames = list(self.frames(progress))
        return MeshSequence(np.stack([frame.points for frame in frames]), [frame.time for frame in frames])

    def export(self, path: Path | str, *, progress: Progress | None = None, **options: Any) -> LossReport:
        """Write the clip: ``.glb``, ``.gltf``, ``.usd``, ``.pc2``, ``.mdd``, ``.pvd``, ``.abc``, ``.mp4`` or ``.gif``.

        Parameters
        ----------
        path
            Its ending says the format.
        progress
            As for :meth:`frames`.
        options
            The format's own; films take those of :func:`pliant.render`, and ``turns``.

        Raises
        ------
        UnsupportedFormat
            No format of animations has that ending.
        """
        from pliant.scene.animation.formats import export_clip

        return export_clip(self, path, progress=progress, **options)

    @cached_property
    def _timing(self) -> Timing:
        return Timing(self.duration, self.fps, self.ending)

    def _binding(self) -> StackBinding:
        return self.stack_at(0.0).bind(self.mesh)

    def _points(self, binding: StackBinding, time: float) -> Points:
        result = binding.updated(self.stack_at(time), self.base_at(time))
        return intensified(result, self.intensity)


def intensified(binding: StackBinding, intensity: float) -> Points:
    """(n, 3) what a binding gives, its displacements multiplied."""
    if intensity == 1.0:
        return binding.result
    return np.asarray(binding.points + intensity * (binding.result - binding.points))
