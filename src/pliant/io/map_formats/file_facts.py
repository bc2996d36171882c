"""What a reader keeps of a transform file, for whoever asks what was in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class FileFacts:
    """What a file said beside its map.

    Parameters
    ----------
    format
        The format's name.
    facts
        Statements, by name, as ``pliant info`` shows them.
    """

    format: str
    facts: Mapping[str, str] = field(default_factory=dict)
