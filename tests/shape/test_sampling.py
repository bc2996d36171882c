"""Chains have the density that they are asked for, whatever proposes."""

import numpy as np
import pytest

from pliant.errors import InvalidParameter, NonFiniteResult
from pliant.shape.closest_point_chain import ClosestPointDensity
from pliant.shape.correspondence import Target
from pliant.shape.densities import CachedDensity, ProductDensity
from pliant.shape.diagnostics import effective_sample_size, r_hat
from pliant.shape.kernels import GaussianKernel
from pliant.shape.model import ShapeModel
from pliant.shape.sampling import Mixture, NormalProposal, RandomWalk, metropolis_hastings

COVARIANCE = np.array([[1.0, 0.5], [0.5, 0.7]])
MEAN = np.array([0.3, -0.4])


def normal(x):
    return -0.5 * float((x - MEAN) @ np.linalg.solve(COVARIANCE, x - MEAN))


def leaning(state):
    """Wider the farther from the middle: forgetting the log-determinant would show."""
    return 0.5 * state, (0.5 + 0.4 * np.tanh(state @ state)) * np.array([[1.2, 0], [0.3, 1.0]])


PROPOSALS = {
    "random walk": RandomWalk(1.2),
    "state-dependent": NormalProposal(leaning),
    "mixture": Mixture([RandomWalk(0.3), NormalProposal(leaning), RandomWalk(2.0)], [1, 2, 1]),
}


@pytest.mark.parametrize("name", PROPOSALS)
def test_chains_have_the_moments_of_the_density(name):
    chains = metropolis_hastings(normal, PROPOSALS[name], np.zeros((2, 2)), 8000, seed=1)
    flat = chains.samples[:, 200:].reshape(-1, 2)
    size = effective_sample_size(chains.samples[:, 200:])
    assert size.min() > 400
    error = 4.5 * np.sqrt(np.diag(COVARIANCE) / size)
    assert (np.abs(flat.mean(axis=0) - MEAN) < error).all()
    np.testing.assert_allclose(np.cov(flat.T), COVARIANCE, atol=4.5 * np.sqrt(2 / size.min()))
    assert r_hat(chains.samples[:, 200:]).max() < 1.02
    assert chains.samples.shape == (2, 8000, 2)
    np.testing.assert_array_equal(chains.accepted[:, 1:], (np.diff(chains.samples, axis=1) != 0).any(axis=2))


@pytest.mark.parametrize("name", PROPOSALS)
def test_transition_densities_integrate_to_one(name):
    axis = np.linspace(-9, 9, 181)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)[::1]
    state = np.array([0.4, 0.2])
    some = np.exp([PROPOSALS[name].log_density(each, state) for each in grid])
    assert some.sum() * 0.1**2 == pytest.approx(1, abs=2e-3)


def test_diagnostics_of_known_chains():
    random = np.random.default_rng(0)
    white = random.standard_normal((4, 5000, 1))
    assert effective_sample_size(white)[0] == pytest.approx(20_000, rel=0.1)
    slow = np.empty((4, 20_000, 1))
    slow[:, 0] = 0
    for i in range(1, 20_000):
        slow[:, i] = 0.9 * slow[:, i - 1] + random.standard_normal((4, 1))
    assert effective_sample_size(slow)[0] == pytest.approx(80_000 * 0.1 / 1.9, rel=0.2)
    assert r_hat(white)[0] == pytest.approx(1, abs=0.01)
    assert r_hat(white + np.arange(4)[:, None, None])[0] > 1.4
    with pytest.raises(InvalidParameter, match="four draws"):
        r_hat(white[:, :3])


def test_chains_repeat_and_hand_over_what_arviz_takes():
    one, two = (metropolis_hastings(normal, RandomWalk(1.0), MEAN, 50, seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.samples, two.samples)
    groups = one.as_arviz()
    assert groups["posterior"]["coefficients"].shape == (1, 50, 2)
    assert groups["sample_stats"]["lp"].shape == (1, 50)
    assert normal(one.best) == one.log_densities.max()


def test_closest_points_lead_to_the_target(soft, fine):
    given = 0.8 * np.random.default_rng(1).normal(size=soft.count)
    target = soft.deformer(given)(fine)
    density = ClosestPointDensity(soft, target, noise=0.05)
    steps = Mixture([density.proposal(0.5), RandomWalk(0.02)], [0.8, 0.2])
    chains = metropolis_hastings(density, steps, np.zeros(soft.count), 600, seed=0)
    assert density(chains.best) > density(given) - 3 * soft.count
    assert density(chains.best) > density(np.zeros(soft.count)) + 100
    assert 0.02 < chains.acceptance[0] < 0.98
    fitted = soft.instance(chains.samples[0, 300:].mean(axis=0))
    surface = Target(target, np.pi)
    before, after = (np.linalg.norm(surface.closest(x) - x, axis=1).mean() for x in (soft.mean, fitted))
    assert after < 0.7 * before  # within the noise, which is half of what the mean misses


def test_chains_from_far_apart_converge_on_the_target(coarse, fine):
    model = ShapeModel.from_kernel(coarse, GaussianKernel(3.0, 0.12), rank=12)
    given = 0.8 * np.random.default_rng(1).normal(size=model.count)
    density = ClosestPointDensity(model, model.deformer(given)(fine), noise=0.1)
    steps = Mixture([density.proposal(0.5), density.proposal(0.1), RandomWalk(0.02)], [0.6, 0.3, 0.1])
    starts = np.random.default_rng(2).normal(size=(3, model.count))
    chains = metropolis_hastings(density, steps, starts, 700, seed=0)
    late = chains.samples[:, 200:]
    assert r_hat(late).max() < 1.1
    assert effective_sample_size(late).min() > 60
    assert (chains.acceptance > 0.5).all()
    assert chains.log_densities[:, 200:].min() > density(given) - 2 * model.count


def test_closest_point_proposals_keep_the_density(soft, fine):
    model = soft.truncated(1)
    density = ClosestPointDensity(model, soft.deformer(np.ones(soft.count))(fine), noise=0.4, points=40)
    axis = np.linspace(-3.5, 3.5, 23)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    weight = np.exp([density(each) for each in grid])
    expected = weight @ grid / weight.sum()
    spread = np.sqrt(weight @ (grid - expected) ** 2 / weight.sum())
    chains = metropolis_hastings(density, density.proposal(0.7), np.zeros((2, 3)), 2500, seed=0)
    error = spread / np.sqrt(effective_sample_size(chains.samples))
    assert (np.abs(chains.samples.mean(axis=(0, 1)) - expected) < 4.5 * error).all()
    np.testing.assert_allclose(chains.samples.std(axis=(0, 1)), spread, rtol=0.1)


def test_products_add_logarithms_and_stop_where_nothing_is():
    asked = []

    def empty(x):
        asked.append("empty")
        return -np.inf

    def never(x):
        asked.append("never")
        return 0.0

    assert ProductDensity(normal, normal)(MEAN + 1) == 2 * normal(MEAN + 1)
    assert ProductDensity(empty, never)(MEAN) == -np.inf
    assert asked == ["empty"]
    with pytest.raises(InvalidParameter, match="at least one"):
        ProductDensity()


def test_cached_densities_are_asked_once_a_state():
    asked = []

    def counted(x):
        asked.append(x)
        return normal(x)

    cached = CachedDensity(counted)
    states = np.random.default_rng(0).normal(size=(3, 2))
    values = [cached(each) for each in (*states, *states)]
    assert values == [normal(each) for each in (*states, *states)]
    assert len(asked) == 3


def test_what_cannot_be_sampled_is_refused():
    with pytest.raises(InvalidParameter, match="draws, not 0"):
        metropolis_hastings(normal, RandomWalk(1), MEAN, 0)
    with pytest.raises(InvalidParameter, match="begins where the density is zero"):
        metropolis_hastings(lambda x: -np.inf, RandomWalk(1), MEAN, 5)
    with pytest.raises(NonFiniteResult, match="nan"):
        metropolis_hastings(lambda x: np.nan, RandomWalk(1), MEAN, 5)
    with pytest.raises(InvalidParameter, match="step of a random walk is 0"):
        RandomWalk(0)
    with pytest.raises(InvalidParameter, match="1 proposals have 2 shares"):
        Mixture([RandomWalk(1)], [1, 2])
