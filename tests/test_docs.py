"""The tutorials do what they say: their code runs as it stands, in the order in which it stands."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pliant as pl
from pliant import examples
from pliant.cli.app import app

DOCS = Path(__file__).parents[1] / "docs"


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), flags=re.S)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a mesh, where pictures are drawn fast."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pliant.rendering.pictures.FINER", 1)
    pl.write(examples.vase(around=24, along=16), "shape.obj")
    return tmp_path


def test_the_tutorial_bends_the_shape_and_writes_what_it_bent(folder):
    names: dict = {}
    for code in blocks("tutorial.md", "python"):
        exec(compile(code, "tutorial.md", "exec"), names)
    rest, bent = pl.read("shape.obj"), pl.read("bent.obj")
    np.testing.assert_allclose(bent.points, names["points"], atol=1e-12 * rest.diagonal)
    np.testing.assert_array_equal(bent.faces.flat, rest.faces.flat)
    np.testing.assert_allclose(names["drag"].points, names["points"], atol=1e-12 * rest.diagonal)
    np.testing.assert_allclose(names["again"](rest.points), bent.points, atol=1e-6 * rest.diagonal)
    assert {"bent.png", "field.png", "ratio.png", "bent.FFD"} <= {path.name for path in folder.iterdir()}

    for path in ("bent.obj", "bent.png"):
        (folder / path).unlink()
    for line in blocks("tutorial.md", "bash")[0].splitlines():
        done = CliRunner().invoke(app, shlex.split(line)[1:])
        assert done.exit_code == 0, done.output
    np.testing.assert_allclose(pl.read("bent.obj").points, bent.points, atol=1e-6 * rest.diagonal)
    assert (folder / "bent.png").exists()


def test_the_first_page_moves_a_control_point(folder):
    names: dict = {}
    exec(compile(blocks("index.md", "python")[0], "index.md", "exec"), names)
    moved = np.linalg.norm(pl.read("bent.obj").points - names["mesh"].points, axis=1)
    assert 0 < moved.max() < 0.2 * names["mesh"].diagonal  # a control point attracts, and does not reach


def run(page: str) -> dict:
    """Runs a page from top to bottom, Python and commands; gives the names it leaves."""
    names: dict = {"__name__": "__main__"}
    text = (DOCS / page).read_text(encoding="utf-8")
    for language, code in re.findall(r"```(python|bash)\n(.*?)```", text, flags=re.S):
        if language == "python":
            exec(compile(code, page, "exec"), names)
            continue
        for line in code.splitlines():
            done = CliRunner().invoke(app, shlex.split(line)[1:])
            assert done.exit_code == 0, (line, done.output)
    return names


def test_the_student_sees_that_splines_are_local(folder):
    names = run("tutorials/graphics-student.md")
    assert names["reached"]["spline"] < names["reached"]["bezier"] / 2
    assert pl.certify(names["folding"]).status == "folds"
    assert pl.certify(names["safe"]).lower > 0


def test_the_engineer_gets_less_skin_around_the_same_volume(folder):
    names = run("tutorials/shape-optimisation.md")
    assert names["found"].fun < 0.96 * pl.area(names["pod"])
    assert pl.volume(names["best"](names["pod"])) == pytest.approx(names["whole"], rel=1e-5)
    again = pl.read_transform(folder / "best.FFD")
    np.testing.assert_allclose(again(names["pod"].points), names["best"](names["pod"].points), atol=1e-5)


def test_the_researcher_finds_the_patient_again(folder):
    names = run("tutorials/medical-imaging.md")
    assert names["fitted"].distance < min(0.5, names["before"].distance)  # mm
    moved = pl.read(folder / "moved" / "organ.ply")
    np.testing.assert_allclose(names["transform"](moved.points), names["organ"].points, atol=1e-6)
    np.testing.assert_allclose(pl.read(folder / "organ-in-target.ply").points, moved.points, atol=1e-6)


def test_the_animator_exports_what_was_keyed(folder):
    names = run("tutorials/animator.md")
    motion, wild = names["motion"], names["wild"]
    np.testing.assert_allclose(motion.points[7], wild.sample(7 / 24).points, atol=1e-4 * names["body"].diagonal)
    assert {"jelly.glb", "bounce.glb", "jump.glb", "jump.pliant"} <= {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("marker", ["demo", "test"])
def test_both_readmes_give_the_same_commands(marker):
    english, chinese = (
        re.search(rf"<!-- {marker} -->\n```sh\n(.*?)```", (DOCS.parent / name).read_text(encoding="utf-8"), re.S)[1]
        for name in ("README.md", "README.zh.md")
    )
    assert english == chinese


def test_the_deformer_of_the_contributing_page_is_one_file(tmp_path):
    page = (DOCS.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (tmp_path / "swirl.py").write_text(re.search(r"```python\n(.*?)```", page, flags=re.S)[1], encoding="utf-8")
    (tmp_path / "try_it.py").write_text(
        "import numpy as np\n"
        "from swirl import Swirl\n"
        "from pliant.cli.deformer_options import deformers\n"
        "from pliant.studio.seen.catalogue import _lasting\n"
        "from pliant.testing import check_deformer\n"
        "check_deformer(Swirl(bounds=(0.0, 2.0), angle=0.7), np.random.default_rng(0).normal(size=(100, 3)))\n"
        "assert np.allclose(Swirl(bounds=(0.0, 2.0), angle=0.7)([[50.0, 0.0, 1.0]]), [[50.0, 0.0, 1.0]])\n"
        "assert deformers()['swirl'] is Swirl\n"
        "assert 'swirl' in [kind['name'] for kind in _lasting()['kinds']]\n",
        encoding="utf-8",
    )
    done = subprocess.run([sys.executable, "try_it.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
