"""Control points without a browser: joints of patches stay smooth while some of them are dragged."""

import numpy as np
import pytest
from pages import joined

import pliant as pl
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.placed import place
from pliant.space.smooth_dragging import SmoothDrag
from pliant.studio.examples.samples import ball

BALL = ball()
LATTICE = pl.BezierFFD.around(BALL, patches=(2, 1, 1), margin=0.1)
FRAME = pl.Affine.rotation("z", 0.6, (0.2, 0.0, 0.0))
BESIDE = np.ravel_multi_index((2, 1, 2), LATTICE.shape)  # a joint
ACROSS = np.ravel_multi_index((4, 1, 2), LATTICE.shape)


@pytest.fixture(params=["as it is", "placed"])
def edited(request):
    deformer = LATTICE if request.param == "as it is" else place(LATTICE, FRAME)
    for session, page in joined(Scene(BALL, Stack((Layer("Patches", deformer),))), "ball"):
        yield session, page, (lambda points: points) if deformer is LATTICE else FRAME


def dragged(session, page, goal, **values):
    page.ask(session, "drag.begin", {"layer": "Patches"})
    return page.ask(session, "drag.move", values, index=np.array([BESIDE], np.uint32), positions=goal)


def test_a_dragged_point_takes_its_neighbours_along(edited):
    session, page, to_world = edited
    assert page.ask(session, "points.get", {"layer": "Patches"}).head["joints"]
    goal = LATTICE.rest.reshape(-1, 3)[BESIDE] + [0.0, 0.1, 0.3]
    answer = dragged(session, page, to_world(goal[None])[0], smooth=True)
    expected = SmoothDrag(LATTICE, np.array([BESIDE])).controls(goal[None])
    np.testing.assert_allclose(answer.arrays["controls"].reshape(-1, 3), to_world(expected), atol=1e-12)
    assert np.abs(expected - LATTICE.rest.reshape(-1, 3))[ACROSS].max() > 0.1
    page.ask(session, "drag.commit")
    made = session.scene.stack["Patches"].deformer.controls
    np.testing.assert_allclose(made.reshape(-1, 3), expected, atol=1e-12)


def test_without_the_switch_it_moves_alone_and_what_is_locked_stays(edited):
    session, page, to_world = edited
    rest = LATTICE.rest.reshape(-1, 3)
    goal = to_world(rest[[BESIDE]] + [0.0, 0.1, 0.3])[0]
    dragged(session, page, goal, smooth=False)
    page.ask(session, "drag.commit")
    made = session.scene.stack["Patches"].deformer.controls.reshape(-1, 3)
    assert np.abs(np.delete(made - rest, BESIDE, axis=0)).max() == 0
    page.ask(session, "points.lock", {"layer": "Patches", "locked": True}, index=np.array([ACROSS], np.uint32))
    dragged(session, page, goal + [0, 0, 0.2], smooth=True)
    page.ask(session, "drag.commit")
    made = session.scene.stack["Patches"].deformer.controls.reshape(-1, 3)
    assert made[ACROSS].tolist() == rest[ACROSS].tolist()


def test_other_lattices_have_no_joints_to_keep():
    lattice = pl.BSplineFFD.around(BALL)
    for session, page in joined(Scene(BALL, Stack((Layer("Patches", lattice),))), "ball"):
        assert not page.ask(session, "points.get", {"layer": "Patches"}).head["joints"]
        page.ask(session, "drag.begin", {"layer": "Patches"})
        told = page.refused(
            session, "drag.move", {"smooth": True}, index=np.array([1], np.uint32), positions=np.zeros(3)
        )
        assert "no joints" in told["message"]
