"""What writing a file lost: returned, never hidden."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pliant.errors import LossRefused


@dataclass(frozen=True)
class LossReport:
    """What a written file could not hold.

    Parameters
    ----------
    path
        The file that was written.
    format
        The format's name.
    losses
        One sentence a loss, each with its size; empty where the file holds everything.
    notes
        What a reader of the file should know though nothing was lost: a convention, a direction, rounding.
    """

    path: Path
    format: str
    losses: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        body = [f"lost: {loss}" for loss in self.losses] + [f"note: {note}" for note in self.notes]
        return "\n".join([f"{self.path} ({self.format})", *body])


def refuse_losses(losses: tuple[str, ...], path: Path, *, strict: bool) -> None:
    """Stop before writing, where the caller is strict and something would be lost.

    Raises
    ------
    LossRefused
        With every loss.
    """
    if strict and losses:
        raise LossRefused(f"{path} would lose: {'; '.join(losses)} (choose another format, or write without strict)")
