"""What is saved while it is killed: processes that save, and how to tell which version a file holds."""

from __future__ import annotations

import resource
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

import pliant as pl
from pliant.errors import PliantError
from pliant.examples import vase

NAMES = ("a.pliant", "a.ply", "a.obj", "a.stl", "a.off", "a.glb", "a.3mf", "a.vtp", "a.ply.gz", "a.FFD")


def save(version: int, path: Path, around: int = 60, along: int = 40) -> None:
    """Save something that only this version is."""
    mesh = vase(100.0 + version, around, along)
    if path.suffix == ".pliant":
        pl.save_project(pl.Scene(mesh, pl.Stack([pl.Layer("twist", pl.Twist(angle=version, bounds=(0, 100)))])), path)
    elif path.suffix == ".FFD":
        displacements = np.full((12, 12, 12, 3), float(version))
        pl.write_transform(pl.BSplineFFD(displacements=displacements, origin=(0, 0, 0), spacing=(1, 1, 1)), path)
    else:
        pl.write(mesh, path)


def version_of(path: Path) -> int:
    """Which version a whole file holds; a part of a file is an error of its reader."""
    if path.suffix == ".pliant":
        scene = pl.load_project(path)
        twist: Any = scene.stack["twist"].deformer
        version = round(float(np.ptp(scene.mesh.points[:, 2]))) - 100
        assert version == round(twist.angle), "the mesh and the stack are of two versions"
        return version
    if path.suffix == ".FFD":
        lattice: Any = pl.read_transform(path)
        values = np.unique(np.round(np.abs(lattice.displacements), 3))
        assert len(values) == 1, "the lattice is of two versions"
        return int(values[0])
    return round(float(np.ptp(pl.read(path).points[:, 2]))) - 100


def save_without_end(path: Path, talk: Connection) -> None:
    """Save versions from 1 on, until killed."""
    save(0, path.with_name("warm" + "".join(path.suffixes)))
    version = 1
    while True:
        talk.send(("begin", version))
        save(version, path)
        talk.send(("end", version))
        version += 1


def save_within(path: Path, most: int, talk: Connection) -> None:
    """Save once where no file may grow beyond so many bytes."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    save_once(path, talk)


def save_once(path: Path, talk: Connection) -> None:
    """Save once, and say what came of it."""
    try:
        save(1, path)
        talk.send("saved")
    except PliantError as error:
        talk.send(type(error).__name__)
    except BaseException as error:
        talk.send(f"broken: {type(error).__name__}: {error}")
