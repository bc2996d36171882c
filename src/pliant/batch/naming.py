"""Names of outputs: a pattern with words in braces, filled in for each input; no two may be the same."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from string import Formatter

from pliant.errors import InvalidParameter

WORDS = {
    "stem": "the input's name without its ending",
    "suffix": "its ending, with the dot",
    "parent": "the name of its folder",
    "index": "the job's number, as in {index:04d}",
    "copy": "which of several results from one input",
}


def output_paths(pattern: Path | str, inputs: Sequence[Path], copies: Sequence[int] | None = None) -> list[Path]:
    """One output an input.

    Parameters
    ----------
    pattern
        A path with words of :data:`WORDS` in braces.
    inputs
        The files to be read.
    copies
        Which result of its input each is; None = the only one.

    Raises
    ------
    InvalidParameter
        A word that is not known, two outputs of one name, or an output that would overwrite an input.
    """
    parts = _parsed(str(pattern))
    numbers = [0] * len(inputs) if copies is None else copies
    outputs = [Path(_filled(parts, path, i, copy)) for i, (path, copy) in enumerate(zip(inputs, numbers, strict=True))]
    taken: dict[str, int] = {}
    place_of = _places()
    sources = {place_of(path) for path in inputs}
    for i, output in enumerate(outputs):
        place = place_of(output)
        if place in taken:
            raise InvalidParameter(
                f"{inputs[taken[place]]} and {inputs[i]} would both be written to {output}: nothing was done (put "
                "{index} or {parent} into the pattern)"
            )
        if place in sources:
            raise InvalidParameter(
                f"{output} is an input, and would be overwritten: nothing was done (write elsewhere)"
            )
        taken[place] = i
    return outputs


def fixed_folder(pattern: Path | str) -> Path:
    """The folder that all outputs of a pattern lie in or below."""
    found = Path()
    for part in Path(pattern).parent.parts:
        if "{" in part:
            break
        found /= part
    return found


def _parsed(pattern: str) -> list[tuple[str, str | None, str]]:
    """Pieces of a pattern: what stands before a word, the word, and how it is written."""
    try:
        pieces = list(Formatter().parse(pattern))
    except ValueError as error:
        raise InvalidParameter(f"the pattern {pattern!r} is not understood: {error}") from error
    for _, word, _, turn in pieces:
        if word is not None and (word not in WORDS or turn):
            known = ", ".join("{" + name + "}" for name in WORDS)
            raise InvalidParameter(f"the pattern {pattern!r} has an unknown word {{{word}}}; there are: {known}")
    return [(before, word, spec or "") for before, word, spec, _ in pieces]


def _filled(parts: list[tuple[str, str | None, str]], path: Path, index: int, copy: int) -> str:
    suffix = "".join(path.suffixes[-2:]) if path.suffix.lower() == ".gz" else path.suffix
    stem = path.name[: len(path.name) - len(suffix)]
    values = {"stem": stem, "suffix": suffix, "parent": path.absolute().parent.name, "index": index, "copy": copy}
    try:
        return "".join(before + (format(values[word], spec) if word else "") for before, word, spec in parts)
    except ValueError as error:
        raise InvalidParameter(f"a word of the pattern cannot be written so: {error}") from error


def _places() -> Callable[[Path], str]:
    """What gives paths as the file system knows them; it is asked once about a folder."""
    resolved = cache(Path.resolve)

    def place(path: Path) -> str:
        return str(os.path.normcase(resolved(path.parent) / path.name))

    return place
