"""Scheme 4 on wild states: mass, positivity, bounded velocities, symmetry, and what it is without friction."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from covering import covering
from repaired import EPS, EVERY, IN_CLOSED_FORM, METHODS, VARIANTS, WINGS, of_methods, wild
from states import random_states, scene_with

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fixed,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    simulate,
    step,
)  # fmt: skip
from kinsim.solver.solver import Solver

STARTS = [(0, "wall", 0.0), (1, "periodic", 0.2), (2, "wall", 1.3), (3, "periodic", -1.3)]
"""Seed, boundary and zeta."""


@pytest.mark.parametrize(("method", "start"), of_methods(covering(WINGS, VARIANTS, STARTS)))
def test_wild_states(method: Macroscopic | Kinetic, start: tuple[int, str, float]) -> None:
    """200 steps at the limit: mass to 1e-14, h >= 0, f >= 0, all finite, |u| <= max(|u| + c) + dt max|G|.

    |u| + c is that of all states that cells show, half a step later in second order, where the force acts on up to
    2 h^{n+1}, so that it counts twice.
    """
    seed, boundary, zeta = start
    rng = np.random.default_rng(seed)
    h, u = wild(rng)
    scene = scene_with(h, u, zeta=zeta, delta=rng.choice([0.1, 0.3, 1.0]), boundary=boundary)
    pull = abs(scene.chute.sin) + scene.resistance
    q, mass = h * u, math.fsum(h)
    for _ in range(200):
        if isinstance(method, Kinetic) and isinstance(method.velocity, Uniform):
            reach = np.max(np.abs(u) + np.sqrt(2 * scene.beta * h))
            method = replace(method, velocity=Uniform(32, float(1.5 * reach)))
        solver = Solver(scene, method)
        solver.put(h, q)
        solver.warm_up()
        speed = solver.counted
        dt = math.nextafter(scene.cells.dx / speed, 0.0)
        now = solver.stages(h, q, dt)
        h, q = now["h1"], now["q1"]
        u = np.divide(q, h, out=np.zeros_like(q), where=h > 0)
        assert h.min() >= 0
        assert np.isfinite(h).all()
        assert np.isfinite(q).all()
        if solver.grid is not None:
            assert now.density.transported.min() >= 0
            assert now.density.f.min() >= 0
        shown = max(speed, *(np.abs(now[name])[np.isfinite(now[name])].max() for name in ("low", "high")))
        assert np.abs(u).max() <= (shown + method.order * dt * pull) * (1 + 8 * EPS)
        assert abs(now.books.coupling_drift) <= 60 * EPS
    assert abs(math.fsum(h) / mass - 1) <= 1e-14


@EVERY
def test_mirrored_state_steps_to_the_mirror_image(method: Macroscopic | Kinetic, rng: np.random.Generator) -> None:
    """x, xi, u and zeta to minus, bit for bit; so that the four ulps which sums over a grid may take are not used."""
    h, u = random_states(rng, 70)
    u[20:40] = 0.0
    for boundary, zeta in (("periodic", 0.1), ("wall", 0.5), (("open", "wall"), 0.1)):
        ends = boundary if isinstance(boundary, str) else boundary[::-1]
        one = step(scene_with(h, u, zeta=zeta, delta=0.3, boundary=boundary), method, h, h * u, 0.004)
        g, v = h[::-1].copy(), -u[::-1]
        other = step(scene_with(g, v, zeta=-zeta, delta=0.3, boundary=ends), method, g, g * v, 0.004)
        np.testing.assert_array_equal(one.h1, other.h1[::-1])
        np.testing.assert_array_equal(one.q1, -other.q1[::-1])
        if one.f_force is not None:
            np.testing.assert_array_equal(one.f_force, other.f_force[::-1, ::-1])


@pytest.mark.parametrize(("method", "zeta"), of_methods(covering(WINGS, VARIANTS, [0.4, 0.0])))
def test_without_friction_it_is_scheme_1_bit_for_bit(method, zeta, rng: np.random.Generator) -> None:
    """Where the clip does not act: on wet ground, before slopes."""
    if method.order == 2:
        h, u = np.full(40, 0.7), np.full(40, 0.3)  # nothing to reconstruct
        scene = scene_with(h, u, zeta=zeta, boundary="periodic")
        now = step(scene, method, h, h * u, 0.004)
        np.testing.assert_allclose(now.q1, h * (u + 0.004 * scene.chute.sin), rtol=8 * EPS)
        return
    h = 0.5 + rng.uniform(0, 0.4, 60)
    u = rng.uniform(-0.3, 0.3, 60)
    scene = scene_with(h, u, zeta=zeta, boundary="wall")
    plain = {"scheme": 1, "statics": "hold"}
    one, other = step(scene, method, h, h * u, 0.004), step(scene, replace(method, **plain), h, h * u, 0.004)
    np.testing.assert_array_equal(one.h1, other.h1)
    np.testing.assert_array_equal(one.q1, other.q1)
    if one.f_force is not None:
        np.testing.assert_array_equal(one.f_force, other.f_force)


@IN_CLOSED_FORM
@pytest.mark.parametrize(("zeta", "delta"), [(0.0, None), (0.0, 0.3), (0.5, 0.3)])
def test_a_film_and_a_dry_bed_are_the_same(method: Macroscopic, zeta: float, delta: float | None) -> None:
    """A dam breaks onto dry ground and onto a film of 1e-12: L1 of the difference <= 1e-10."""
    x = (np.arange(80) + 0.5) / 80
    ends = []
    for film in (0.0, 1e-12):
        scene = scene_with(np.where(np.abs(x - 0.4) < 0.2, 1.0, film), zeta=zeta, delta=delta, boundary="open")
        ends.append(simulate(scene, method, Courant(0.9, 1.0), 10**6).h[-1])
    assert 0.05 * np.abs(ends[0] - ends[1]).sum() <= 1e-10


@pytest.mark.parametrize("name", ["closed, first", "closed, second", "closed, second, mc", "fitted, first"])
@pytest.mark.parametrize(("zeta", "delta"), [(0.0, None), (0.3, 0.25), (-0.6, 0.25)])
def test_a_film_far_before_a_front_is_dry_ground(name: str, zeta: float, delta: float | None) -> None:
    """A higher column, for longer, also down ground steeper than its friction angle; the film alone weighs 1e-11."""
    x = (np.arange(200) + 0.5) / 200
    ends = []
    for film in (0.0, 1e-12):
        scene = scene_with(np.where(np.abs(x - 0.5) < 0.1, 1.5, film), zeta=zeta, delta=delta, boundary="wall")
        ends.append(simulate(scene, METHODS[name], Fixed(0.005, 400), 10**6).h[-1])
    assert 0.05 * np.abs(ends[0] - ends[1]).sum() <= (2e-10 if "mc" in name else 1e-10)


@pytest.mark.parametrize(("method", "seed"), of_methods(covering(WINGS, VARIANTS, range(2))))
def test_friction_never_reverses_and_never_accelerates(method: Macroscopic | Kinetic, seed: int) -> None:
    """On flat ground q^{n+1} has the sign of the momentum that arrived, and is smaller, by dt R H at most."""
    rng = np.random.default_rng(seed)
    h, u = random_states(rng, 80)
    u[20:60] *= 1e-3
    now = step(scene_with(h, u, delta=1.2, boundary="periodic"), method, h, h * u, 0.01)
    assert (now.q1 * now.qhat >= 0).all()
    assert (np.abs(now.q1) <= np.abs(now.qhat)).all()
    assert (now.q1[now.qhat != 0] == 0).any()
    moving = np.abs(now.q1) > 0
    pulled = now.h1 if method.order == 1 else np.minimum(0.5 * (h + now.h1), 2.0 * now.h1)
    full = 0.01 * 1.0 * math.tan(1.2) * pulled[moving]
    lost = (np.abs(now.qhat) - np.abs(now.q1))[moving]
    assert (lost <= full * (1 + 1e-12) + 4 * EPS).all()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("film", [1e-12, 1e-6])
def test_a_film_between_the_nodes_stays_finite(order: int, film: float) -> None:
    """Sampled M of a film thinner than a velocity cell is zero at all nodes: no particle is seen, and none clips it."""
    h = np.where(np.arange(30) // 10 == 1, 0.5, film)
    scene = scene_with(h, np.full(30, 0.317), zeta=0.5, delta=0.3, boundary="wall")
    method = Kinetic(4, Uniform(32, 3.0), "sampled", order=order)
    q = 0.317 * h
    for _ in range(20):
        now = step(scene, method, h, q, 0.01)
        h, q = now.h1, now.q1
        assert np.isfinite(h).all()
        assert np.isfinite(q).all()


def test_a_dry_cell_between_fast_ones_shows_no_velocity() -> None:
    """Second order: a slope of u over a cell without mass is none, however fast its neighbours pass it."""
    h, u = np.array([1.0, 3.0, 0.0, 0.4, 1.0]), np.array([20.0, 9.0, 0.0, -13.0, 0.0])
    scene = Scene(Cells(0.0, 5.0, 5), Profile(h, u), ConstantSlope(0.1), Coulomb(0.3), "wall")
    now = Solver(scene, Macroscopic(order=2)).stages(h, h * u, 0.01)
    assert np.isfinite(now["h1"]).all()
    assert now["u_plus"][2] == now["u_minus"][2]
