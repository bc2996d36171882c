"""The page of the documentation, written anew from the figures: `python -m reliability`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from reliability.ledger import FIGURES, table

PAGE = FIGURES.parents[1] / "docs" / "reliability.md"
_HEAD = """# Reliability

What pliant withstands is tried by the programs in `reliability/`, which run once and report; the tests run a little of
each with every change. Each program goes on where its ledger ends, and writes its figures for machines too
(`reliability/figures`). The machine has two processors, and other work shared them: loads are in the tables. Figures
that miss their goal are shown as they are. This page is written by `python -m reliability`.
"""
_TRIALS = {
    "fuzz": """## Damaged files

Files of every kind that pliant reads (meshes, transforms, shape models, projects, landmarks, recipes, motions, images,
pairs, weights of cages, CAD parts) are damaged: cut, flipped, spliced, numbers replaced, and inside their packings, so
that checksums still hold. Each mutant is read in a process that may take 10 s of the processor and 1 GiB for it; what
is accepted is looked at: every position finite, every index in its range, the stack of a project evaluated, a transform
applied. Broken are a crash, a hang, more memory, an error that is not pliant's, or something unsound that was accepted:
the goal is none. Some 120,000 mutants before this run found what was mended since: crashes of Open CASCADE, and memory
that USD took; errors that were not pliant's own from Alembic, USD, HDF5, `.npz`, landmarks, models, projects and
recipes; rows of faces in projects that did not fit; recipes that laid lattices larger than the machine. Parts were
read in a run of their own, each in a process forked from one that has imported Open CASCADE.""",
    "fidelity": """## There and back

Meshes that installed packages carry, and generated ones with polygons of any size, seams, corners without coordinates,
names, attributes, lines and unused vertices, are written to every format and read again: order, polygons, texture
coordinates and normals at corners, groups, objects, materials, lines and attributes are compared. Whatever differs must
have been declared in the writer's report: the goal is no undeclared change.""",
    "mathematics": """## Laws

Cases of each deformer with structure, controls and targets drawn at random, over six orders of size. At rest nothing
moves (1e-12 of the diagonal); pushed and pulled derivatives are transposes (1e-10); they (1e-6) and Jacobians (1e-6)
agree with finite differences. "Kinks" are points where a map is not smooth within a difference's reach, which are left
out; "refused" are cases that the deformer refuses with its own error, as a bend tighter than the shape is thick.
Conditioned models, faces, inverses, stacks and further coordinates of cages were tried in a run of their own.""",
    "peers": """## Peers

Where other programs do the same thing, they must agree; differences are parts of the points' extent.""",
    "saving": """## Saving

Processes that save are killed (SIGKILL) at random moments; afterwards the file must be whole: the old version or the
new one. Where there is no room, on a small disk that is full or under a limit for the size of files, the error must be
pliant's own, the old file must be as it was, and nothing may be left beside it.""",
    "attack": """## The studio under attack

Attackers without a key send requests, attackers with one send frames as a page gone mad would: every command there is,
with values that are nearly right, wrong or damaged. Linux watches the folder beside the studio's own: nobody may open a
file there. An honest page asks meanwhile, for the page, a sign of life, files and control points; the goal is 200 ms
for 99 of 100 answers. What only reads is answered beside the session, of the scene as it stands, and what an edit takes
long for is computed there; before, when all commands were done one after another, 99 of 100 honest frames took up to
434 ms, and single rounds a second. What kept the interpreter from all threads, as libigl does, is asked in slices or in
a process of its own. Edits still wait for one another. Rounds in which other work took the processors too are in the
table; they are the slow ones. This run found nothing that answers wrongly; one of the nine studios
grew to 1.3 GB while it exported. The run before found two numbers that were too large for what was
done with them, a scale and a vertex: they are refused by name since. Mended before were a region that grew by as many
rings as were asked for, without end, and names that are too long.""",
    "losing": """## Batches

A batch on a Dask cluster of processes whose workers are killed, and that is shut down when half is done; the next
cluster goes on by the ledger. Every job has exactly one outcome, and the files are those of a serial run, bit
for bit.""",
}


def page() -> str:
    """The whole page."""
    parts = [_HEAD]
    for name, words in _TRIALS.items():
        path = FIGURES / f"{name}.json"
        if path.exists():
            parts += [words, _section(json.loads(path.read_text()))]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _section(figures: dict[str, Any]) -> str:
    told = f"{figures.pop('date')}, `{figures.pop('command')}`, Python {figures.pop('python')}, "
    told += f"{figures.pop('processors')} processors, load {figures.pop('load')}."
    for row in figures.get("bugs", []):
        row.pop("frame", None)
    return f"{told}\n\n{table(figures)}"


if __name__ == "__main__":
    Path(PAGE).write_text(page())
