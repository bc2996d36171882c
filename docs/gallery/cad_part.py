"""A part from CAD, before and after: a bracket with rounded edges and bores is twisted, and stays what it is.

Its faces are B-spline surfaces afterwards, not triangles: knots are added until each is within a micrometre of its
exact image, faces share their edges as before, and what was smooth is smooth. The number is the part of its volume that
a twist, which keeps volume, has lost.
"""

from pathlib import Path

import numpy as np
from OCP import BRepAlgoAPI, BRepFilletAPI, gp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from PIL import Image

import pliant as pl
from pliant.cad.kernel import parts_of


def main(out: Path, size: tuple[int, int] = (1200, 900)) -> float:
    part = bracket()
    twist = pl.Twist(axis="z", angle=np.pi / 2, bounds=(0.0, 60.0), profile="smooth")
    twisted = part.deformed(twist, tolerance=1e-3)
    half, panels = (size[0] // 2, size[1]), []
    for each in (part, twisted):
        mesh = pl.shapes.solid(each.mesh(2e-4)).deformed(pl.Affine(np.eye(4)), edge=1.5).mesh  # cut finely, for colours
        panels.append(pl.render(mesh, None, color=mesh.points[:, 2], legend=False, view=(1.4, -2, 0.6), size=half))
    Image.fromarray(np.concatenate(panels, axis=1)).save(out / "cad_part.png")
    return 1 - twisted.volume / part.volume


def bracket() -> pl.cad.Part:
    """A block of 40 x 20 x 60 mm whose edges are rounded, with three bores; usually pl.cad.read("bracket.step")."""
    block = BRepPrimAPI_MakeBox(gp.gp_Pnt(-20, -10, 0), 40.0, 20.0, 60.0).Shape()
    rounding = BRepFilletAPI.BRepFilletAPI_MakeFillet(block)
    for edge in parts_of(block, "edge"):
        rounding.Add(3.0, edge)
    shape = rounding.Shape()
    for x, z, radius in ((0, 42, 9.0), (-10, 14, 4.0), (10, 14, 4.0)):
        bore = BRepPrimAPI_MakeCylinder(gp.gp_Ax2(gp.gp_Pnt(x, -20, z), gp.gp_Dir(0, 1, 0)), radius, 40.0).Shape()
        shape = BRepAlgoAPI.BRepAlgoAPI_Cut(shape, bore).Shape()
    return pl.cad.Part(shape)
