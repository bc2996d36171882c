"""Handles of a face in stacks, clips and project files."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.face.acting import expression_clip, face_stack
from pliant.face.expressions import expression
from pliant.scene.project import load_project, save_project
from pliant.scene.scene import Scene


def test_a_clip_passes_through_its_expressions_and_returns(face):
    clip = expression_clip(face, ["raised brows", ("smile", -0.5)], seconds=2.0)
    handles = pl.FaceHandles(face.landmarks)
    moves = [0, expression("raised brows"), 0, -0.5 * expression("smile"), 0]
    for time, move in enumerate(moves):
        expected = handles.moved(handles.rest + move)(face.mesh.points)
        assert np.allclose(clip.sample(float(time)).points, expected, atol=1e-9)
    assert clip.duration == 4.0


def test_a_project_keeps_the_handles(face, tmp_path):
    face.write(tmp_path / "face.obj")
    mesh, stack = pl.read(tmp_path / "face.obj"), face_stack(face)
    smiling = stack.replace("face", deformer=stack["face"].deformer.shifted({"mouth": (0, 0.2, 0.1)}))
    save_project(Scene(mesh, smiling), tmp_path / "face.pliant")
    again = load_project(tmp_path / "face.pliant")
    assert np.array_equal(again.stack(again.mesh).points, smiling(mesh).points)
    assert isinstance(again.stack["face"].deformer, pl.FaceHandles)


def test_a_clip_of_nothing_is_refused(face):
    with pytest.raises(InvalidParameter, match="no expression is named"):
        expression_clip(face, [])
    with pytest.raises(InvalidParameter, match="no expression is called 'grin'"):
        expression_clip(face, ["grin"])
    with pytest.raises(InvalidParameter, match="must be positive"):
        expression_clip(face, ["smile"], seconds=0)
