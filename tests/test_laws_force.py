"""Laws of the force steps and projections, each over every variant: a new one is tested by being listed."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from conftest import EPS, SCENES
from states import incline, push_each, random_states, upwind

from kinsim import (
    Cells,
    Fixed,
    Kinetic,
    Uniform,
    simulate,
    step,
)
from kinsim.kinetic.equilibrium import EQUILIBRIA, EquilibriumName
from kinsim.kinetic.force import FORCES
from kinsim.method import ForceName, ProjectionName
from kinsim.schemes.questions import acts_before
from kinsim.solver.solver import Solver

CONSERVATIVE = {"shift-linear", "shift-exact"}
"""Shifts that are exact in mass and momentum of f, whatever f is."""

PROJECTIONS: tuple[ProjectionName, ...] = ("flux-difference", "re-summed")

SHIFTS = [name for name in FORCES if not acts_before(FORCES[name])]

ROOMS = [
    (equilibrium, force, PROJECTIONS[(i + j // 2) % 2], 1 + (i + j) % 4)
    for (i, equilibrium), (j, force) in itertools.product(enumerate(EQUILIBRIA), enumerate(FORCES))
]
"""Each equilibrium with each force; each of both with each projection and scheme, and these two with each other."""


@pytest.mark.parametrize(("equilibrium", "force", "projection", "scheme"), ROOMS)
def test_mirror_image(
    equilibrium: EquilibriumName, force: ForceName, projection: ProjectionName, scheme: int, rng: np.random.Generator
) -> None:
    """x, xi, u and the incline to minus: the step goes to the mirror image, within 4 ulps of the flux scale."""
    h, u = random_states(rng, 60)
    method = Kinetic(
        scheme, Uniform(48, 1.2 * float((np.abs(u) + np.sqrt(0.8 * h)).max())), equilibrium, force, projection
    )
    one = step(incline(h, u, 0.2), method, h, h * u, 1e-3)
    other = step(incline(h[::-1], -u[::-1], -0.2), method, h[::-1], -(h * u)[::-1], 1e-3)
    speed = float((np.abs(u) + np.sqrt(0.8 * h)).max())
    assert np.abs(one.h1 - other.h1[::-1]).max() <= 4 * EPS * h.max()
    assert np.abs(one.q1 + other.q1[::-1]).max() <= 4 * EPS * h.max() * speed
    assert np.abs(one.f_force - other.f_force[::-1, ::-1]).max() <= 4 * EPS * one.f_force.max()


@pytest.mark.parametrize(("equilibrium", "force"), list(itertools.product(EQUILIBRIA, FORCES)))
def test_density_stays_nonnegative(equilibrium: EquilibriumName, force: ForceName, rng: np.random.Generator) -> None:
    """Upwind transport at Courant 0.999 and a shift of any size; (18) upwind while lam |xi| + |J|/(h dxi) <= 1."""
    h, u = random_states(rng, 80)
    h[::9] = 0.0
    grid = Uniform(32, 1.1 * float((np.abs(u) + np.sqrt(0.8 * h)).max()))
    method = Kinetic(1, grid, equilibrium, force)
    scene = incline(h, u, 0.4)
    solver = Solver(scene, method)
    solver.warm_up()
    dt = 0.999 * scene.cells.dx / solver.counted
    if force not in SHIFTS:
        pull = abs(scene.chute.sin) + scene.resistance
        dt = min(dt, 1.0 / (1.1 * grid.bound / scene.cells.dx + pull / solver.grid.dxi))
    least = solver.stages(h, h * u, dt).density.f.min()
    assert (least >= 0.0) == (force != "derivative-centred")


def test_derivative_force_leaves_the_range_beyond_its_limit_and_says_so(rng: np.random.Generator) -> None:
    """Past dt g/dxi = 1 the upwind form of (18) goes negative: booked, named in the verdict, and U is not touched."""
    scene = replace(SCENES["sine"][0], cells=Cells(-3, 11, 70))
    gentle, rough = (
        simulate(scene, Kinetic(1, Uniform(n, 4.0), force="derivative-upwind"), Fixed(2e-2, 25), 5) for n in (64, 2048)
    )
    pull = scene.chute.sin + scene.resistance
    assert 2e-2 * pull / (8 / 64) + 2e-2 / scene.cells.dx * 4.0 <= 1.0
    assert 2e-2 * pull / (8 / 2048) > 1.0
    assert gentle.entries["f_min"].min() == 0.0
    assert "f fell" not in str(gentle.verdict)
    assert rough.entries["f_min"].min() < 0.0
    assert "f fell to" in str(rough.verdict)
    assert rough.verdict.kind == "finished"


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_all_exact_shifts_give_the_same_state(projection: ProjectionName, rng: np.random.Generator) -> None:
    """In flux-difference form no shift touches (h, q); summed anew, every shift exact in (m0, m1) gives the same."""
    h, u = random_states(rng, 60)
    scene = incline(h, u, 0.3)
    bound = 1.5 * float((np.abs(u) + np.sqrt(0.8 * h)).max())
    names = SHIFTS
    if projection == "re-summed":
        names = [name for name in names if name in CONSERVATIVE]
    ends = [step(scene, Kinetic(3, Uniform(64, bound), "matched", name, projection), h, h * u, 1e-3) for name in names]
    assert len(ends) >= 2
    for end in ends[1:]:
        np.testing.assert_allclose(end.h1, ends[0].h1, rtol=64 * EPS)
        assert np.abs(end.q1 - ends[0].q1).max() <= 64 * EPS * h.max() * bound


def test_limiter_of_pfc_costs_momentum_at_the_rim_only() -> None:
    """PFC without its limiter is exact in momentum; what the limiter costs is far below the impulse."""
    h = np.full(4, 1.0)
    u = np.full(4, 0.2)
    scene = incline(h, u, 0.5)
    now = step(scene, Kinetic(1, Uniform(64, 2.5), force="shift-pfc"), h, h * u, 2e-2)
    dxi = now.xi[1] - now.xi[0]
    gained = dxi * ((now.f_force - now.f_transport) @ now.xi)
    assert 0 < np.abs(gained - now.impulse).max() <= 0.02 * np.abs(now.impulse).max()
    np.testing.assert_allclose(now.f_force.sum(axis=1), now.f_transport.sum(axis=1), rtol=16 * EPS)


@pytest.mark.parametrize("force", FORCES)
def test_both_signs_of_the_force_are_equal(force: ForceName, rng: np.random.Generator) -> None:
    """A density pushed down is the mirror image of the mirrored one pushed up, bit for bit, over many cells, too."""
    f, M = rng.uniform(0, 1, (2, 12, 40))
    f[:, :8] = f[:, -8:] = M[:, :8] = M[:, -8:] = 0.0
    h = np.full(12, 2.0)
    J = np.linspace(0.0, 6.0, 12) * 0.1 * 2.0
    up, down, moved_up, moved_down = np.empty_like(f), np.empty_like(f), np.zeros(12), np.zeros(12)
    push_each(FORCES[force], f, M, J, h, 0.1, up, moved_up)
    push_each(FORCES[force], f[:, ::-1].copy(), M[:, ::-1].copy(), -J, h, 0.1, down, moved_down)
    np.testing.assert_array_equal(up, down[:, ::-1])
    np.testing.assert_array_equal(moved_up, -moved_down)


@pytest.mark.parametrize("name", SHIFTS)
def test_free_transport_with_constant_force(name: ForceName) -> None:
    """Transport and force rooms alone against f0(x - xi t + g t^2/2, xi - g t): of first order in the steps."""
    errors = []
    for level in (1, 2, 4):
        nx, n, steps, end, g = 60 * level, 60 * level, 40 * level, 0.5, 0.7
        x = (np.arange(nx) + 0.5) / nx * 4 - 2
        dx, xi, dxi, dt = 4 / nx, ((np.arange(n) + 0.5) / n * 4 - 2), 4 / n, end / steps

        def start(x: np.ndarray, xi: np.ndarray) -> np.ndarray:
            return np.exp(-8 * x**2 - 8 * xi**2)

        f = start(x[:, None], xi[None, :])
        offset = np.zeros(nx)
        for _ in range(steps):
            moved, new = upwind(f, xi + offset[0], dt / dx, periodic=True), np.zeros(nx)
            push_each(FORCES[name], moved, f, np.full(nx, dt * g), np.ones(nx), dxi, f, new)
            offset += new
        v = xi + offset[0]
        exact = start(x[:, None] - v * end + g * end**2 / 2, v[None, :] - g * end)
        errors.append(np.abs(f - exact).sum() * dx * dxi)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (np.abs(orders - 1.0) <= 0.25).all(), (errors, orders)
