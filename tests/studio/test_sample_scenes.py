"""Scenes of the start page: as large as they say, for a mode that there is, and as good after a project file."""

import re
from pathlib import Path

import numpy as np
import pytest

import pliant as pl
from pliant.studio.examples.sample_scenes import SCENES

MODES = Path(__file__).parents[2] / "studio-client" / "src" / "modes"
OFFERED = sorted(name for name, each in SCENES.items() if each.there())


@pytest.mark.parametrize("name", OFFERED)
def test_a_scene_is_as_it_says_and_survives_its_project_file(name, tmp_path):
    scene = SCENES[name].make()
    assert len(scene.mesh.points) == SCENES[name].points
    pl.save_project(scene, tmp_path / "scene.pliant")
    again = pl.load_project(tmp_path / "scene.pliant")
    np.testing.assert_allclose(again.deformed().points, scene.deformed().points, atol=1e-9 * scene.mesh.diagonal)
    if scene.clip is not None:
        middle = scene.clip.duration / 3
        np.testing.assert_allclose(again.clip.sample(middle).points, scene.clip.sample(middle).points, atol=1e-9)


def test_every_mode_that_edits_has_a_scene():
    sources = "\n".join(path.read_text() for path in MODES.rglob("*.ts"))
    modes = set(re.findall(r"(?:readonly id(?:: string)? = |^ {2}id: )\"(\w+)\"", sources, re.MULTILINE)) - {"look"}
    assert len(modes) >= 9
    assert modes <= {scene.mode for scene in SCENES.values()}


def test_the_swallowing_column_closes_its_loop():
    clip = SCENES["swallowing-column"].make().clip
    start, end = clip.sample(0.0).points, clip.stack_at(clip.duration * (1 - 1e-12))(clip.mesh).points
    np.testing.assert_allclose(end, start, atol=1e-9)
    waist = [np.ptp(clip.sample(time).points[:, 1]) for time in (0.0, 1.2)]
    assert waist[1] > 1.1 * waist[0]  # something is in it
