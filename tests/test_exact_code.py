"""The code against the exact solutions: what it approaches, how fast, and what it keeps to rounding.

Upwind schemes err by O(dx) in L1 where the solution is smooth. Jumps, corners of fans, fronts on dry ground cost more:
what is left is the O(sqrt dx) that holds for monotone schemes (Kuznetsov 1976); a wrong solution has order 0.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fixed,
    Kinetic,
    Macroscopic,
    Profile,
    Run,
    Scene,
    Uniform,
    step,
)
from kinsim import simulate as run_scene
from kinsim.exact import (
    AcceleratedRiemann,
    ParabolicCap,
    Riemann,
    SlidingWedge,
    StaticPile,
    TravellingShock,
    UniformSlide,
)

EPS = float(np.finfo(float).eps)
BETA = 0.35


def scene(exact: Any, cells: Cells, boundary: Any = "open") -> Scene:
    """The exact solution at t = 0 as cell averages, on its own ground."""
    h, q = exact.averages(cells, 0.0)
    u = np.divide(q, h, out=np.zeros_like(h), where=h > 0)
    zeta = math.asin(exact.pull)
    return Scene(
        cells=cells, heap=Profile(h, u), chute=ConstantSlope(zeta), boundary=boundary,
        friction=Coulomb(math.atan(exact.resistance / math.cos(zeta))), epsilon=BETA / math.cos(zeta),
    )  # fmt: skip


def l1(exact: Any, run: Run, inner: tuple[float, float]) -> np.ndarray:
    """L1 errors of h and of q at the end of a run, between two places."""
    keep = (run.x > inner[0]) & (run.x < inner[1])
    h, q = exact.averages(run.scene.cells, float(run.t[-1]))
    return np.array([np.abs(found - wanted)[keep].sum() for found, wanted in ((run.h[-1], h), (run.q[-1], q))]) * (
        run.scene.cells.dx
    )


DOWN, UP = {"pull": 0.4, "resistance": 0.3}, {"pull": 0.3, "resistance": 0.4}

ORDER = {"smooth": 0.96, "rough": 0.5}

# exact solution, end, L1 error of h allowed at dx = 0.025, order; those of q are as large but for a factor 1.5
APPROACHED = {
    "sliding wedge": (SlidingWedge(2.0, 0.1, 0.5, BETA, **DOWN), 1.0, 0.0004, "smooth"),
    "sliding wedge, slowing down": (SlidingWedge(2.5, 0.1, 0.5, BETA, **UP), 1.0, 0.0004, "smooth"),
    "wedge to the left": (SlidingWedge(2.0, 0.1, -0.5, BETA, -0.4, 0.3), 1.0, 0.0004, "smooth"),
    "wedge with a dry toe in front": (SlidingWedge(0.8, -0.2, 0.5, BETA, **DOWN), 1.0, 0.004, "smooth"),
    "wedge with a dry toe behind": (SlidingWedge(0.2, 0.2, 0.6, BETA, **DOWN), 1.0, 0.004, "smooth"),
    "fan and shock": (AcceleratedRiemann(Riemann(1, 1.2, 0.4, 1.0, BETA), **DOWN), 2.0, 0.04, "rough"),
    "two shocks": (AcceleratedRiemann(Riemann(0.6, 1.8, 0.4, 0.9, BETA), **UP), 2.0, 0.045, "rough"),
    "to the left": (AcceleratedRiemann(Riemann(0.4, -1, 1, -1.2, BETA, 3), **UP), 1.2, 0.04, "rough"),
    "dam from rest": (AcceleratedRiemann(Riemann(1, 0, 0.4, 0, BETA), **DOWN), 2.0, 0.03, "rough"),
    "dam on dry ground": (AcceleratedRiemann(Riemann(1, 0, 0, 0, BETA), **DOWN), 2.0, 0.035, "rough"),
    "shock": (TravellingShock(1, 1.2, 0.5, BETA, **DOWN), 2.0, 0.025, "rough"),
    "shock, slowing down": (TravellingShock(1, 1.2, 0.5, BETA, **UP), 2.0, 0.025, "rough"),
    "cap": (ParabolicCap(1, 1, BETA, **DOWN, u0=1.5), 1.5, 0.03, "rough"),
    "cap, slowing down": (ParabolicCap(1, 1, BETA, **UP, u0=1.5), 1.0, 0.03, "rough"),
    "cap without friction": (ParabolicCap(1, 1, BETA, 0.2, 0.0), 1.5, 0.01, "rough"),
}


@pytest.mark.parametrize("name", APPROACHED)
def test_scheme_1_approaches_it(name: str) -> None:
    """Four times as many cells; wedges between places that no open end has reached, their toes included.

    A factor of four evens out where a shock happens to be within a cell.
    """
    exact, end, allowed, kind = APPROACHED[name]
    inner = (-1.5, 3.5) if kind == "smooth" and "toe" not in name else (-3.0, 7.0)
    coarse, fine = (
        l1(exact, run_scene(scene(exact, Cells(-5, 9, count)), Macroscopic(1), Courant(0.9, end)), inner)
        for count in (140, 560)
    )
    assert (fine < allowed * np.array([1.0, 1.5])).all()
    assert (np.log(coarse / fine) / math.log(4) > ORDER[kind]).all()


@pytest.mark.parametrize("method", [Macroscopic(1), Macroscopic(2), Macroscopic(3), Kinetic(1, Uniform(64, 3.0))])
def test_uniform_slide_is_kept_to_rounding(method: Macroscopic | Kinetic) -> None:
    """No face has a jump, and each step adds m dt; 200 steps of a few roundings each."""
    slide = UniformSlide(1.0, **UP)
    run = run_scene(scene(slide, Cells(0, 1, 20), "periodic"), method, Fixed(0.01, 200))
    for i, t in enumerate(run.t):
        h, q = slide.averages(run.scene.cells, float(t))
        np.testing.assert_allclose(run.h[i], h, rtol=0, atol=200 * 4 * EPS)
        np.testing.assert_allclose(run.q[i], q, rtol=0, atol=200 * 8 * EPS)


@pytest.mark.parametrize("method", [Macroscopic(2), Macroscopic(3), Kinetic(3, Uniform(64, 3.0))])
def test_arrested_slide_rests(method: Macroscopic | Kinetic) -> None:
    """The step that friction outweighs ends at rest, up to its rounding; nothing starts again."""
    slide = UniformSlide(0.5, 0.2, 0.5)
    run = run_scene(scene(slide, Cells(0, 1, 20), "periodic"), method, Fixed(0.013, 160), save_every=10)
    arrest = slide.motion.arrest
    assert 0.5 < arrest / run.t[-1] < 0.9
    for i in np.flatnonzero(run.t > arrest + 0.013):
        np.testing.assert_allclose(run.q[i], 0.0, atol=8 * EPS)
    for i in np.flatnonzero(run.t < arrest - 0.013):
        np.testing.assert_allclose(run.q[i], slide(0.0, float(run.t[i]))[1], rtol=0, atol=200 * 8 * EPS)


@pytest.mark.parametrize("scheme", [1, 2, 3])
def test_slide_that_turns_is_one_step_off(scheme: int) -> None:
    """In the step of the arrest friction may have the wrong sign throughout: dt (|s| + R), kept ever after."""
    for given in ((0.5, -0.4, 0.2), (-0.5, 0.4, 0.2), (0.0, 0.4, 0.2), (0.0, -0.4, 0.2)):
        slide, dt = UniformSlide(*given), 0.01
        run = run_scene(scene(slide, Cells(0, 1, 20), "periodic"), Macroscopic(scheme), Fixed(dt, 200), save_every=10)
        exact = [float(slide(0.0, float(t))[1]) for t in run.t]
        assert abs(exact[-1]) > 0.1
        np.testing.assert_allclose(run.u[:, 7], exact, rtol=0, atol=dt * (abs(given[1]) + given[2]) + 1e-12)


@pytest.mark.parametrize("scheme", [2, 3])
def test_rest_needs_a_courant_number_below_0_589(scheme: int) -> None:
    """A zigzag of q in a level layer at rest is multiplied by -16 C/(3 pi), C = c dt/dx, to first order in q.

    In a slow cell the impulse takes q^n away, so that q^{n+1} is what the balanced flux leaves: its second component
    holds 4/(3 pi) h c (u_i - u_{i+1}), and nothing else limits the step. Where beta h_x = s + theta R, two steps
    multiply by (16 C/(3 pi))^2 - theta^2 on level ground. Rest in the tests below is therefore kept at C = 0.5.
    """
    cells, h = Cells(0, 1, 40), np.ones(40)
    ground = Scene(cells=cells, heap=Profile(h), boundary="periodic", friction=Coulomb(0.3), epsilon=BETA)
    q = 1e-10 * (-1.0) ** np.arange(40)
    for number in (0.5, 0.6, 0.9):
        after = step(ground, Macroscopic(scheme), h, q, number * cells.dx / math.sqrt(2 * BETA))
        np.testing.assert_allclose(after.q1, -16 * number / (3 * math.pi) * q, rtol=1e-5)


@pytest.mark.parametrize("scheme", [2, 3])
def test_arrested_wedge_rests(scheme: int) -> None:
    """It stops where the exact one does, up to O(dx), and at once, as all of it does."""
    wedge = SlidingWedge(2.5, 0.1, 0.2, BETA, **UP)
    assert 1.0 < wedge.motion.arrest < 2.0
    errors = []
    for count in (140, 280):
        run = run_scene(scene(wedge, Cells(-5, 9, count)), Macroscopic(scheme), Courant(0.5, 2.2))
        errors.append(l1(wedge, run, (0.0, 4.0))[0])
        resting = (run.x > 0.0) & (run.x < 4.0)
        assert np.abs(run.q[-1][resting]).max() < 1e-13
    assert errors[1] < 0.002
    assert errors[0] / errors[1] > 1.8


def test_wedge_that_turns() -> None:
    """Friction holds less than the pull: scheme 2 brakes it, stops it and lets it go the other way, one step off."""
    wedge = SlidingWedge(2.5, 0.1, 0.15, BETA, -0.3, 0.2)
    u, _ = wedge.motion(1.5)
    assert wedge.motion.arrest < 0.5
    assert u < -0.1
    errors = []
    for count in (150, 600):
        run = run_scene(scene(wedge, Cells(-6, 9, count)), Macroscopic(2), Courant(0.9, 1.5))
        errors.append(l1(wedge, run, (0.0, 3.0))[0])
        inner = (run.x > 0.0) & (run.x < 3.0)
        one_step = run.dt[0] * (abs(wedge.motion.drive) + wedge.resistance)
        np.testing.assert_allclose(run.u[-1][inner], u, rtol=0, atol=one_step)
    assert math.log(errors[0] / errors[1]) / math.log(4) > 0.98


@pytest.mark.parametrize("scheme", [2, 3])
def test_static_pile_stays(scheme: int) -> None:
    """On a wet floor, just inside the bound; cells at the corners hold a smaller slope than their neighbours.

    200 steps or more; q moves by a few roundings of beta h^2/2 dt/dx in each of them.
    """
    pile = StaticPile(0.999, -0.999, BETA, 0.1, 0.3, 2.0, 0.5, 0.3)
    run = run_scene(scene(pile, Cells(-4, 4, 160)), Macroscopic(scheme), Courant(0.5, 8.0))
    np.testing.assert_allclose(run.h[-1], pile.averages(run.scene.cells, 0.0)[0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(run.q[-1], 0.0, atol=1e-14)
