"""Random variants of shapes, as for training: coefficients of a shape model, drawn from a seed for each copy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pliant.batch.outcome import Outcome
from pliant.batch.running import run_batch
from pliant.deformer import Controls, Deformer
from pliant.errors import InvalidParameter
from pliant.shape.model import ShapeModel
from pliant.shape.model_deformer import ModelDeformer
from pliant.shape.random_field import RandomField


def sample(
    source: ShapeModel | RandomField | ModelDeformer,
    paths: Iterable[Path | str],
    output: Path | str,
    *,
    count: int = 1,
    seed: int = 0,
    amount: float = 1.0,
    **options: Any,
) -> Iterator[Outcome]:
    """Write random variants of meshes.

    Each coefficient is standard normal, times ``amount``. What copy k of path i looks like depends on the seed, i and
    k alone: not on the workers, nor on how many copies there are.

    Parameters
    ----------
    source
        A shape model; or a deformer of one: :class:`~pliant.shape.random_field.RandomField`, as a Gaussian process
        samples it, moves any mesh.
    paths
        The meshes.
    output
        A pattern, as for :func:`run_batch`; with several copies it needs ``{copy}`` or ``{index}``.
    count
        How many variants of each.
    seed
        Not negative.
    amount
        Standard deviations: 0 = the mean itself, 1 = as the model says.
    options
        As for :func:`run_batch`.

    Raises
    ------
    InvalidParameter
        Something whose controls are no coefficients, a count below one, a negative seed; or as for :func:`run_batch`.
    """
    deformer = source.deformer() if isinstance(source, ShapeModel) else source
    if not isinstance(deformer, RandomField | ModelDeformer):
        raise InvalidParameter(
            f"variants are drawn from a shape model or a random field, not from a {type(source).__name__} (a Gaussian "
            "process gives one by sample)"
        )
    if count < 1 or seed < 0 or not np.isfinite(amount):
        raise InvalidParameter(f"count is {count}, seed {seed}, amount {amount}: at least 1, at least 0, and finite")
    inputs = [Path(path) for path in paths]
    pairs = [(i, copy) for i in range(len(inputs)) for copy in range(count)]
    return run_batch(
        deformer,
        [inputs[i] for i, _ in pairs],
        output,
        controls=[coefficients(deformer, seed, i, copy, amount) for i, copy in pairs],
        copies=[copy for _, copy in pairs],
        **options,
    )


def coefficients(deformer: Deformer, seed: int, index: int, copy: int, amount: float = 1.0) -> Controls:
    """(k,) the coefficients of one copy of one path."""
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index, copy)))
    return np.asarray(amount * random.standard_normal(deformer.rest.shape))
