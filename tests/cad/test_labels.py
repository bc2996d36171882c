"""Names, colours, layers and assemblies: they come through files and through deformations."""

from __future__ import annotations

from dataclasses import replace

import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.TCollection import TCollection_HAsciiString
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound

import pliant as pl
from pliant import cad
from pliant.cad.document import Document, each, labels
from pliant.cad.kernel import kernel, parts_of, settled
from pliant.cad.labels import Label, Places
from pliant.errors import LossRefused

BEND = pl.Bend(axis="z", angle=0.3, bounds=(0, 30), normal="x")
SAID = (
    Label("compound", 0, "machine", assembly=True),
    Label("compound", 1, "Träger 架", "left", assembly=True),
    Label("solid", 0, "block", "b1", (1.0, 0.0, 0.0, 1.0), ("steel", "visible")),
    Label("solid", 1, "rod", "r1", (0.0, 0.5, 0.0, 0.5)),
    Label("solid", 2, "block 2", "b2", (0.0, 0.0, 1.0, 1.0)),
    Label("face", 3, "lid", "", (1.0, 1.0, 0.0, 1.0), ("paint",)),
    Label("edge", 5, "", "", (0.0, 1.0, 1.0, 1.0)),
)


def compound(*shapes):
    made = TopoDS_Compound()
    BRep_Builder().MakeCompound(made)
    for shape in shapes:
        BRep_Builder().Add(made, shape)
    return made


@pytest.fixture(scope="module")
def machine():
    """A block and a rod, mounted together, and beside them another block."""
    first = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 10.0, 20.0, 30.0).Shape()
    second = BRepPrimAPI_MakeBox(gp_Pnt(20, 0, 0), 10.0, 20.0, 30.0).Shape()
    rod = BRepPrimAPI_MakeCylinder(4.0, 30.0).Shape()
    return cad.Part(compound(compound(first, rod), second), SAID)


def by_place(part):
    """What is said of all but edges: files hold those in another order."""
    return {(label.kind, label.index): label for label in part.labels if label.kind != "edge"}


def of_edges(part):
    return [label.color for label in part.labels if label.kind == "edge"]


def test_step_keeps_what_is_said(machine, tmp_path):
    report = cad.write(machine, tmp_path / "machine.step", strict=True)
    assert report.losses == ()
    again = cad.read(tmp_path / "machine.step")
    assert by_place(again) == by_place(machine)
    assert of_edges(again) == of_edges(machine) == [(0.0, 1.0, 1.0, 1.0)]


def test_deformations_keep_it_too(machine, tmp_path):
    cad.write(machine, tmp_path / "machine.step")
    read = cad.read(tmp_path / "machine.step")
    bent = read.deformed(BEND, tolerance=1e-2)
    cad.write(bent, tmp_path / "bent.step")
    again = cad.read(tmp_path / "bent.step")
    assert again.valid
    assert repr(again) == repr(machine)
    assert by_place(again) == by_place(machine)
    assert of_edges(again) == of_edges(machine)
    assert again.volume == pytest.approx(bent.volume, rel=1e-9)


def test_a_label_stays_on_its_face(machine, tmp_path):
    """The yellow face of the block is the one that it was: its middle lies where the map takes it."""
    bent = machine.deformed(BEND, tolerance=1e-3)
    cad.write(bent, tmp_path / "bent.step")
    again = cad.read(tmp_path / "bent.step")
    lid = next(label for label in again.labels if label.name == "lid")
    middles = [_middle(part, Label("face", 3)) for part in (bent, again)]
    assert _middle(again, lid) == pytest.approx(middles[0], abs=1e-6)
    assert middles[1] == pytest.approx(middles[0], abs=1e-6)


def _middle(part, label):
    found = kernel("GProp").GProp_GProps()
    kernel("BRepGProp").BRepGProp.SurfaceProperties_s(Places(part.shape).shape(label), found)
    center = found.CentreOfMass()
    return center.X(), center.Y(), center.Z()


def test_iges_keeps_colours_of_faces_and_says_what_it_does_not(machine, tmp_path):
    report = cad.write(machine, tmp_path / "machine.igs")
    assert report.format == "IGES"
    assert sorted(report.losses) == [
        "1 transparencies",
        "2 assemblies, as what is mounted into what",
        "3 names of layers, which become numbers",
    ]
    found = by_place(cad.read(tmp_path / "machine.igs"))
    colors = [found["face", i].color[:3] for i in range(15)]
    assert found["face", 3].name == "lid"
    assert colors[3] == (1.0, 1.0, 0.0)
    assert colors[:3] + colors[4:6] == [(1.0, 0.0, 0.0)] * 5
    assert colors[6:9] == [(0.0, 0.5, 0.0)] * 3
    assert colors[9:] == [(0.0, 0.0, 1.0)] * 6
    with pytest.raises(LossRefused, match="mounted"):
        cad.write(machine, tmp_path / "strict.igs", strict=True)
    assert not (tmp_path / "strict.igs").exists()


def test_a_part_that_is_mounted_twice_gets_a_shape_for_each(tmp_path):
    document = Document()
    box = document.shapes.AddShape(BRepPrimAPI_MakeBox(2.0, 2.0, 30.0).Shape(), False)
    document.set_name(box, "post")
    document.set_color(box, (0.0, 0.0, 1.0, 1.0), "solid")
    whole = document.shapes.NewShape()
    document.set_name(whole, "fence")
    for i in range(3):
        shift = gp_Trsf()
        shift.SetTranslation(gp_Vec(10.0 * i, 0, 0))
        at = document.shapes.AddComponent(whole, box, TopLoc_Location(shift))
        document.set_name(at, f"post {i}")
    document.shapes.UpdateAssemblies()
    writer = kernel("STEPCAFControl").STEPCAFControl_Writer()
    writer.Transfer(document.whole)
    writer.Write(str(tmp_path / "fence.step"))
    fence = cad.read(tmp_path / "fence.step")
    posts = [by_place(fence)["solid", i] for i in range(3)]
    assert [post.name for post in posts] == ["post"] * 3
    assert [post.instance for post in posts] == ["post 0", "post 1", "post 2"]
    assert {post.color for post in posts} == {(0.0, 0.0, 1.0, 1.0)}
    assert any("mounted elsewhere" in loss for loss in fence.unkept)
    bent = fence.deformed(BEND, tolerance=1e-2)
    assert bent.labels == fence.labels
    low, high = bent.mesh().bounds
    straight = BEND(fence.mesh())
    assert low == pytest.approx(straight.bounds[0], abs=0.05)
    assert high == pytest.approx(straight.bounds[1], abs=0.05)


def test_what_a_deformed_part_has_no_place_for_is_said(machine, tmp_path):
    document = Document()
    box = document.shapes.AddShape(BRepPrimAPI_MakeBox(2.0, 2.0, 30.0).Shape(), False)
    words = [TCollection_HAsciiString(word) for word in ("steel", "stainless", "7.9", "POSITIVE_RATIO_MEASURE")]
    tool = kernel("XCAFDoc").XCAFDoc_DocumentTool.MaterialTool_s(document.whole.Main())
    tool.SetMaterial(box, words[0], words[1], 7.9e-3, words[2], words[3])
    writer = kernel("STEPCAFControl").STEPCAFControl_Writer()
    writer.Transfer(document.whole)
    writer.Write(str(tmp_path / "box.step"))
    read = cad.read(tmp_path / "box.step")
    assert read.unkept == ("1 materials",)
    assert cad.write(read.deformed(BEND, tolerance=1e-2), tmp_path / "bent.step").losses == ("1 materials",)


def test_a_part_without_labels_is_called_after_its_file(machine, tmp_path):
    cad.write(replace(machine, shape=parts_of(machine.shape, "solid")[0], labels=()), tmp_path / "block.step")
    assert [label.name for label in cad.read(tmp_path / "block.step").labels] == ["block"]


def test_shapes_that_are_settled_are_where_they_were(machine):
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(5, 6, 7))
    moved = compound(machine.shape.Moved(TopLoc_Location(shift)))
    still = settled(moved)
    shapes = [shape for kind in ("compound", "solid", "face") for shape in Places(still)._all(kind)]
    assert all(shape.Location().IsIdentity() for shape in shapes)
    assert cad.Part(still).mesh().bounds[0] == pytest.approx(machine.mesh().bounds[0] + [5, 6, 7], abs=1e-9)


def test_labels_of_a_document_can_be_counted():
    document, found = Document(), labels()
    document.shapes.AddShape(BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Shape(), False)
    document.shapes.GetFreeShapes(found)
    assert len(each(found)) == 1
