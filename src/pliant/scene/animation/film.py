"""Films: MP4 and GIF, drawn frame by frame; the viewer may walk around what moves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pliant.errors import InvalidParameter, MissingExtra
from pliant.io.files import replacing
from pliant.io.report import LossReport
from pliant.rendering.films import draw_film
from pliant.scene.clip import Clip, Progress

MOST_FRAMES = 20_000


def write_clip(
    clip: Clip,
    path: Path,
    progress: Progress | None,
    *,
    size: tuple[int, int] = (800, 600),
    view: str | ArrayLike = "iso",
    up: str = "z",
    background: str = "light",
    turns: float = 0.0,
    texture: Path | str | None = None,
) -> LossReport:
    """A film of the clip.

    Parameters
    ----------
    clip, path, progress
        As for all formats.
    size
        Width and height in pixels, even numbers.
    view, up, background, texture
        As of :func:`pliant.render`.
    turns
        How often the viewer walks around in the clip: a turntable.

    Raises
    ------
    InvalidParameter
        A size that is not even, or too many frames.
    """
    if size[0] % 2 or size[1] % 2:
        raise InvalidParameter(f"a film's width and height are even numbers; given: {size}")
    if len(clip.times) > MOST_FRAMES:
        raise InvalidParameter(f"{len(clip.times):,} frames are too many for a film; lower fps or duration")
    count = len(clip.times)
    sequence = clip.sequence(None if progress is None else lambda done, _: progress(done, 2 * count))
    pictures = draw_film(
        clip.mesh, np.asarray(sequence.points), size=size, view=view, up=up, background=background, turns=turns,
        texture=texture,
    )  # fmt: skip
    with replacing(path) as temporary, _writer(temporary, clip.fps) as film:
        for done, picture in enumerate(pictures, start=1):
            film.append_data(picture)
            if progress is not None:
                progress(count + done, 2 * count)
    return LossReport(path, path.suffix[1:].upper(), (), ("a film shows the shape; it does not hold it",))


def _writer(path: Path, fps: float) -> Any:
    try:
        import imageio.v2 as imageio
        import imageio_ffmpeg  # noqa: F401  (carries the encoder)
    except ImportError as error:
        raise MissingExtra("writing films", "film") from error
    if path.suffix.lower() == ".gif":
        return imageio.get_writer(path, mode="I", duration=1000 / fps, loop=0)
    return imageio.get_writer(path, fps=fps, codec="libx264", quality=8, macro_block_size=2)
