"""The documentation's table of mesh formats is the code's own."""

import importlib.util
from pathlib import Path

from pliant.io.meshes import formats

HOOKS = Path(__file__).parents[2] / "docs" / "hooks.py"


def test_the_table_says_what_the_formats_say():
    spec = importlib.util.spec_from_file_location("docs_hooks", HOOKS)
    hooks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hooks)
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in hooks.mesh_formats().splitlines()]
    table = {row[0]: row[1:] for row in rows}
    for i, each in enumerate(formats()):
        assert each["name"] in table[""][i]
        assert all(f"`{ending}`" in table["endings"][i] for ending in each["suffixes"])
        for name in ("polygons", "groups", "cells", "lines", "materials", "written"):
            assert table[name][i] == ("yes" if each[name] else "–")
        assert table["corner texture coordinates"][i] == ("yes" if each["corner_uvs"] else "–")
        assert table["precision"][i] == (each["precision"] if each["written"] else "–")
