"""Metropolis–Hastings: shapes drawn from a density that is known up to a factor (Hastings 1970).

Chains live in the space of coefficients. A proposal tells the density of its transitions, log-determinants and all,
so that whatever it proposes, what is accepted has the density asked for.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter, NonFiniteResult
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape.kernels import positive

Floats = NDArray[np.float64]
LogDensity = Callable[[Floats], float]


def normal_density(standard: Floats) -> float:
    """The logarithm of the density of standard normal numbers."""
    return -0.5 * float(standard @ standard) - 0.5 * len(standard) * float(np.log(2 * np.pi))


class Proposal(ABC):
    """A random step from one state (k,) to another."""

    @abstractmethod
    def draw(self, state: Floats, random: np.random.Generator) -> Floats:
        """(k,) where to go from a state."""

    @abstractmethod
    def log_density(self, new: Floats, state: Floats) -> float:
        """The logarithm of the density of going from a state to a new one."""


@dataclass(frozen=True)
class RandomWalk(Proposal):
    """Normal steps of one standard deviation.

    Parameters
    ----------
    step
        The standard deviation.
    first
        Numbers of the state before this one stay as they are: 6 where a pose comes first.
    """

    step: float
    first: int = 0

    def __post_init__(self) -> None:
        positive("the step of a random walk", self.step)

    def draw(self, state: Floats, random: np.random.Generator) -> Floats:
        new = state.copy()
        new[self.first :] += self.step * random.standard_normal(len(state) - self.first)
        return new

    def log_density(self, new: Floats, state: Floats) -> float:
        if not np.array_equal(new[: self.first], state[: self.first]):
            return -np.inf
        steps = (new - state)[self.first :] / self.step
        return normal_density(steps) - len(steps) * float(np.log(self.step))


@dataclass(frozen=True, eq=False)
class NormalProposal(Proposal):
    """Steps to a normal distribution that depends on the state, as that of the closest points of a target.

    Parameters
    ----------
    distribution
        Gives for a state the mean (k,) and the lower triangular factor (k, k) of the covariance of the next.
    first
        Numbers of the state before this one stay as they are, and the distribution is of the others.
    """

    distribution: Callable[[Floats], tuple[Floats, Floats]]
    first: int = 0

    def draw(self, state: Floats, random: np.random.Generator) -> Floats:
        mean, factor = self.distribution(state)
        return np.concatenate([state[: self.first], mean + factor @ random.standard_normal(len(mean))])

    def log_density(self, new: Floats, state: Floats) -> float:
        from scipy.linalg import solve_triangular

        if not np.array_equal(new[: self.first], state[: self.first]):
            return -np.inf
        mean, factor = self.distribution(state)
        standard = solve_triangular(factor, new[self.first :] - mean, lower=True, check_finite=False)
        return normal_density(standard) - float(np.log(np.diagonal(factor)).sum())


@dataclass(frozen=True, eq=False)
class Mixture(Proposal):
    """One of several proposals, at random; its density is that of all together.

    Proposals of one part of the state only, as of the pose, may stand beside proposals of the rest.

    Parameters
    ----------
    proposals, shares
        The proposals, and how often each is taken: positive numbers.
    """

    proposals: Sequence[Proposal]
    shares: Sequence[float]

    def __post_init__(self) -> None:
        if not self.proposals or len(self.proposals) != len(self.shares):
            raise InvalidParameter(f"{len(self.proposals)} proposals have {len(self.shares)} shares: each needs one")
        for each in self.shares:
            positive("a share of a mixture", each)

    def draw(self, state: Floats, random: np.random.Generator) -> Floats:
        share = np.asarray(self.shares, np.float64)
        return self.proposals[int(random.choice(len(share), p=share / share.sum()))].draw(state, random)

    def log_density(self, new: Floats, state: Floats) -> float:
        share = np.log(np.asarray(self.shares, np.float64) / np.sum(self.shares))
        return float(np.logaddexp.reduce(share + [each.log_density(new, state) for each in self.proposals]))


@dataclass(frozen=True, eq=False)
class Chains:
    """What chains went through.

    Parameters
    ----------
    samples
        (chains, draws, k) coefficients.
    log_densities
        (chains, draws) of each.
    accepted
        (chains, draws) whether the state is a new one.
    """

    samples: Floats
    log_densities: Floats
    accepted: NDArray[np.bool_]

    @property
    def best(self) -> Floats:
        """(k,) the state of the highest density."""
        return np.asarray(self.samples.reshape(-1, self.samples.shape[2])[int(np.argmax(self.log_densities))])

    @property
    def acceptance(self) -> Floats:
        """(chains,) the part of the proposals that was accepted."""
        return np.asarray(self.accepted.mean(axis=1))

    def as_arviz(self) -> dict[str, dict[str, NDArray[np.generic]]]:
        """Groups of arrays (chain, draw, ...) as ``arviz.from_dict`` takes them."""
        stats = {"lp": self.log_densities, "accepted": self.accepted}
        return {"posterior": {"coefficients": self.samples}, "sample_stats": stats}


def metropolis_hastings(
    log_density: LogDensity, proposal: Proposal, starts: ArrayLike, draws: int, *, seed: int | None = None
) -> Chains:
    """Chains whose states have a density.

    Parameters
    ----------
    log_density
        Its logarithm, up to a constant; −inf where nothing is. Evaluated once a proposal.
    proposal
        The steps.
    starts
        (chains, k) where the chains begin, or (k,) for one.
    draws
        How many states a chain has.
    seed
        Makes all repeatable; each chain has its own stream.

    Raises
    ------
    InvalidParameter
        No draws, or a start where the density is zero.
    NonFiniteResult
        A density that is not a number.
    """
    begin = np.atleast_2d(np.asarray(starts, np.float64))
    if draws < 1 or begin.ndim != 2 or not np.isfinite(begin).all():
        raise InvalidParameter(f"chains need draws, not {draws}, and finite starts (chains, k), not {begin.shape}")
    streams = np.random.default_rng(seed).spawn(len(begin))
    shape = len(begin), draws
    chains = Chains(np.empty((*shape, begin.shape[1])), np.empty(shape), np.empty(shape, bool))
    with one_blas_thread():
        for chain, random in enumerate(streams):
            _run(log_density, proposal, begin[chain], random, chains, chain)
    return chains


def _run(
    log_density: LogDensity, proposal: Proposal, state: Floats, random: np.random.Generator, chains: Chains, chain: int
) -> None:
    value = _checked(log_density(state))
    if value == -np.inf:
        raise InvalidParameter(f"chain {chain} begins where the density is zero: begin elsewhere")
    for draw in range(chains.samples.shape[1]):
        new = proposal.draw(state, random)
        there = _checked(log_density(new))
        ratio = -np.inf
        if there > -np.inf:
            ratio = there - value + proposal.log_density(state, new) - proposal.log_density(new, state)
        taken = bool(np.log(random.random()) < ratio)
        if taken:
            state, value = new, there
        chains.samples[chain, draw], chains.log_densities[chain, draw] = state, value
        chains.accepted[chain, draw] = taken


def _checked(value: float) -> float:
    if np.isnan(value) or value == np.inf:
        raise NonFiniteResult(f"a log density is {value}: it must be a number, or -inf where nothing is")
    return float(value)
