"""What people call a kind of deformer."""

from __future__ import annotations

_WORDS = {"ffd": "FFD", "bspline": "B-spline", "bezier": "Bézier", "arap": "ARAP"}


def titled(kind: str) -> str:
    """``bspline-ffd`` as "B-spline FFD"."""
    words = [_WORDS.get(word, word) for word in kind.split("-")]
    return " ".join([words[0][:1].upper() + words[0][1:], *words[1:]])
