"""run_batch: one deformation for many files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from pliant.batch.crews import crew_of
from pliant.batch.dispatch import outcomes
from pliant.batch.ledger import NAME, Ledger
from pliant.batch.naming import fixed_folder, output_paths
from pliant.batch.outcome import Job, Outcome
from pliant.batch.parcel import sent
from pliant.batch.plans import Plan, checked_job_controls, plan_of
from pliant.deformer import Deformer
from pliant.errors import InvalidParameter
from pliant.scene.recipe import Recipe


def run_batch(
    deformation: Deformer | Recipe,
    paths: Iterable[Path | str],
    output: Path | str,
    *,
    controls: Iterable[ArrayLike | None] | None = None,
    executor: Any = None,
    workers: int | None = None,
    resume: bool = False,
    strict: bool = False,
    ledger: Path | str | None = None,
    intensity: float = 1.0,
    up: str = "z",
    copies: Sequence[int] | None = None,
) -> Iterator[Outcome]:
    """Deform many files, on all processors or a cluster.

    Workers read and write the files themselves: what travels is paths and controls. What a worker has read and bound
    it remembers by content, so that one mesh with a thousand controls is read and bound once a worker. A worker that
    is lost costs nothing but time; a mesh that is bad is a failed outcome and no more.

    Parameters
    ----------
    deformation
        A deformer, a stack, or a recipe, which is laid around each mesh.
    paths
        The files to be read. One may come several times.
    output
        Where to: a path with ``{stem}``, ``{suffix}``, ``{parent}``, ``{index}`` or ``{copy}`` of each input.
    controls
        One for each path, shaped as the deformation's, None = its own.
    executor
        Any of ``concurrent.futures``, or a client of ``dask.distributed``; None = processes of our own. Scripts that
        use those begin under ``if __name__ == "__main__":``.
    workers
        Without an executor: how many processes; 0 = this one. None = one a processor, and this one for a single file.
    resume
        Leave out what an earlier run has done: from the same inputs, the same way, and still there. Its outcomes are
        given too, as ``resumed``; what failed is tried again.
    strict
        What would lose something fails instead.
    ledger
        Where outcomes are written down, for ``resume``; None = beside the outputs.
    intensity, up
        Of a recipe, as for :meth:`pliant.scene.recipe.Recipe.stack`.
    copies
        What ``{copy}`` is for each path.

    Returns
    -------
    Iterator of Outcome
        Each job's once, as they come. Work begins with the first that is asked for.

    Raises
    ------
    InvalidParameter
        Before anything is done: two outputs of one name, an output that is an input, an unknown word in the pattern,
        controls that are not one a path, or something that is no deformation.
    """
    plan = plan_of(deformation, intensity, up)
    inputs = [Path(path) for path in paths]
    jobs = _jobs(inputs, output_paths(output, inputs, copies), controls)
    folder = fixed_folder(output)
    return _run(plan, jobs, folder, Path(ledger or folder / NAME), (executor, workers), resume, strict)


def _run(
    plan: Plan, jobs: list[Job], folder: Path, place: Path, who: tuple[Any, int | None], resume: bool, strict: bool
) -> Iterator[Outcome]:
    with Ledger(place, plan.key, resume=resume) as ledger:
        left = []
        for job in jobs:
            known = ledger.known(job)
            if known is None:
                left.append(job)
            else:
                yield known
        if not left:
            return
        with crew_of(*who, len(left)) as crew, sent(plan, folder, elsewhere=crew.elsewhere) as parcel:
            for outcome in outcomes(crew, parcel, left, strict):
                ledger.add(jobs[outcome.index], outcome)
                yield outcome


def _jobs(inputs: list[Path], outputs: list[Path], controls: Iterable[ArrayLike | None] | None) -> list[Job]:
    given = [None] * len(inputs) if controls is None else list(controls)
    if len(given) != len(inputs):
        raise InvalidParameter(f"there are {len(given)} controls for {len(inputs)} paths: one a path is needed")
    return [
        Job(i, source.absolute(), target.absolute(), None if values is None else checked_job_controls(values))
        for i, (source, target, values) in enumerate(zip(inputs, outputs, given, strict=True))
    ]
