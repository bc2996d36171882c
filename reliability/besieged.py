"""The studio that is attacked, in a process of its own: ``python -m reliability.besieged ROOT STATE``."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.bspline_ffd import BSplineFFD
from pliant.studio.examples.samples import torus
from pliant.studio.serving.launching import launch


def main(root: str, state: str) -> None:
    """Serve until the standard input ends; templates that are kept stay with its state."""
    os.environ["PLIANT_TEMPLATES"] = state
    mesh = torus(around=64, across=28)
    scene = Scene(mesh, Stack((Layer("Lattice", BSplineFFD.around(mesh, shape=(4, 4, 4), margin=0.05)),)))
    studio = launch(scene, "ring", port=0, root=Path(root), autosave=Path(state))
    studio.start()
    print(json.dumps({"url": studio.url, "port": studio.port}), flush=True)
    sys.stdin.read()
    studio.stop()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
