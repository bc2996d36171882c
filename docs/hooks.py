"""What the site is built from besides its pages: the gallery, run; the reference, from the list of public names.

Nothing is listed by hand: a script put into ``gallery/`` becomes a page with its picture, and a name exported by
``pliant/__init__.pyi`` becomes an entry of the reference, and so does every deformer.
"""

from __future__ import annotations

import ast
import importlib
import os
import re
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
GALLERY = ROOT / "docs" / "gallery"
PICTURES = GALLERY / "pictures"
HELPERS = {"bodies", "shapes", "hero"}
WHOLE = {"errors", "deformer"}  # modules shown whole, on pages of their own
ROOMS = {
    "": "Meshes and files",
    "space": "Deformers of space",
    "cages": "Building cages",
    "surface": "Deformers of surfaces",
    "shape": "Shape models",
    "field": "Looking at a deformation",
    "rendering": "Pictures",
    "scene": "Stacks, scenes and time",
    "face": "Faces",
    "batch": "Batches",
    "shapes": "Solids",
    "cad": "Parts from CAD",
    "studio": "The studio",
}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Draw what the pictures folder lacks, or holds older than the sources."""
    PICTURES.mkdir(exist_ok=True)
    sources = [*(ROOT / "src").rglob("*.py"), GALLERY / "bodies.py", GALLERY / "shapes.py"]
    newest = max(path.stat().st_mtime for path in sources)
    for script in scripts():
        picture = PICTURES / f"{script.stem}.png"
        if not picture.exists() or picture.stat().st_mtime < max(newest, script.stat().st_mtime):
            print(f"INFO    -  Drawing {picture.name}")
            load(script).main(PICTURES)
            os.utime(picture)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made here."""
    pages = {
        "gallery/index.md": gallery_index(),
        **{f"gallery/{script.stem}.md": gallery_page(script) for script in scripts()},
        **reference_pages(),
        "cli.md": command_line_page(),
    }
    for path, text in pages.items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Fill in the tables that the code itself knows."""
    for marker, table in (
        ("<!-- mesh formats -->", mesh_formats),
        ("<!-- transform formats -->", transform_formats),
        ("<!-- layers -->", layers),
    ):
        if marker in markdown:
            markdown = markdown.replace(marker, table())
    return markdown


def on_page_content(html: str, **_: Any) -> str:
    """Docstrings say :class:`Name` to their readers in the code; here it is the name alone."""
    return re.sub(r":(?:class|func|meth|attr|mod):(<code>)~?", r"\1", html)


def scripts() -> list[Path]:
    """The gallery's scripts, in the order of their names."""
    return sorted(path for path in GALLERY.glob("*.py") if path.stem not in HELPERS)


def load(script: Path) -> ModuleType:
    """A gallery script as a module; it finds the shapes beside it."""
    if str(GALLERY) not in sys.path:
        sys.path.insert(0, str(GALLERY))
    return importlib.import_module(script.stem)


def gallery_index() -> str:
    """All pictures, with titles."""
    cards = []
    for script in scripts():
        title = docstring(script)[0]
        picture = f"[![{title}](pictures/{script.stem}.png)]({script.stem}.md)"
        cards.append(f"<figure markdown>\n{picture}\n<figcaption>{title}</figcaption>\n</figure>\n")
    words = (
        "Each picture is drawn by a script of a few lines, which is a test too: it returns a number that must be right."
    )
    return f'# Gallery\n\n{words}\n\n<div class="gallery" markdown>\n\n' + "\n".join(cards) + "\n</div>\n"


def gallery_page(script: Path) -> str:
    """A script's words, its picture and its code."""
    title, text, code = docstring(script)
    return f"# {title}\n\n{text}\n\n![{title}](pictures/{script.stem}.png)\n\n```python\n{code}\n```\n"


def docstring(script: Path) -> tuple[str, str, str]:
    """A script's title, the text below it, and the code below that."""
    source = script.read_text(encoding="utf-8")
    tree = ast.parse(source)
    title, _, text = (ast.get_docstring(tree) or script.stem).partition("\n")
    code = "\n".join(source.splitlines()[tree.body[0].end_lineno :]).strip()
    return title.rstrip("."), text.strip(), code


def public_names() -> list[tuple[str, str]]:
    """(module, name) of everything that ``import pliant`` offers, and of every deformer, listed or not."""
    listed = _imported(ROOT / "src" / "pliant" / "__init__.pyi")
    rooms = [name for module, name in listed if not module]
    inside = [pair for room in rooms for pair in _imported(ROOT / "src" / "pliant" / room / "__init__.py")]
    return list(dict.fromkeys([pair for pair in listed if pair[0]] + inside + _deformers()))


def _deformers() -> list[tuple[str, str]]:
    """Every kind of deformer, found as the command line and the studio find it: it exists when its class does."""
    from pliant.scene.rooms import deformer_classes

    kinds = [kind for kind in deformer_classes().values() if kind.__module__.startswith("pliant.")]
    return [(kind.__module__.removeprefix("pliant."), kind.__name__) for kind in kinds]


def _imported(path: Path) -> list[tuple[str, str]]:
    """The names that a file hands on, each with its module as seen from pliant; rooms have none."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    return [
        ((node.module or "").removeprefix("pliant."), alias.asname or alias.name)
        for node in imports
        if node.level or (node.module or "").startswith("pliant.")
        for alias in node.names
    ]


def reference_pages() -> dict[str, str]:
    """A page a room, each public name on it, and an index of them all."""
    rooms: dict[str, list[tuple[str, str]]] = {}
    for module, name in public_names():
        room = module.split(".")[0]
        if room in WHOLE:
            continue
        rooms.setdefault(room if room in ROOMS else "", []).append((module, name))
    pages, index = {}, ["# Reference\n", "Everything that `import pliant` offers, by room of the house.\n"]
    for room, names in sorted(rooms.items(), key=lambda item: list(ROOMS).index(item[0])):
        page = room or "core"
        entries = [f"::: pliant.{module}.{name}\n    options:\n      heading_level: 2\n" for module, name in names]
        pages[f"reference/{page}.md"] = f"# {ROOMS[room]}\n\n" + "\n".join(entries)
        index.append(f"## [{ROOMS[room]}]({page}.md)\n")
        index.append(
            " · ".join(
                f"[`{name}`][pliant.{module}.{name}]" for module, name in sorted(names, key=lambda n: n[1].lower())
            )
            + "\n"
        )
    whole = "::: pliant.{}\n    options:\n      show_root_heading: false\n      heading_level: 2\n"
    pages["reference/errors.md"] = "# Errors\n\n" + whole.format("errors")
    pages["reference/deformer.md"] = "# Deformers and bindings\n\n" + whole.format("deformer")
    index.append("## [Deformers and bindings](deformer.md)\n\nThe interfaces that every deformer fulfils.\n")
    index.append("## [Errors](errors.md)\n\nWhat can go wrong, named by cause.\n")
    pages["reference/index.md"] = "\n".join(index)
    return pages


def command_line_page() -> str:
    """The help of each command, as the terminal shows it."""
    import click
    import typer

    from pliant.cli.app import app

    group = typer.main.get_command(app)
    parts = ["# Command line\n\nAngles are in degrees; `pliant demo` is a good first command.\n"]
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        context = click.Context(command, info_name=f"pliant {name}", terminal_width=100, max_content_width=100)
        parts.append(f"## pliant {name}\n\n```text\n{command.get_help(context)}\n```\n")
    return "\n".join(parts)


def mesh_formats() -> str:
    """What each mesh format keeps, from the formats themselves."""
    from pliant.io.meshes import formats

    known = formats()
    rows = [["", *(each["name"] for each in known)], ["---"] * (len(known) + 1)]
    rows.append(["endings", *(" ".join(f"`{ending}`" for ending in each["suffixes"]) for each in known)])
    properties = [key for key in known[0] if key not in {"name", "suffixes"}]
    for key in properties:
        name = key.replace("_", " ").replace("uvs", "texture coordinates")
        rows.append([name, *(cell(each[key] if each["written"] or key != "precision" else False) for each in known)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def transform_formats() -> str:
    """The transform formats: what they hold, and what their numbers mean."""
    from pliant.io.transforms import formats

    known = formats()
    columns = list(known[0])
    rows = [f"| {' | '.join(cell(row[column]) for column in columns)} |" for row in known]
    return "\n".join([f"| {' | '.join(columns)} |", "|---" * len(columns) + "|", *rows])


def layers() -> str:
    """The rooms of the house, the highest first, as the import linter knows them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    rooms = project["tool"]["importlinter"]["contracts"][0]["layers"]
    lines = []
    for room in rooms:
        names = [name.strip(" ()").removeprefix("pliant.") for name in room.split("|")]
        lines.append(f"| {', '.join(f'`{name}`' for name in names)} | {'<br>'.join(map(first_sentence, names))} |")
    return "\n".join(["| room | what it is for |", "|---|---|", *lines])


def first_sentence(room: str) -> str:
    """What the docstring of a room says first."""
    place = ROOT / "src" / "pliant" / room
    source = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    text = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) if source.exists() else ""
    return re.sub(r":\w+:`~?([^`]*)`", r"`\1`", (text or "").split("\n\n")[0].replace("\n", " "))


def cell(value: Any) -> str:
    """A cell of the table."""
    return ("yes" if value else "–") if isinstance(value, bool) else str(value)
