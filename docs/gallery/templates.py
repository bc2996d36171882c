"""Templates: motions that fit any shape.

Each row is a template, five moments of it: laid around the figure's bounding box by its recipe, a short text file.
`pliant animate bounce MESH -o bounce.glb` puts one on a mesh of yours. The number is how far any of them is, at the
end of a loop, from where it began: nothing, for a loop.
"""

from pathlib import Path

import numpy as np
from bodies import figure
from PIL import Image, ImageDraw

import pliant as pl
from pliant.rendering.films import draw_film

COLUMNS, MOMENTS = 3, 5


def main(out: Path, size: tuple[int, int] = (2100, 2160)) -> float:
    body, known = figure(0.05), pl.templates()
    rows = -(-len(known) // COLUMNS)
    cell = max(size[0] // COLUMNS // MOMENTS, 16), max(size[1] // rows, 16)
    sheet = Image.new("RGB", (cell[0] * COLUMNS * MOMENTS, cell[1] * rows), "white")
    gap = 0.0
    for place, (name, recipe) in enumerate(known.items()):
        clip = recipe.clip(body)
        last = {"once": 0.55, "loop": 0.8, "ping-pong": 1.0}[clip.ending] * clip.duration
        poses = np.stack([clip.sample(time).points for time in np.linspace(0.05 * last, last, MOMENTS)])
        strip = Image.fromarray(np.hstack(list(draw_film(body, poses, size=cell))))
        ImageDraw.Draw(strip).text((6, 4), name, fill=(60, 64, 72), font_size=max(cell[1] // 11, 8))
        sheet.paste(strip, (place % COLUMNS * strip.width, place // COLUMNS * cell[1]))
        if clip.ending == "loop":
            end = clip.stack_at(clip.duration * (1 - 1e-9))(body).points
            gap = max(gap, float(np.abs(end - clip.sample(0.0).points).max()))
    sheet.resize(size).save(out / "templates.png")
    return gap
