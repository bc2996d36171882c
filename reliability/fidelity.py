"""There and back through every format: `python -m reliability.fidelity --generated 1000`.

The meshes are those that installed packages carry, and generated ones with all that a mesh can hold. Whatever comes
back different must have been declared by the writer's report. A file that is read and written back as it is has the
same bytes; with other positions, all but the positions is the same.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import importlib.util
import tempfile
import warnings
from collections.abc import Container, Iterator
from pathlib import Path
from typing import Any

import pliant as pl
from pliant.errors import PliantError, PliantWarning
from pliant.io.meshes import formats
from reliability import generated
from reliability.compare import differences, undeclared
from reliability.ledger import Ledger, publish

_SLOW = (".vtk", ".vtu", ".msh")  # read in a process each: every so many generated meshes go there
_EVERY = 25
_PACKAGES = {"pyvista": "examples", "pymeshlab": "tests/sample_meshes", "trimesh": ".", "igl": ".", "open3d": "."}


def carried() -> dict[str, Path]:
    """The files of meshes that installed packages carry, by package and name; images are none."""
    endings = tuple(suffix for each in formats() if each["faces"] for suffix in each["suffixes"])
    found = {}
    for package, inside in _PACKAGES.items():
        spec = importlib.util.find_spec(package)
        for place in (spec.submodule_search_locations or ()) if spec is not None else ():
            for path in sorted(Path(place, inside).rglob("*")):
                if path.name.lower().endswith(endings):
                    found[f"{package}/{path.name}"] = path
    return found


def written() -> list[str]:
    """An ending of each format that is written, and of each of its dresses."""
    return [suffix for each in formats() if each["written"] for suffix in each["suffixes"]]


def there_and_back(mesh: pl.PolygonMesh, suffix: str, folder: Path) -> tuple[str, list[str]]:
    """Write, read and compare: "same", "refused", "declared" or "undeclared", and what was not said."""
    path = folder / f"mesh{suffix}"
    try:
        report = pl.write(mesh, path)
        again = pl.read(path)
    except PliantError as error:
        return "refused", [str(error)]
    wrong = undeclared(mesh, again, report)
    return "undeclared" if wrong else "declared" if differences(mesh, again) else "same", wrong


def own_format(path: Path, folder: Path) -> list[str]:
    """What is wrong with a file that is read and written back: as it is, and with other positions."""
    mesh, wrong = pl.read(path), []
    copy = folder / path.name
    pl.write(mesh, copy)
    if copy.read_bytes() != path.read_bytes():
        wrong.append("written back as it was, its bytes are others")
    moved = mesh.with_points(mesh.points + 0.25 * mesh.diagonal)
    pl.write(moved, copy)
    again = pl.read(copy)
    found = differences(moved.replace(carrier=None), again)
    return wrong + [f"moved: {name}: {what}" for name, what in found.items() if name not in ("points", "normals")]


def everything(count: int, done: Container[str] = ()) -> Iterator[tuple[str, pl.PolygonMesh]]:
    """All meshes but those that are done: carried ones, then generated ones."""
    for name, path in carried().items():
        if name not in done:
            with contextlib.suppress(PliantError):
                mesh = pl.read(path)
                if len(mesh.faces) or mesh.cells:
                    yield name, mesh
    if "pliant/mean face" not in done:
        yield "pliant/mean face", pl.mean_face()
    for number in range(count):
        if f"generated/{number}" not in done:
            yield f"generated/{number}", generated.mesh(number)


def run(count: int, ledger: Ledger) -> None:
    """Go through all meshes that the ledger does not have yet."""
    done = {entry["name"] for entry in ledger}
    with tempfile.TemporaryDirectory(prefix="pliant-fidelity-") as place, warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        folder = Path(place)
        for number, (name, mesh) in enumerate(everything(count, done)):
            common = name.startswith("generated") and number % _EVERY
            suffixes = [suffix for suffix in written() if not common or suffix not in _SLOW]
            ledger.add(name=name, trips={suffix: there_and_back(mesh, suffix, folder) for suffix in suffixes})
        for name, path in carried().items():
            if name in {entry["name"] for entry in ledger} and f"own {name}" not in done:
                ledger.add(name=f"own {name}", changed=own_format(path, folder))


def summary(ledger: Ledger) -> dict[str, Any]:
    """The figures of all that a ledger holds."""
    trips: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    wrong, refused, own = [], collections.Counter[str](), {}
    names = [entry["name"] for entry in ledger if "trips" in entry]
    for entry in ledger:
        if "changed" in entry:
            own[entry["name"].removeprefix("own ")] = entry["changed"]
        for suffix, (how, what) in entry.get("trips", {}).items():
            trips[suffix][how] += 1
            if how == "undeclared":
                wrong.append({"mesh": entry["name"], "format": suffix, "undeclared": "; ".join(what)})
            elif how == "refused":
                refused[f"{suffix}: {what[0].rpartition(': ')[2][:90]}"] += 1
    rows = [{"format": suffix, **{how: found[how] for how in ("same", "declared", "undeclared", "refused")}}
            for suffix, found in trips.items()]  # fmt: skip
    total = sum(trips.values(), collections.Counter[str]())
    return {"real meshes": sum(not name.startswith("generated") for name in names),
            "generated meshes": sum(name.startswith("generated") for name in names), "round trips": total.total(),
            "same": total["same"], "declared changes": total["declared"], "undeclared changes": total["undeclared"],
            "refused": total["refused"], "files written back in their own format": len(own),
            "of them changed": sum(map(bool, own.values())), "formats": rows, "undeclared": wrong[:40],
            "own format": [{"file": name, "changed": "; ".join(what)} for name, what in own.items() if what],
            "refusals": [{"why": why, "times": times} for why, times in refused.most_common(20)]}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generated", type=int, default=1000)
    parser.add_argument("--ledger", type=Path, default=Path("fidelity-ledger.jsonl"))
    options = parser.parse_args()
    ledger = Ledger(options.ledger)
    run(options.generated, ledger)
    publish("fidelity", summary(ledger))


if __name__ == "__main__":
    main()
