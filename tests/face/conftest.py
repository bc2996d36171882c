"""A portrait that the scikit-image wheel carries, and the face in it."""

from __future__ import annotations

import numpy as np
import pytest
import skimage.data
from PIL import Image

import pliant as pl


@pytest.fixture(scope="session")
def portrait():
    """A photograph of 512 × 512 pixels with one face, 108 pixels high."""
    return Image.fromarray(skimage.data.astronaut())


@pytest.fixture(scope="session")
def found(portrait):
    from pliant.face.landmarks import find_landmarks

    return find_landmarks(portrait)[0]


@pytest.fixture(scope="session")
def face(portrait):
    return pl.face_from_photo(np.asarray(portrait))
