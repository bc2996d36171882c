"""The documentation as one PDF: `python packaging/manual.py [FOLDER]` writes pliant-manual.pdf.

The site is built, its pages are put one after the other in the order of the navigation, and chromium prints them. It
needs `pip install '.[docs]'` and a chromium.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mkdocs.commands.build import build
from mkdocs.config import load_config

ROOT = Path(__file__).parents[1]
STYLE = """
@page { size: A4; margin: 18mm 16mm; @bottom-center { content: counter(page); font: 8.5pt sans-serif; } }
@page :first { @bottom-center { content: none; } }
body { font: 10.5pt/1.45 "Noto Serif", "DejaVu Serif", serif; color: #222; }
h1 { break-before: page; font-size: 21pt; border-bottom: 2px solid #d98a1f; padding-bottom: 4pt; }
h1, h2, h3, h4, th { font-family: "Noto Sans", "DejaVu Sans", sans-serif; break-after: avoid; }
img { max-width: 100%; max-height: 120mm; break-inside: avoid; }
pre, code { font: 8.5pt/1.35 "DejaVu Sans Mono", monospace; }
pre { background: #f5f3ee; padding: 6pt 8pt; border-radius: 3pt; white-space: pre-wrap; overflow-wrap: anywhere; }
table { border-collapse: collapse; font-size: 8.5pt; width: 100%; }
th, td { border-bottom: 1px solid #ccc; text-align: left; vertical-align: top; padding: 2pt 4pt; }
td { overflow-wrap: anywhere; } td:first-child, .doc-param-default { overflow-wrap: normal; }
a { color: inherit; text-decoration: none; }
.headerlink, .md-content__button, .md-source-file, video { display: none; }
.gallery { display: grid; grid-template-columns: repeat(3, 1fr); gap: 6pt; } .gallery figure { margin: 0; }
.title { text-align: center; padding-top: 60mm; } .title h1 { break-before: auto; border: 0; font-size: 44pt; }
.contents { columns: 2; } .contents p { margin: 2pt 0 2pt 12pt; } .contents h4 { margin: 8pt 0 2pt; }
"""


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else "dist").absolute()
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        raise SystemExit("no chromium on this machine: install it, for instance by apt-get install chromium")
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="pliant-manual-") as name:
        site = Path(name, "site")
        config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(site), use_directory_urls=False)
        build(config)
        page = site / "manual.html"
        page.write_text(whole(site, list(in_order(config["nav"], site))), encoding="utf-8")
        target = out / "pliant-manual.pdf"
        command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
        command += ["--virtual-time-budget=60000", "--generate-pdf-document-outline"]
        command += [f"--print-to-pdf={target}", page.as_uri()]
        subprocess.run(command, check=True, capture_output=True, timeout=600)
    print(f"{target}: {target.stat().st_size / 2**20:.1f} MB, {pages(target)} pages")


def in_order(navigation: Any, site: Path) -> Iterator[Path]:
    """The pages as the navigation has them; what it leads to stands behind it."""
    for entry in navigation:
        for value in entry.values() if isinstance(entry, dict) else [entry]:
            if not isinstance(value, str):
                yield from in_order(value, site)
                continue
            path = site / Path(value).with_suffix(".html")
            yield path
            if path.name == "index.html" and path.parent != site:
                yield from sorted(each for each in path.parent.glob("*.html") if each != path)


def whole(site: Path, paths: list[Path]) -> str:
    """One page of all pages' articles; pictures are found from where it lies."""
    version = re.search(r'__version__ = "(.*)"', (ROOT / "src" / "pliant" / "_version.py").read_text(encoding="utf-8"))[
        1
    ]
    cover = (
        f'<div class="title"><h1>pliant</h1><p>Control many points with few.</p><p>Manual, version {version}</p></div>'
    )
    articles = [(path, article(path, site)) for path in paths]
    parts = [f'<!doctype html><html lang="en"><meta charset="utf-8"><style>{STYLE}</style><title>pliant</title>', cover]
    parts.append(contents(articles, site))
    parts += [f'<section id="{name(path, site)}">{text}</section>' for path, text in articles]
    return "\n".join(parts)


def article(path: Path, site: Path) -> str:
    """What a page says, without the site around it."""
    found = re.search(r"<article.*?>(.*?)</article>", path.read_text(encoding="utf-8"), flags=re.S)
    text = found[1] if found else ""
    return re.sub(r'(src=")(?!data:|https?:)([^"]+)', lambda m: m[1] + seen(path, m[2], site), text)


def contents(articles: list[tuple[Path, str]], site: Path) -> str:
    """The titles of all pages, folder by folder, each a link."""
    lines, folder = ["<h1>Contents</h1>", '<div class="contents">'], ""
    for path, text in articles:
        title = re.search(r"<h1[^>]*>(.*?)(?:<a |</h1>)", text, flags=re.S)
        here = path.parent.relative_to(site).as_posix()
        if here != folder:
            folder = here
            lines.append(f"<h4>{'' if here == '.' else here.replace('/', ', ').capitalize()}</h4>")
        if title:
            lines.append(f'<p><a href="#{name(path, site)}">{re.sub("<.*?>", "", title[1])}</a></p>')
    return "\n".join([*lines, "</div>"])


def name(path: Path, site: Path) -> str:
    """What links call a page's section."""
    return path.relative_to(site).with_suffix("").as_posix().replace("/", "-")


def seen(page: Path, link: str, site: Path) -> str:
    """A picture's place as seen from the site's root."""
    return (page.parent / link).resolve().relative_to(site.resolve()).as_posix()


def pages(path: Path) -> int:
    """How many pages a PDF has."""
    return len(re.findall(rb"/Type\s*/Page\b", path.read_bytes()))


if __name__ == "__main__":
    main()
