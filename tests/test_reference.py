"""The reference has no gaps: every public name is on a page, with words for each parameter."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import re
from functools import cached_property
from pathlib import Path
from types import FunctionType

import pytest

import pliant as pl

Method = FunctionType | classmethod | staticmethod | property | cached_property


@pytest.fixture(scope="module")
def hooks():
    path = Path(__file__).parents[1] / "docs" / "hooks.py"
    spec = importlib.util.spec_from_file_location("docs_hooks", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def public(hooks):
    for module, name in hooks.public_names():
        yield f"{module}.{name}", getattr(importlib.import_module(f"pliant.{module}"), name)


def test_every_name_that_is_handed_on_has_a_place_in_the_reference(hooks):
    pages = "\n".join(hooks.reference_pages().values())
    whole = {"PliantError", "PliantWarning"}  # on the page of errors, which is shown whole
    rooms = {name for name in pl.__all__ if inspect.ismodule(getattr(pl, name))}
    lacking = [name for name in pl.__all__ if not re.search(rf"pliant\.[\w.]+\.{name}\b", pages)]
    assert set(lacking) <= whole | rooms | {"__version__"}


def test_functions_and_constructors_say_what_each_parameter_is(hooks):
    gaps = {}
    for label, thing in public(hooks):
        if not callable(thing) or (inspect.isclass(thing) and issubclass(thing, BaseException)):
            continue
        words = inspect.getdoc(thing) or ""
        names = [name for name in inspect.signature(thing).parameters if name not in {"self", "args", "kwargs"}]
        lacking = [name for name in names if not re.search(rf"\b{name}\b", words)]
        if lacking or not words:
            gaps[label] = lacking
    assert gaps == {}


def test_every_public_method_and_property_has_words(hooks):
    silent = [
        f"{label}.{name}"
        for label, thing in public(hooks)
        if inspect.isclass(thing)
        for name, member in vars(thing).items()
        if not name.startswith("_") and isinstance(member, Method) and not inspect.getdoc(getattr(thing, name))
    ]
    assert silent == []
