"""Undo, redo, and going to any entry of the history; stopping long work."""

from __future__ import annotations

from pliant.studio.request import Request, command
from pliant.studio.session import Session


@command("history.undo")
def undo(session: Session, request: Request) -> None:
    """One entry back."""
    if session.history is not None:
        session.go(session.history.position - 1)


@command("history.redo")
def redo(session: Session, request: Request) -> None:
    """One entry forward."""
    if session.history is not None:
        session.go(session.history.position + 1)


@command("history.goto")
def goto(session: Session, request: Request) -> None:
    """To an entry."""
    session.go(request.integer("position"))


@command("job.cancel")
def cancel(session: Session, request: Request) -> None:
    """Stop long work."""
    session.jobs.stop(request.text("job"))
