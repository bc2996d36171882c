"""A thousand cases a deformer: `python -m reliability.mathematics --cases 1000`.

At rest nothing moves; pushed and pulled derivatives are each other's transposes; they, and Jacobians, agree with finite
differences. Where the map has a kink within a difference's reach, differences with two steps disagree: such numbers are
counted apart. The peers are asked in :mod:`reliability.peers`.
"""

from __future__ import annotations

import argparse
import collections
import math
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pliant as pl
from pliant.deformer import Binding, SpaceDeformer
from pliant.errors import NotDifferentiable, PliantWarning
from pliant.iterative import IterativeBinding
from reliability.cases import CASES
from reliability.ledger import Ledger, publish

Floats = NDArray[np.float64]
LIMITS = {"rest": 1e-12, "transpose": 1e-10, "derivative": 1e-6, "jacobian": 1e-6}
ELSEWHERE = {"random-field"}  # at rest it is the field's mean, which is no identity
_SLICE = 25
_STEP = 2e-4
_SMOOTH, _SIDES = 1e-7, 1e-5  # how far estimates of a slope may differ where the map is smooth


def laws(name: str, seed: int) -> dict[str, float]:
    """How far a case misses each law, relative to what the law is about; NaN where it does not apply."""
    random = np.random.default_rng([seed, zlib.crc32(name.encode())])
    deformer, target = CASES[name](random)
    bound = deformer.bind(target)
    scale = float(np.linalg.norm(np.ptp(bound.points, axis=0)))
    found = dict.fromkeys((*LIMITS, "kinks"), math.nan)
    if name not in ELSEWHERE:
        found["rest"] = float(np.abs(bound.deform(bound.rest) - bound.points).max()) / scale
    found |= _derivatives(bound, random, scale)
    if isinstance(deformer, SpaceDeformer):
        found |= _jacobian(deformer, bound.points[:12], scale)
    return found


def _derivatives(bound: Binding, random: np.random.Generator, scale: float) -> dict[str, float]:
    controls = bound.controls
    if not controls.size:
        return {}
    direction, pull = random.normal(size=controls.shape), random.normal(size=bound.points.shape)
    try:
        pushed, pulled = bound.jvp(controls, direction), bound.vjp(controls, pull)
    except NotDifferentiable:
        return {}
    size = float(np.linalg.norm(pushed) * np.linalg.norm(pull)) or 1.0
    found = {"transpose": abs(float((pushed * pull).sum() - (direction * pulled).sum())) / size}
    if isinstance(bound, IterativeBinding):
        return found  # it ends within its tolerance: differences of that are no derivative
    step = _STEP * (scale if controls.ndim > 1 else max(1.0, float(np.abs(controls).max())))
    slope, smooth = _slope(lambda t: bound.deform(controls + t * direction), step)
    size = max(float(np.abs(pushed).max()), 1e-3)
    return found | {"derivative": _miss(slope - pushed, smooth, size), "kinks": float((~smooth).sum())}


def _jacobian(deformer: SpaceDeformer, points: Floats, scale: float) -> dict[str, float]:
    try:
        jacobian = deformer.jacobian(points)
    except NotDifferentiable:
        return {}
    worst, size = 0.0, max(1.0, float(np.abs(jacobian).max()))
    for axis in range(3):
        along = np.eye(3)[axis]
        slope, smooth = _slope(lambda t, along=along: deformer(points + t * along), _STEP * scale)  # type: ignore[misc]
        worst = max(worst, _miss(slope - jacobian[:, :, axis], smooth, size))
    return {"jacobian": worst}


def _slope(curve: Callable[[float], Floats], step: float) -> tuple[Floats, NDArray[np.bool_]]:
    """(n, 3) slopes at zero, and (n,) where they are the same for half the step, and from either side."""
    at = {k: curve(k * step / 2) for k in (-4, -2, -1, 0, 1, 2, 4)}
    whole = (8 * (at[2] - at[-2]) - at[4] + at[-4]) / (12 * step)
    half = (8 * (at[1] - at[-1]) - at[2] + at[-2]) / (6 * step)
    sides = [sign * (4 * at[sign] - at[2 * sign] - 3 * at[0]) / step for sign in (1, -1)]
    size = max(float(np.abs(whole).max()), 1e-300)
    smooth = (np.abs(whole - half) <= _SMOOTH * size) & (np.abs(sides[0] - sides[1]) <= _SIDES * size)
    return half, smooth.all(axis=1)


def _miss(difference: Floats, smooth: NDArray[np.bool_], size: float) -> float:
    return float(np.abs(difference[smooth]).max(initial=0.0)) / size


def run(cases: int, ledger: Ledger, only: str = "") -> None:
    """Go through all cases that the ledger does not have yet."""
    done = collections.Counter(dict.fromkeys(CASES, 0))
    for entry in ledger:
        done[entry["name"]] = max(done[entry["name"]], entry["start"] + entry["count"])
    while left := {name: count for name, count in done.items() if count < cases and only in name}:
        name = min(left, key=lambda each: left[each])
        ledger.add(name=name, start=done[name], count=_SLICE, **_slice(name, done[name]))
        done[name] += _SLICE


def _slice(name: str, start: int) -> dict[str, Any]:
    worst, wrong, kinks = dict.fromkeys(LIMITS, 0.0), [], 0
    applied = collections.Counter[str]()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        for seed in range(start, start + _SLICE):
            try:
                found = laws(name, seed)
            except pl.PliantError as error:  # a case that the deformer itself refuses is none
                applied[f"refused: {type(error).__name__}"] += 1
                continue
            for law, limit in LIMITS.items():
                if not math.isnan(found[law]):
                    applied[law] += 1
                    worst[law] = max(worst[law], found[law])
                    if not found[law] <= limit:
                        wrong.append({"law": law, "seed": seed, "off": found[law]})
            kinks += 0 if math.isnan(found["kinks"]) else int(found["kinks"])
    return {"worst": worst, "applied": applied, "kinks": kinks, "wrong": wrong}


def summary(ledger: Ledger) -> dict[str, Any]:
    """The figures of all that a ledger holds."""
    rows, wrong = [], []
    for name in CASES:
        mine = [entry for entry in ledger if entry["name"] == name]
        applied = sum((collections.Counter(entry["applied"]) for entry in mine), collections.Counter[str]())
        row: dict[str, Any] = {"deformer": name, "cases": sum(entry["count"] for entry in mine)}
        for law in LIMITS:
            row[law] = max(entry["worst"][law] for entry in mine) if applied[law] else None
        row["kinks"] = sum(entry["kinks"] for entry in mine)
        row["refused"] = sum(times for what, times in applied.items() if what.startswith("refused"))
        rows.append(row)
        wrong += [{"deformer": name, **each} for entry in mine for each in entry["wrong"]]
    return {"deformers": len(rows), "cases": sum(row["cases"] for row in rows), "laws broken": len(wrong),
            "rows": rows, "broken": wrong[:40]}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--only", default="", help="deformers whose names hold this")
    parser.add_argument("--ledger", type=Path, default=Path("mathematics-ledger.jsonl"))
    options = parser.parse_args()
    ledger = Ledger(options.ledger)
    run(options.cases, ledger, options.only)
    publish("mathematics", summary(ledger))


if __name__ == "__main__":
    main()
