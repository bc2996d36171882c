"""Writing TOML: what a recipe is made of, as people would write it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(document: Mapping[str, Any]) -> str:
    """A document of values and of lists of tables, which come last, as TOML."""
    plain = {name: value for name, value in document.items() if not _tables(value)}
    lines = [f"{_key(name)} = {_value(value)}" for name, value in plain.items()]
    for name, value in document.items():
        for table in value if _tables(value) else ():
            lines += ["", f"[[{_key(name)}]]", *(f"{_key(key)} = {_value(item)}" for key, item in table.items())]
    return "\n".join([*lines, ""])


def _tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _word(name)


def _value(value: Any) -> str:
    if value is None:
        return "{ none = true }"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return _word(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {_value(item)}" for name, item in value.items()) + " }"
    return "[" + ", ".join(map(_value, value)) + "]"


def _word(text: str) -> str:
    """A basic string: JSON's escapes are TOML's, but for DEL and characters beyond the basic plane."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")
