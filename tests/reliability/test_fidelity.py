"""There and back through every format: what is lost has been declared."""

from __future__ import annotations

import pytest

import pliant as pl
from reliability import generated
from reliability.compare import differences, undeclared
from reliability.fidelity import carried, own_format, there_and_back, written

pytestmark = pytest.mark.filterwarnings("ignore::pliant.errors.PliantWarning")
QUICK = [suffix for suffix in written() if suffix not in (".vtk", ".vtu", ".msh")]


@pytest.mark.parametrize("suffix", QUICK)
def test_generated_meshes_lose_nothing_that_is_not_declared(suffix, tmp_path):
    for number in range(6):
        how, wrong = there_and_back(generated.mesh(10_000 + number), suffix, tmp_path)
        assert how != "undeclared", wrong


def test_files_of_packages_are_written_back_as_they_are(tmp_path):
    files = {name: path for name, path in carried().items() if name.startswith("pyvista/") and path.suffix == ".ply"}
    assert len(files) >= 3
    for name, path in files.items():
        assert own_format(path, tmp_path) == [], name


def test_what_is_not_said_is_noticed(tmp_path):
    mesh = generated.mesh(1)
    report = pl.write(mesh, tmp_path / "a.ply")
    swapped = mesh.replace(points=mesh.points[::-1])
    assert undeclared(mesh, swapped, report)
    assert differences(mesh, mesh) == {}
