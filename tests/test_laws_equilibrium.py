"""Laws of the discrete equilibria, each over every variant: a new one is tested by being listed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import EPS, SCENES
from states import BETA, random_states, scene_with

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Fitted,
    Fixed,
    Kinetic,
    Profile,
    Scene,
    Uniform,
    simulate,
    step,
)
from kinsim.kinetic.equilibrium import EQUILIBRIA, EquilibriumName, Status, fill
from kinsim.kinetic.equilibrium.status import MASS_ONLY, TWO_MOMENTS, TWO_NODES
from kinsim.kinetic.velocity import Grid
from kinsim.method import NODES

EXACT = math.inf

PROMISED = {
    "cell-average": (EXACT, 2.5, 2.0),
    "sampled": (1.5, 1.5, 1.5),
    "matched": (EXACT, EXACT, EXACT),
    "entropic": (EXACT, EXACT, 1.5),
}
"""With which order in n the moments 0, 1, 2 of a discrete M approach (3)."""


def moments(h: np.ndarray, u: np.ndarray) -> np.ndarray:
    return np.array([h, h * u, h * u * u + 0.5 * BETA * h * h])


def defects(name: EquilibriumName, n: int, h: np.ndarray, u: np.ndarray, room: float = 1.01) -> np.ndarray:
    """The three defects of the discrete M over the flux scale h (|u| + c)^k, shape (3, cells)."""
    speed = np.abs(u) + np.sqrt(2 * BETA * h)
    now = step(scene_with(h, u), Kinetic(1, Uniform(n, room * speed.max()), name), h, h * u, 1e-9)
    dxi = now.xi[1] - now.xi[0]
    sums = np.array([dxi * (now.M * now.xi**k).sum(axis=1) for k in range(3)])
    return np.abs(sums - moments(h, u)) / (h * speed ** np.arange(3)[:, None])


@pytest.mark.parametrize("name", EQUILIBRIA)
def test_moments_of_the_discrete_M_are_as_promised(name: EquilibriumName, rng: np.random.Generator) -> None:
    """Exact to the rounding of n products and sums, or with the promised order in the mean over 400 states."""
    h = rng.uniform(0.2, 2.0, 400)
    u = rng.uniform(-1.2, 1.2, 400) * np.sqrt(2 * BETA * h)
    coarse, fine = (defects(name, n, h, u).mean(axis=1) for n in (64, 512))
    for k, promise in enumerate(PROMISED[name]):
        if promise is EXACT:
            assert defects(name, 64, h, u)[k].max() <= 64 * EPS
        else:
            assert abs(math.log(coarse[k] / fine[k], 8) - promise) <= 0.25, (k, coarse, fine)


@pytest.mark.parametrize("name", EQUILIBRIA)
def test_mass_and_momentum_of_thin_films(name: EquilibriumName, rng: np.random.Generator) -> None:
    """Supports thinner than a velocity cell: mass and momentum that are promised exact stay exact."""
    h = 10.0 ** rng.uniform(-14, -3, 200)
    u = rng.uniform(-0.9, 0.9, 200)
    found = defects(name, 32, h, u, room=1.2)
    for k, promise in enumerate(PROMISED[name][:2]):
        if promise is EXACT:
            assert found[k].max() <= 64 * EPS


def test_status_says_where_matching_fell_back(rng: np.random.Generator) -> None:
    """A film whose variance is below the least that two nodes allow cannot be matched; all others are, to rounding."""
    h = 10.0 ** rng.uniform(-8, 0, 500)
    u = rng.uniform(-0.9, 0.9, 500)
    method = Kinetic(1, Uniform(48, 2.0), "matched")
    now = step(scene_with(h, u), method, h, h * u, 1e-9)
    dxi, beta = now.xi[1] - now.xi[0], BETA
    below = np.floor(now.u / dxi - 0.5) + 0.5
    least = (now.u - below * dxi) * ((below + 1) * dxi - now.u)
    fallback = now.status.fallback
    np.testing.assert_array_equal(fallback == TWO_MOMENTS, beta * h / 2 < least)
    assert (fallback == TWO_NODES).any()
    second = dxi * (now.M * now.xi**2).sum(axis=1)
    matched = fallback != TWO_MOMENTS
    scale = h * (np.abs(u) + np.sqrt(2 * beta * h)) ** 2
    assert (np.abs(second - moments(h, now.u)[2])[matched] <= 64 * EPS * scale[matched]).all()
    assert now.status.iterations.max() <= 3
    assert now.status.residual[matched].max() <= 1e-13
    worst = np.abs(second - moments(h, now.u)[2])[~matched] / (2 * beta * h * h)[~matched]
    np.testing.assert_allclose(now.status.residual[~matched], worst, rtol=1e-6)


def test_entropic_is_the_minimiser(rng: np.random.Generator) -> None:
    """Any other density with the same mass and momentum has more entropy: shown along random admissible directions."""
    h, u = rng.uniform(0.05, 2.0, 40), rng.uniform(-1.0, 1.0, 40)
    n, bound = 40, 2.6
    now = step(scene_with(h, u), Kinetic(1, Uniform(n, bound), "entropic"), h, h * u, 1e-9)
    assert now.status.converged.all()
    xi, f = now.xi, now.M

    def entropy(g: np.ndarray) -> np.ndarray:
        return (xi**2 * g / 2 + (math.pi * BETA) ** 2 / 6 * g**3).sum(axis=1)

    for _ in range(50):
        way = rng.normal(size=f.shape) * (f > 0)
        for i in range(len(h)):
            support = f[i] > 0
            inside = np.linalg.qr(np.stack([np.ones(support.sum()), xi[support]]).T)[0]
            way[i, support] -= inside @ (inside.T @ way[i, support])
        size = (
            1e-3
            * np.min(np.where(f > 0, f, np.inf), axis=1)[:, None]
            / np.abs(way).max(axis=1, initial=1e-300)[:, None]
        )
        assert (entropy(f + size * way) >= entropy(f) * (1 - 4 * EPS)).all()


def test_entropic_agrees_with_the_semicircle_with_shifted_parameters(rng: np.random.Generator) -> None:
    """f_j^2 (pi beta)^2 + xi_j^2 is linear in xi_j where f > 0, and at most that line elsewhere."""
    h, u = rng.uniform(0.05, 2.0, 100), rng.uniform(-1.0, 1.0, 100)
    now = step(scene_with(h, u), Kinetic(1, Uniform(64, 2.6), "entropic"), h, h * u, 1e-9)
    for f in now.M:
        inside = f > 0
        line = np.polynomial.Polynomial.fit(now.xi[inside], ((math.pi * BETA * f) ** 2 + now.xi**2)[inside], 1)
        np.testing.assert_allclose(line(now.xi[inside]), ((math.pi * BETA * f) ** 2 + now.xi**2)[inside], atol=1e-6)
        assert (line(now.xi[~inside]) <= now.xi[~inside] ** 2 + 1e-6).all()


def pile(rng: np.random.Generator, zeta: float, delta: float, fill: float) -> Scene:
    cells = Cells(-2, 2, 64)
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(delta), 0.4 * math.cos(zeta)
    rise = np.cumsum(rng.uniform(s - fill * R, s + fill * R, 64) * cells.dx / beta)
    return Scene(
        cells=cells,
        heap=Profile(rise - rise.min() + 0.5),
        chute=ConstantSlope(zeta),
        friction=Coulomb(delta),
        epsilon=0.4,
    )


@pytest.mark.parametrize(("scheme", "zeta"), [(2, 0.1), (3, 0.0)])
def test_a_matched_pile_stays_at_rest(scheme: int, zeta: float, rng: np.random.Generator) -> None:
    """On a grid of 32 velocity cells, 10^4 steps; plain cell averages do not."""
    scene = pile(rng, zeta, 0.4, 0.9)
    run = simulate(scene, Kinetic(scheme, Uniform(32), "matched"), Fixed(1e-3, 10_000), 1000)
    assert np.abs(run.q).max() <= 1e-14
    assert np.abs(run.h - run.h[0]).max() <= 4 * EPS * run.h.max()
    assert run.verdict.kind == "at-rest"
    assert run.entries["fallbacks"][-1] == 0
    plain = simulate(scene, Kinetic(scheme, Uniform(32)), Fixed(1e-3, 100), 100)
    assert np.abs(plain.q).max() > 1e-8


def test_fewer_nodes_than_needed_are_refused() -> None:
    for name, least in NODES.items():
        if least > 2:
            with pytest.raises(ValueError, match=f"equilibrium '{name}' needs at least {least} velocity cells, got 2"):
                Kinetic(velocity=Uniform(2), equilibrium=name)
    with pytest.raises(ValueError, match="fitted nodes carry M itself"):
        Kinetic(velocity=Fitted(6), equilibrium="matched")


def test_a_match_that_cannot_be_is_counted(rng: np.random.Generator) -> None:
    """A film thinner than a velocity cell falls back to two moments; the ledger counts it, the run goes on."""
    scene = replace(SCENES["sine"][0], cells=Cells(-3, 11, 28), heap=Profile(np.full(28, 1e-7), np.full(28, 0.33)))
    run = simulate(scene, Kinetic(1, Uniform(16, 3.0), "matched"), Fixed(1e-3, 10), 10)
    assert run.verdict.kind == "finished"
    assert run.entries["fallbacks"][-1] >= 28
    assert run.entries["two_moments"][-1] == run.entries["fallbacks"][-1]
    assert run.entries["mass_only"][-1] == 0
    assert run.entries["residual"][-1] > 1.0


def test_fill_of_a_face_takes_each_half_from_its_side(rng: np.random.Generator) -> None:
    """Row i holds the left state for xi > 0 and the right state for xi < 0, for every equilibrium."""
    (hl, ul), (hr, ur) = random_states(rng, 20), random_states(rng, 20)
    hl, hr = hl + 0.05, hr + 0.05
    grid = Grid(64, 0.2)
    for name in EQUILIBRIA:
        rows = fill(name, hl, ul, hr, ur, BETA, grid)
        left, right = fill(name, hl, ul, hl, ul, BETA, grid), fill(name, hr, ur, hr, ur, BETA, grid)
        np.testing.assert_array_equal(rows[:, 32:], left[:, 32:])
        np.testing.assert_array_equal(rows[:, :32], right[:, :32])


@pytest.mark.parametrize("name", EQUILIBRIA)
def test_velocities_far_beyond_the_grid_are_harmless(name: EquilibriumName) -> None:
    """Nothing is written where no array is; what cannot be carried is said."""
    for u in (1e15, 1e18, 1e20, 1e160, -1e20):
        h, u2, status = np.ones(2), np.full(2, u), Status.empty(2)
        rows = fill(name, h, u2, h, u2, BETA, Grid(16, 0.1), status)
        assert np.isfinite(rows).all()
        assert (rows >= 0).all()
        if name in ("matched", "entropic"):
            assert (status.fallback == MASS_ONLY).all()
