"""The table of benchmarks keeps all that was measured, and says what was missed and what failed."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "benchmarks"
OUTPUT = """## Title

2026, `python x.py`, a machine.

| task | candidate | ms | ratio |
|---|---|--:|--:|
| one | pliant | 10.0 (9.0) | 1 |
|  | VTK | 70.0 (60.0) | 7.0 |
| two | pliant | 5.0 (4.0) | 1 |

A note.
"""


@pytest.fixture
def table(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])
    spec = importlib.util.spec_from_file_location("benchmark_table", FOLDER / "__main__.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_rows_and_notes_are_told_apart(table):
    rows, rest = table.sorted_out(OUTPUT)
    assert rows == [
        ("one", "pliant", "10.0 (9.0)", "1"),
        ("one", "VTK", "70.0 (60.0)", "7.0"),
        ("two", "pliant", "5.0 (4.0)", "1"),
    ]
    assert rest == "A note."
    assert table.sorted_out("| own | table |") == ([], "| own | table |")


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ({"ratio": 7}, "≥ 7"),
        ({"ratio": 8}, "**missed**: ≥ 8"),
        ({"ms": 70}, "≤ 70 ms"),
        ({"ms": 69}, "**missed**: ≤ 69 ms"),
    ],
)
def test_a_goal_is_reached_or_missed(table, goal, words):
    goals = [{"task": "on", "candidate": "V", **goal}]
    assert table.row("x", goals, "one", "VTK", "70.0 (60.0)", "7.0").endswith(f"| {words} |")
    assert table.row("x", goals, "two", "VTK", "70.0 (60.0)", "7.0").endswith("|  |")


def test_a_failure_is_a_row_and_the_text_around_the_table_stays(table, tmp_path, monkeypatch):
    page = tmp_path / "benchmarks.md"
    page.write_text(f"By hand.\n{table.BEGIN}\nold\n{table.END}\nBelow.\n", encoding="utf-8")
    monkeypatch.setattr(table, "PAGE", page)
    (tmp_path / "good.py").write_text(f"print({OUTPUT!r})")
    (tmp_path / "bad.py").write_text("raise SystemExit('no peer | here')")
    (tmp_path / "goals.toml").write_text("")
    monkeypatch.setattr(table, "FOLDER", tmp_path)
    assert table.main([]) == 1
    text = page.read_text(encoding="utf-8")
    assert text.startswith("By hand.\n")
    assert text.endswith("Below.\n")
    assert "old" not in text
    assert "| `bad.py` | **failed**: no peer / here |" in text
    assert "| `good.py` | one | VTK | 70.0 (60.0) | 7.0 |" in text


def test_every_goal_belongs_to_a_benchmark(table):
    goals = table.tomllib.loads((FOLDER / "goals.toml").read_text(encoding="utf-8"))
    assert all((FOLDER / f"{name}.py").exists() for name in goals)
