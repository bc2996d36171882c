"""Landmarks are where the face is, however the photograph is scaled, turned or coloured; what is no face has none."""

from __future__ import annotations

import numpy as np
import pytest
import skimage.data
from PIL import Image

from pliant.face.landmarks import LEFT_EYE, RIGHT_EYE, NoFace, find_landmarks
from pliant.face.windows import Window


def off(points, others):
    """The root mean square distance in the picture, as a part of the distance of the eyes."""
    distance = np.linalg.norm(others[RIGHT_EYE, :2] - others[LEFT_EYE, :2])
    return np.sqrt(((points - others)[:, :2] ** 2).sum(axis=1).mean()) / distance


def test_landmarks_lie_where_the_features_are(portrait, found):
    right, left, nose, chin = found.points[[RIGHT_EYE, LEFT_EYE, 4, 152], :2]
    assert right[0] < nose[0] < left[0]  # the subject's right is on the viewer's left
    assert right[1] < nose[1] < chin[1]
    dark = np.asarray(portrait.convert("L"), float)
    mouth = found.points[[13, 14, 78, 308], :2].mean(axis=0)
    pupil = found.points[[159, 145], :2].mean(axis=0)
    cheek = found.points[50, :2]
    at = [dark[int(y), int(x)] for x, y in (pupil, mouth, cheek)]
    assert at[0] < at[2] < at[1] + 60  # an eye is darker than a cheek; teeth are bright
    assert found.points[4, 2] < found.points[[RIGHT_EYE, LEFT_EYE], 2].min()  # the nose is nearer


@pytest.mark.parametrize("scale", [0.25, 0.5, 2.0, 4.0])
def test_landmarks_keep_to_the_face_at_any_scale(portrait, found, scale):
    size = round(512 * scale)
    face = find_landmarks(portrait.resize((size, size), Image.Resampling.LANCZOS))[0]
    assert off(face.points / scale, found.points) < (0.04 if scale < 0.4 else 0.015)


@pytest.mark.parametrize("degrees", [-45, -20, 20, 45, 90, 135, 180, 270])
def test_landmarks_turn_with_the_photograph(portrait, found, degrees):
    turned = portrait.rotate(degrees, Image.Resampling.BICUBIC, expand=True)
    points = find_landmarks(turned)[0].points[:, :2] - np.array(turned.size) / 2
    t = np.radians(degrees)
    back = points @ np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]]) + 256
    assert off(np.column_stack([back, found.points[:, 2]]), found.points) < 0.035


def test_colour_light_and_noise_matter_little(portrait, found):
    pixels = np.asarray(portrait, float)
    noise = np.random.default_rng(0).normal(0, 12, pixels.shape)
    others = (pixels.mean(axis=2, keepdims=True) + 0 * pixels, 0.4 * pixels, pixels + noise)
    for other in others:
        image = Image.fromarray(np.clip(other, 0, 255).astype(np.uint8))
        assert off(find_landmarks(image)[0].points, found.points) < 0.03


def test_several_faces_are_listed_the_largest_first(portrait, found):
    wide = Image.new("RGB", (1100, 600), (90, 110, 130))
    wide.paste(portrait.resize((300, 300)), (20, 250))
    wide.paste(portrait, (330, 40))
    wide.paste(portrait.resize((240, 240)), (855, 20))
    faces = find_landmarks(wide)
    assert len(faces) == 3
    for face, (scale, x, y) in zip(faces, [(1, 330, 40), (300 / 512, 20, 250), (240 / 512, 855, 20)], strict=True):
        assert off(face.points, found.points * scale + [x, y, 0]) < 0.03


@pytest.mark.parametrize("name", ["chelsea", "coffee", "rocket", "moon", "retina", "coins"])
def test_no_face_is_found_where_there_is_none(name):
    with pytest.raises(NoFace, match=r"no face is found.*seen from the front"):
        find_landmarks(Image.fromarray(getattr(skimage.data, name)()).convert("RGB"))


def test_a_tiny_face_is_refused(portrait):
    with pytest.raises(NoFace):
        find_landmarks(portrait.resize((48, 48)))


def test_a_window_sees_what_lies_in_it():
    y, x = np.mgrid[0:80, 0:120] + 0.5
    image = Image.fromarray(np.stack([2 * x, 3 * y, 0 * x], axis=-1).astype(np.uint8))
    window = Window(60, 40, 40, np.radians(30))
    seen = window.seen(image, 20) * 255
    steps = (np.arange(20) + 0.5) / 20
    places = window.outside(np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2))
    assert np.abs(seen[..., :2].reshape(-1, 2) - places * [2, 3]).max() < 3.5  # colours are whole numbers
    assert not Window(-500, -500, 40).seen(image, 8).any()
