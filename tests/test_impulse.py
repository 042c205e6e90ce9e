"""The impulse of gravity and friction, and which cells are slow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from covering import covering
from states import ghosted, random_states, scene_with

from kinsim import Kinetic, Macroscopic, Uniform, step
from kinsim.schemes.formulas import acceleration, static_acceleration

EPS = float(np.finfo(float).eps)
GROUNDS = [(0.0, 0.3), (0.2, 0.1), (-0.2, 0.3), (0.1, None), (0.0, None)]
"""zeta, delta: flat, sliding, held uphill, frictionless incline, nothing at all."""


def test_friction_is_against_the_motion() -> None:
    """g(u) = sin zeta - sgn(u) R of (1)."""
    assert acceleration(1e-300, 0.3, 0.2) == 0.3 - 0.2
    assert acceleration(-5.0, 0.3, 0.2) == 0.3 + 0.2


def test_static_friction_is_bounded_by_dynamic() -> None:
    """(22): what holds the slope, between sin zeta - R and sin zeta + R."""
    s, R = 0.1, 0.3
    for slope in np.linspace(-1, 1, 41):
        held = static_acceleration(0.0, 2.0 * slope, s, R, 1.0, 1.0)
        assert held == np.clip(slope, s - R, s + R)


@pytest.mark.parametrize(
    ("scheme", "ground", "boundary"), covering([1, 2, 3], GROUNDS, ["periodic", "wall", "open"]), ids=str
)
def test_impulse_by_the_book(
    scheme: int, ground: tuple[float, float | None], boundary: str, rng: np.random.Generator
) -> None:
    """J and the choice of slow cells, recomputed from the states, in all branches."""
    zeta, delta = ground
    h, u = random_states(rng, 200, decades=0.7)
    h = np.maximum(h, 0.05)
    u[::3] *= 1e-3
    scene = scene_with(h, u, zeta=zeta, delta=delta, boundary=boundary)
    q, dt, lam = h * u, 0.002, 0.002 / scene.cells.dx
    now = step(scene, Macroscopic(scheme), h, q, dt)
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(delta or 0.0), 0.4 * math.cos(zeta)
    H = ghosted(scene, h)
    g = s - np.sign(u) * R
    slope = beta * (H[2:] - H[:-2]) / (2 * scene.cells.dx)
    g_static = np.minimum(s + R, np.maximum(slope, s - R))
    moving = dt * g * now.h1
    if scheme == 1 or (scheme == 3 and zeta == 0 and delta is None):
        slow = np.zeros(200, bool)
        expected = np.where(q == 0, dt * g_static * now.h1, moving)
    else:
        candidate = h - lam * np.diff(now.balanced_flux[0])
        slow = np.where(q == 0, s != 0 or R != 0, np.abs(q) < np.abs(dt * g * candidate))
        mu = np.divide(-q, dt * g * candidate, out=np.zeros(200), where=slow & (q != 0))
        at_rest = (1 - mu) * dt * g_static * (H[2:] + 2 * h + H[:-2]) / 4 - q
        expected = np.where(slow, at_rest, np.where(q == 0, 0, moving))
        np.testing.assert_array_equal(now.slow, slow)
        assert slow.any() == (zeta != 0 or delta is not None)
        assert not slow.all()
    np.testing.assert_allclose(now.impulse, expected, atol=4 * EPS)
    np.testing.assert_array_equal(now.q1, now.qhat + now.impulse)


def test_impulse_carries_the_height_after_transport(rng: np.random.Generator) -> None:
    """(23) acts on f^{n+1}: sliding cells get dt g h^{n+1}, not dt g h^n as (18) would give."""
    h, u = np.array([1.0, 0.5, 1.0, 0.5]), np.full(4, 0.7)
    now = step(scene_with(h, u, delta=0.2), Macroscopic(1), h, h * u, 0.01)
    np.testing.assert_allclose(now.impulse, -0.01 * math.tan(0.2) * now.h1, rtol=4 * EPS)
    assert np.abs(now.h1 - h).min() > 1e-3


def test_without_any_force_there_is_no_impulse_and_no_slow_cell() -> None:
    """sin zeta = R = 0: a cell with q = 0 is not slow, so that scheme 3 is scheme 1."""
    h = np.array([1.0, 0.4, 0.8, 0.4, 0.9])
    for method in (Macroscopic(3), Kinetic(3, Uniform(32))):
        now = step(scene_with(h), method, h, 0 * h, 0.01)
        assert not now.slow.any()
        assert (now.impulse == 0).all()
    one, three = (step(scene_with(h), Macroscopic(number), h, 0 * h, 0.01) for number in (1, 3))
    np.testing.assert_array_equal(one.h1, three.h1)
    np.testing.assert_array_equal(one.q1, three.q1)


def test_a_cell_at_rest_is_slow_where_something_pulls() -> None:
    """Otherwise an admissible pile on flat ground, where g(0) h is compared with |q| = 0, would erode."""
    h = np.array([0.5, 0.51, 0.52, 0.51, 0.5])
    for zeta, delta in ((0.0, 0.1), (0.1, None), (0.1, 0.1)):
        assert step(scene_with(h, zeta=zeta, delta=delta), Macroscopic(3), h, 0 * h, 1e-3).slow.all()


def test_both_wings_share_the_impulse() -> None:
    """Given the same h, q and h1, J is the same: the wings differ in half-range moments only."""
    h, u = np.full(6, 0.7), np.full(6, 0.3)  # uniform: h1 = h in both
    results = [
        step(scene_with(h, u, zeta=0.1, delta=0.3), method, h, h * u, 0.01)
        for method in (Macroscopic(2), Kinetic(2, Uniform(64)))
    ]
    np.testing.assert_allclose(results[0].impulse, results[1].impulse, rtol=16 * EPS)


# ---- theory.md, section 3: what the rules do that friction should not ------------------------------------------------


def test_flaw_6_weights_leave_the_unit_interval() -> None:
    """g and q of one sign (zeta > delta, downhill): mu < 0, and a slow cell gets more than the Coulomb bound."""
    h, dt = np.full(5, 0.7), 0.01
    s, R = math.sin(0.4), math.cos(0.4) * math.tan(0.1)
    q = np.full(5, 0.9 * dt * (s - R) * 0.7)
    now = step(scene_with(h, q / h, zeta=0.4, delta=0.1), Macroscopic(2), h, q, dt)
    assert now.slow.all()
    assert (now.impulse + q > 1.5 * dt * (s - R) * h).all()  # 1 - mu = 1.9


def test_flaw_7_friction_can_reverse_a_slow_cell() -> None:
    """By up to dt R h: friction alone should stop a cell, but the slope's hold is granted besides."""
    h = np.array([0.5, 0.55, 0.6, 0.55, 0.5])
    dt = 0.01
    q = np.zeros(5)
    q[1] = 1e-12  # hardly moving uphill
    now = step(scene_with(h, q / h, delta=0.5), Macroscopic(3), h, q, dt)
    assert now.slow[1]
    assert abs(now.impulse[1]) <= 2 * dt * math.tan(0.5) * h[1]
