"""Templates applied to a scene: instead of what it has, or on top of that, from a moment on."""

from __future__ import annotations

from dataclasses import replace

from pliant.mesh import PolygonMesh
from pliant.scene.recipe import Recipe
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.modes.layering import free_name
from pliant.studio.modes.posing import clip_of


def begun_anew(scene: Scene, recipe: Recipe, intensity: float, duration: float | None, up: str) -> Scene:
    """The scene's mesh under a template alone."""
    if not recipe.moves:
        return scene.replace(stack=recipe.stack(scene.mesh, intensity=intensity, up=up), clip=None)
    clip = recipe.clip(scene.mesh, intensity=intensity, duration=duration, up=up)
    return scene.replace(stack=clip.stack, clip=clip)


def on_top(
    scene: Scene, shape: PolygonMesh, recipe: Recipe, intensity: float, duration: float | None, up: str, start: float
) -> Scene:
    """The scene with a template's layers above its own, laid around its shape as it is, their keys from a time on."""
    found = None if not recipe.moves else recipe.clip(shape, intensity=intensity, duration=duration, up=up)
    added = recipe.stack(shape, intensity=intensity, up=up) if found is None else found.stack
    names: dict[str, str] = {}
    for name in added.names:
        names[name] = free_name(name, [*scene.stack.names, *names.values()])
    layers = [layer.changed(name=names[layer.name]) for layer in added.layers]
    stack = Stack((*scene.stack.layers, *layers), scene.stack.mode if len(scene.stack) else added.mode)
    if found is None:
        return scene.replace(stack=stack)
    clip = clip_of(scene)
    tracks = [
        replace(
            track,
            layer=names[track.layer],
            keys=tuple(replace(key, time=key.time + start) for key in track.keys),
        )
        for track in found.tracks
    ]
    if not clip.tracks and clip.motion is None:
        clip = replace(clip, ending=found.ending, duration=found.duration)
    length = max(clip.duration, start + found.duration)
    return scene.replace(stack=stack, clip=replace(clip, stack=stack, duration=length, tracks=(*clip.tracks, *tracks)))
