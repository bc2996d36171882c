"""Jobs and outcomes: all that travels between a run and its workers. Meshes do not."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pliant.deformer import Controls


@dataclass(frozen=True, eq=False)
class Job:
    """One file to be made from another.

    Parameters
    ----------
    index
        Its place in the run, from 0.
    input, output
        What is read, and what is written.
    controls
        The deformation's controls for this job; None = its own.
    """

    index: int
    input: Path
    output: Path
    controls: Controls | None = None


@dataclass(frozen=True)
class Outcome:
    """What became of a job.

    Parameters
    ----------
    index, input, output
        The job's.
    status
        ``"ok"``: the output is written. ``"failed"``: it is not, and what was there before still is.
    error, kind
        Why it failed, in words, and the name of the error's class.
    losses
        What the output's format could not hold.
    points
        How many points were deformed.
    seconds
        How long the worker took.
    resumed
        Whether an earlier run did it.
    """

    index: int
    input: Path
    output: Path
    status: Literal["ok", "failed"]
    error: str = ""
    kind: str = ""
    losses: tuple[str, ...] = ()
    points: int = 0
    seconds: float = 0.0
    resumed: bool = False


def failed(job: Job, error: BaseException, seconds: float = 0.0) -> Outcome:
    """The outcome of a job that an error ended."""
    cause = f"{type(error).__name__}: {error}" if isinstance(error, OSError) or not str(error) else str(error)
    return Outcome(job.index, job.input, job.output, "failed", cause, type(error).__name__, seconds=seconds)
