"""A part with what parts have: rounded edges, a bore, flat, cylindrical and spherical faces."""

import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

from pliant.cad import Part
from pliant.cad.kernel import parts_of


@pytest.fixture(scope="session")
def bracket():
    """A block of 40 x 20 x 60 mm, all edges rounded by 3 mm, with a bore of 12 mm."""
    block = BRepPrimAPI_MakeBox(gp_Pnt(-20, -10, 0), 40.0, 20.0, 60.0).Shape()
    rounding = BRepFilletAPI_MakeFillet(block)
    for edge in parts_of(block, "edge"):
        rounding.Add(3.0, edge)
    bore = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, -20, 40), gp_Dir(0, 1, 0)), 6.0, 40.0).Shape()
    return Part(BRepAlgoAPI_Cut(rounding.Shape(), bore).Shape())
