"""M on a velocity grid, and the half-range sums over it."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from states import BETA, random_states, scene_with

from kinsim import Kinetic, Macroscopic, Uniform, step
from kinsim.solver.step import Step

EPS = float(np.finfo(float).eps)
TINY_STEP = 1e-9


def at(h: np.ndarray, u: np.ndarray, equilibrium: str, n: int = 64, bound: float = 2.0) -> Step:
    method = Kinetic(scheme=1, velocity=Uniform(n, bound), equilibrium=equilibrium)
    return step(scene_with(h, u), method, h, h * u, TINY_STEP)


def M(xi: np.ndarray, h: np.ndarray, u: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum(2 * BETA * h[:, None] - (xi - u[:, None]) ** 2, 0)) / (math.pi * BETA)


def test_nodes_are_symmetric_with_an_edge_at_zero() -> None:
    """No velocity cell straddles the upwind switch."""
    xi = at(np.ones(2), np.zeros(2), "sampled", n=10, bound=2.0).xi
    np.testing.assert_array_equal(xi, -xi[::-1])
    np.testing.assert_allclose(xi, -2 + 0.4 * (np.arange(10) + 0.5), atol=1e-15)


def test_sampled_is_M_at_the_nodes(rng: np.random.Generator) -> None:
    h, u = random_states(rng, 200)
    now = at(h, u, "sampled")
    np.testing.assert_allclose(now.M, M(now.xi, h, now.u), atol=2e-8 * np.sqrt(h.max()))  # sqrt(eps) at the rim
    inside = M(now.xi, h, now.u) > 1e-2
    np.testing.assert_allclose(now.M[inside], M(now.xi, h, now.u)[inside], rtol=1e-11)


@pytest.mark.parametrize(("h", "u"), [(1.0, 0.3), (1.0, 0.0), (0.2, -0.55), (1e-3, 0.01), (0.7, 1.1), (1e-5, -0.09)])
def test_cell_average_is_the_average_over_each_cell(h: float, u: float) -> None:
    """Against tanh-sinh quadrature; the tolerance is the rounding of h/(pi dxi), of which averages are differences."""
    now = at(np.full(2, h), np.full(2, u), "cell-average", n=16)
    dxi = now.xi[1] - now.xi[0]
    with mpmath.workdps(20):
        velocity = mpmath.mpf(now.u[0])
        c = mpmath.sqrt(2 * mpmath.mpf(BETA) * h)
        for xi, found in zip(now.xi, now.M[0], strict=True):
            low, high = max(xi - dxi / 2, velocity - c), min(xi + dxi / 2, velocity + c)
            integral = mpmath.mpf(0)
            if low < high:
                integral = mpmath.quad(
                    lambda w: mpmath.sqrt(max(c**2 - (w - velocity) ** 2, 0)), [low, (low + high) / 2, high]
                )
            exact = integral / (mpmath.pi * BETA * dxi)
            assert abs(found - exact) <= 4 * EPS * h / dxi


def test_cell_average_keeps_mass_to_rounding(rng: np.random.Generator) -> None:
    """Also films thinner than a velocity cell."""
    h, u = random_states(rng, 500, decades=12)
    now = at(h, u, "cell-average")
    dxi = now.xi[1] - now.xi[0]
    np.testing.assert_allclose(now.M.sum(axis=1) * dxi, h, rtol=64 * EPS)


def test_sampling_does_not_keep_mass() -> None:
    """Up to 4.5 percent off with 8 cells across the support, 0.2 percent with 64, of either sign."""
    for across, worst in ((8, 0.045), (64, 0.002)):
        shift = np.linspace(0, 1, 101)
        h = np.full(101, 0.8)
        dxi = 2 * math.sqrt(2 * BETA * 0.8) / across
        now = at(h, shift * dxi, "sampled", n=4 * across, bound=2 * across * dxi)
        off = now.M.sum(axis=1) * dxi / h - 1
        assert off.min() < 0 < off.max()
        assert 0.7 * worst < np.abs(off).max() < 1.1 * worst


@pytest.mark.parametrize("equilibrium", ["sampled", "cell-average"])
def test_equilibrium_is_never_negative_and_dry_cells_are_empty(equilibrium: str, rng: np.random.Generator) -> None:
    h, u = random_states(rng, 500, decades=15)
    now = at(h, u, equilibrium)
    assert (now.M >= 0).all()
    assert (now.M[h == 0] == 0).all()


@pytest.mark.parametrize("equilibrium", ["sampled", "cell-average"])
def test_equilibrium_is_empty_outside_its_support(equilibrium: str, rng: np.random.Generator) -> None:
    h, u = random_states(rng, 200)
    now = at(h, u, equilibrium)
    dxi = now.xi[1] - now.xi[0]
    outside = np.abs(now.xi - now.u[:, None]) > np.sqrt(2 * BETA * h)[:, None] + dxi / 2
    assert (now.M[outside] == 0).all()


@pytest.mark.parametrize("equilibrium", ["sampled", "cell-average"])
def test_mirrored_state_has_mirrored_density_bit_for_bit(equilibrium: str, rng: np.random.Generator) -> None:
    h, u = random_states(rng, 200)
    one, other = at(h, u, equilibrium), at(h, -u, equilibrium)
    np.testing.assert_array_equal(one.M, other.M[:, ::-1])


@pytest.mark.parametrize(
    ("equilibrium", "component", "order", "band"),
    [("cell-average", 0, 2.0, 0.05), ("cell-average", 1, 2.5, 0.1), ("sampled", 0, 1.5, 0.1), ("sampled", 1, 1.5, 0.1)],
)
def test_half_range_fluxes_converge(
    equilibrium: str, component: int, order: float, band: float, rng: np.random.Generator
) -> None:
    """To the closed form: n^-2 with cell averages, n^-1.5 sampled, root mean square over 2000 states.

    Sampled: the square root at the rim of the support leaves an error dxi^1.5 with a phase of its own in each state.
    Averages: sum xi_j f_j is off by dxi^2/12 M(0), dxi^2 in the first moment; in the second the weight
    xi_j^2 - dxi^2/12 takes that away and dxi^2.5 from the rim is left. The band is what 2000 random phases leave of a
    slope over five doublings, fourfold.
    """
    h = 10.0 ** rng.uniform(-1, 0, 2000)
    u = rng.uniform(-1.2, 1.2, 2000) * np.sqrt(2 * BETA * h)
    bound = 1.05 * np.max(np.abs(u) + np.sqrt(2 * BETA * h))
    exact = step(scene_with(h, u), Macroscopic(1), h, h * u, TINY_STEP).flux[component]
    nodes = 2 ** np.arange(5, 11)
    errors = [at(h, u, equilibrium, n, bound).flux[component] - exact for n in nodes]
    slope = np.polyfit(np.log(nodes), np.log(np.sqrt(np.mean(np.square(errors), axis=1))), 1)[0]
    assert slope == pytest.approx(-order, abs=band)


def test_leading_error_of_the_mass_flux_is_known() -> None:
    """dxi^2/12 M(xi = 0) of the left state less that of the right one: sum xi_j f_j dxi is off by it, by parts."""
    h, u = np.array([1.0, 0.5]), np.array([0.1, -0.05])
    exact = step(scene_with(h, u), Macroscopic(1), h, h * u, TINY_STEP).flux[0, 1]
    for n in (256, 512):
        now = at(h, u, "cell-average", n)
        dxi = now.xi[1] - now.xi[0]
        left, right = M(np.zeros(1), h, u)[:, 0]
        leading = dxi**2 / 12 * (left - right)
        assert now.flux[0, 1] - exact == pytest.approx(leading, rel=0.5 * math.sqrt(dxi))


def test_second_moment_of_averages_needs_its_weight(rng: np.random.Generator) -> None:
    """Without - dxi^2/12 the flux of momentum is about ten times further off."""
    h = rng.uniform(0.2, 1, 400)
    u = rng.uniform(-0.5, 0.5, 400)
    exact = step(scene_with(h, u), Macroscopic(1), h, h * u, TINY_STEP).flux[1, 1:-1]
    now = at(h, u, "cell-average", 64)
    dxi = now.xi[1] - now.xi[0]
    positive = now.xi > 0
    plain = dxi * (now.M[:-1] @ (positive * now.xi**2) + now.M[1:] @ (~positive * now.xi**2))
    assert np.std(plain - exact) + abs(np.mean(plain - exact)) > 8 * np.sqrt(np.mean((now.flux[1, 1:-1] - exact) ** 2))
    np.testing.assert_allclose(
        plain - now.flux[1, 1:-1],
        dxi**3 / 12 * (now.M[:-1] @ positive + now.M[1:] @ ~positive),
        rtol=1e-10,
    )
