"""Smooth chutes (13): mass, positivity, rest, symmetry and friction, in both wings and both orders."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from laboratory.chutes import admissible, wavy

import kinsim
from kinsim import (
    Arc,
    Bend,
    Bowl,
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Crest,
    Fitted,
    Fixed,
    Inflow,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    SlopeFormula,
    SmoothChute,
    Uniform,
    Window,
)  # fmt: skip

METHODS = {
    "closed": Macroscopic(),
    "closed, reflect": Macroscopic(statics="reflect"),
    "closed, order 2": Macroscopic(order=2),
    "fitted": Kinetic(velocity=Fitted(6)),
    "fitted, order 2": Kinetic(velocity=Fitted(6), order=2),
    "32 nodes": Kinetic(velocity=Uniform(32)),
    "32 nodes, reflect": Kinetic(velocity=Uniform(32), statics="reflect"),
    "32 nodes, order 2": Kinetic(velocity=Uniform(32), order=2),
    "32 nodes, matched": Kinetic(velocity=Uniform(32), equilibrium="matched"),
    "window": Kinetic(velocity=Window(0.1)),
}
EVERY = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)


def wild(dice: np.random.Generator, nx: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Heights over many decades, with dry cells, and velocities of both signs."""
    h = 10.0 ** dice.uniform(-12.0, 0.5, nx) * (dice.random(nx) < 0.8)
    return h, np.where(h > 0.0, dice.normal(0.0, 2.0, nx), 0.0)


LIMIT = 0.999
"""A Courant number just below the largest one."""


@EVERY
@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_mass_stays_and_no_height_is_negative(method: Kinetic | Macroscopic, boundary: str) -> None:
    for seed in range(3):
        dice = np.random.default_rng(seed)
        scene = wavy(*wild(dice), eta=[0.0, 1.0, 1e4][seed], boundary=boundary)
        run = kinsim.simulate(scene, method, Courant(LIMIT, 0.3), save_every=20)
        assert run.verdict.kind == "finished", run.verdict
        before, after = (math.fsum(h) for h in run.h[[0, -1]])  # the books would take a leak of a wall for an inflow
        assert abs(after - before) <= 1e-14 * before
        assert abs(run.mass_drift) <= 1e-14
        assert run.h.min() >= 0.0
        assert (run.entries["h_min"] >= 0.0).all()


@EVERY
def test_density_is_not_negative(method: Kinetic | Macroscopic) -> None:
    scene = wavy(*wild(np.random.default_rng(4)), eta=1.0)
    run = kinsim.simulate(scene, method, Courant(LIMIT, 0.2))
    assert run.entries.get("f_min", np.zeros(1))[1:].min(initial=0.0) >= 0.0


@EVERY
def test_admissible_masses_stay_bit_for_bit(method: Kinetic | Macroscopic) -> None:
    """Wet and dry, on a chute whose slope stays below the angle of friction everywhere."""
    for seed in range(4):
        dice = np.random.default_rng(seed)
        blank = wavy(np.zeros(80), delta=0.6)
        h = admissible(blank, dice, [0.0, 0.3, 1.0, 2.0][seed], 1.0)
        assert (h > 0.0).any()
        scene = replace(blank, heap=Profile(h))
        run = kinsim.simulate(scene, method, Fixed(0.01, 300))
        assert np.array_equal(run.h[-1], h)
        assert not run.q[-1].any()


@EVERY
def test_mass_that_leans_on_a_wall_stays(method: Kinetic | Macroscopic) -> None:
    """Steeper than the angle of friction, at 99 percent of what friction can hold."""
    scene = Scene(
        Cells(0.0, 4.0, 50), Profile(np.zeros(50)), SmoothChute(Bend(0.7, 0.5, 0.5, 3.5)), Coulomb(0.4), "wall", 0.4
    )
    h = admissible(scene, np.random.default_rng(1), 1.0, 0.99)
    run = kinsim.simulate(replace(scene, heap=Profile(h)), method, Fixed(0.005, 200))
    assert np.array_equal(run.h[-1], h)
    assert not run.q[-1].any()


@pytest.mark.parametrize("method", [Macroscopic(), Kinetic(velocity=Uniform(64))])
def test_what_barely_moves_sends_no_mass(method: Kinetic | Macroscopic) -> None:
    """Cells of unlike beta at the balanced jump, moving by roundings, so that their faces are held but not still."""
    cells = Cells(-3.0, 3.0, 30)
    blank = Scene(cells, Profile(np.zeros(30)), SmoothChute(Bowl(1.2, 0.0, 1.5)), Coulomb(1.3), "wall", 0.4)
    h = admissible(blank, np.random.default_rng(2), 1.0, 0.5)
    now = kinsim.step(blank, method, h, 1e-14 * h, 1e-3)
    whole = (2.0 * 0.4 * h.max()) ** 1.5 / (3.0 * np.pi * 0.4)
    assert np.abs(now.flux[0]).max() <= (1e-11 if isinstance(method, Macroscopic) else 2e-3) * whole


@EVERY
def test_too_steep_a_face_starts(method: Kinetic | Macroscopic) -> None:
    scene = wavy(np.zeros(80), delta=0.6)
    h = admissible(scene, np.random.default_rng(3), 1.5, 0.9)
    h[40:] += 1.2 * 2.0 * scene.cells.dx * math.tan(0.6) / 0.4
    run = kinsim.simulate(replace(scene, heap=Profile(h)), method, Fixed(0.005, 20))
    assert not np.array_equal(run.h[-1], h)


@pytest.mark.parametrize("name", ["closed", "closed, reflect", "closed, order 2", "fitted", "32 nodes"])
@pytest.mark.parametrize("boundary", ["wall", "periodic", "open"])
def test_constant_slope_is_a_smooth_chute(name: str, boundary: str) -> None:
    """A formula without x has the same ground but for the cosine of another library: one digit."""
    h, u = wild(np.random.default_rng(7))
    h = np.maximum(h, 1e-3)
    plane = wavy(h, u, boundary=boundary, delta=0.4)
    plane = replace(plane, chute=ConstantSlope(0.3))
    other = replace(plane, chute=SmoothChute(SlopeFormula("0.3"), 1.0))
    one, two = (kinsim.simulate(scene, METHODS[name], Fixed(0.004, 50)) for scene in (plane, other))
    np.testing.assert_allclose(one.h[-1], two.h[-1], rtol=0, atol=1e-13)
    np.testing.assert_allclose(one.q[-1], two.q[-1], rtol=0, atol=1e-13)


@EVERY
def test_mirror(method: Kinetic | Macroscopic) -> None:
    h, u = wild(np.random.default_rng(9))
    left = Scene(Cells(-3.0, 3.0, 60), Profile(h, u), SmoothChute(Bowl(0.8, 0.3, 1.5), 1.0), Coulomb(0.4), "wall", 0.4)
    right = replace(left, heap=Profile(h[::-1], -u[::-1]), chute=SmoothChute(Bowl(0.8, -0.3, 1.5), 1.0))
    one, two = (kinsim.simulate(scene, method, Courant(LIMIT, 0.5)) for scene in (left, right))
    np.testing.assert_allclose(one.h[-1], two.h[-1, ::-1], rtol=0, atol=1e-14)
    np.testing.assert_allclose(one.q[-1], -two.q[-1, ::-1], rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", ["closed", "closed, reflect", "closed, order 2"])
def test_friction_never_reverses_and_never_accelerates(name: str) -> None:
    """One uniform stream at the bottom of a bowl, where gravity pulls nowhere: it slows, and does not turn."""
    n, pull = 24, 1e-4 * np.abs(np.sin(0.012 / 5.0)) * np.arange(401)
    cells, heap = Cells(-0.012, 0.012, n), Profile(np.ones(n), np.full(n, 3.0))
    for eta in (0.0, 1.0, 100.0, 1e4):
        scene = Scene(cells, heap, SmoothChute(Arc(5.0), eta), Coulomb(0.4), "open", 0.4)
        run = kinsim.simulate(scene, METHODS[name], Fixed(1e-4, 400), save_every=1)
        middle = run.u[:, n // 2 - 1 : n // 2 + 1]
        assert (middle >= -pull[:, None]).all()
        assert (np.diff(middle, axis=0) <= 1e-12 + 1e-4 * 0.012).all()
        assert middle[-1].max() < 3.0 - 0.5 * 0.04 * math.tan(0.4) * min(1.0 + eta / 5.0, 30.0)


@pytest.mark.parametrize("k", [0.02, 1.0])
def test_friction_of_a_bend_slows_like_its_equation(k: float) -> None:
    """u' = -tan delta (1 + k u^2) at the bottom of a vast bowl, which a tangent solves; order 2 in dt."""
    mu, n = math.tan(0.4), 8
    exact = math.tan(math.atan(3.0 * math.sqrt(k)) - mu * math.sqrt(k) * 0.4) / math.sqrt(k)
    heap = Profile(np.ones(n), np.full(n, 3.0))
    scene = Scene(Cells(-1.0, 1.0, n), heap, SmoothChute(Arc(5e9), 5e9 * k), Coulomb(0.4), "periodic", 0.4)
    errors = []
    for steps in (20, 40, 80):
        run = kinsim.simulate(scene, Macroscopic(order=2), Fixed(0.4 / steps, steps))
        errors.append(abs(run.u[-1].mean() - exact))
    assert errors[0] / errors[1] > 3.4
    assert errors[1] / errors[2] > 3.4


@pytest.mark.parametrize("a", [0.05, 1.0, 30.0, 1e4])
def test_stiff_friction_of_a_bend_leaves_what_its_equation_leaves(a: float) -> None:
    """u' = -k u^2 from u = 3 over one step of a = dt k u: u/(1 + a), within a fifth, without the rest of friction."""
    dt, n = 1e-3, 8
    eta = a / (dt * 3.0 * math.tan(0.4))
    scene = Scene(
        Cells(-1.0, 1.0, n), Profile(np.ones(n), np.full(n, 3.0)), SmoothChute(Arc(5e9), 5e9 * eta), Coulomb(0.4),
        "periodic", 0.4,
    )  # fmt: skip
    left = kinsim.simulate(scene, Macroscopic(), Fixed(dt, 1)).u[-1] + dt * math.tan(0.4)
    np.testing.assert_allclose(left, 3.0 / (1.0 + a), rtol=0.2, atol=dt)


def test_kinetic_and_closed_form_agree_to_second_order_in_the_velocity_cell() -> None:
    x = Cells(0.0, 2.0 * math.pi, 80).x
    scene = wavy(1.0 + 0.3 * np.sin(x), 0.2 * np.cos(x), eta=1.0, boundary="periodic")
    clock = Fixed(0.01, 40)
    for order in (1, 2):
        exact = kinsim.simulate(scene, Macroscopic(order=order), clock)
        errors = []
        for count in (32, 64, 128, 256):
            run = kinsim.simulate(scene, Kinetic(velocity=Uniform(count, 4.0), order=order), clock)
            errors.append(np.abs(run.h[-1] - exact.h[-1]).mean() + np.abs(run.q[-1] - exact.q[-1]).mean())
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        assert orders.mean() >= 1.9, (errors, orders)
        assert errors[-1] < 1e-5


def test_steady_stream_keeps_its_discharge() -> None:
    """Faster than its waves everywhere, a stream over a crest comes to a discharge that is the same in all cells."""
    chute = SmoothChute(Crest(0.3, 0.5, 4.0, 0.8))
    scene = Scene(
        Cells(0.0, 10.0, 100), kinsim.Expression("0.3", "2"), chute, Coulomb(math.radians(20.0)),
        (Inflow(0.3, 2.0), "open"), 0.4,
    )  # fmt: skip
    for method in (Macroscopic(), Macroscopic(statics="reflect"), Kinetic(velocity=Fitted(6))):
        run = kinsim.simulate(scene, method, Courant(0.9, 40.0))
        q = run.q[-1]
        assert np.ptp(q) <= 1e-13
        assert abs(q[0] - 0.6) <= 1e-13
