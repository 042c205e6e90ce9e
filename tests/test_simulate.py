"""The time loop: verdicts, ledger, clocks, reproducibility."""

from __future__ import annotations

import hashlib
import math
import re
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import SCENES
from states import scene_with

import kinsim
from kinsim import Cells, Courant, Dump, Fixed, Kinetic, Macroscopic, Uniform, simulate, step

EPS = float(np.finfo(float).eps)
PARABOLA = replace(SCENES["parabola"][0], cells=Cells(-4, 4, 80))
METHODS = [Macroscopic(3), Kinetic(3, Uniform(16))]


def sliding(zeta: float = 0.6, speed: float = 0.0) -> kinsim.Scene:
    """A uniform layer on a steep frictionless chute: u grows by sin zeta per time, without end."""
    return scene_with(np.full(10, 0.5), np.full(10, speed), zeta=zeta, boundary="periodic")


@pytest.mark.parametrize("method", METHODS)
def test_rows_begin_with_the_start_and_end_with_the_end(method: Macroscopic | Kinetic) -> None:
    run = simulate(PARABOLA, method, Fixed(1e-3, 250), save_every=100)
    np.testing.assert_allclose(run.t, [0, 0.1, 0.2, 0.25], rtol=1e-15)
    h, q = PARABOLA.initial()
    np.testing.assert_array_equal(run.h[0], h)
    np.testing.assert_array_equal(run.q[0], q)
    assert run.h.shape == run.q.shape == run.u.shape == (4, 80)
    assert run.ledger.sizes == {"t": 4}
    assert run.steps == 250
    assert run.verdict.kind == "finished"
    assert run.verdict.step == 250


@pytest.mark.parametrize("method", [Macroscopic(3), Kinetic(3, Uniform(16, 1.2))])
def test_run_is_a_chain_of_steps(method: Macroscopic | Kinetic) -> None:
    """Bit for bit: nothing is carried from step to step but (h, q)."""
    run = simulate(PARABOLA, method, Fixed(1e-3, 30), save_every=1)
    for n in range(30):
        one = step(PARABOLA, method, run.h[n], run.q[n], 1e-3)
        np.testing.assert_array_equal(one.h1, run.h[n + 1])
        np.testing.assert_array_equal(one.q1, run.q[n + 1])


@pytest.mark.parametrize("method", METHODS)
def test_saving_does_not_change_the_run(method: Macroscopic | Kinetic) -> None:
    often, seldom = (simulate(PARABOLA, method, Fixed(1e-3, 200), save_every=every) for every in (1, 1000))
    np.testing.assert_array_equal(often.h[-1], seldom.h[-1])
    np.testing.assert_array_equal(often.q[-1], seldom.q[-1])


# ---- verdicts --------------------------------------------------------------------------------------------------------


def test_a_step_over_the_bound_is_refused_before_the_first() -> None:
    """Grids count the outermost occupied node, the closed form |u| + c."""
    for method, speed in ((Macroscopic(1), math.sqrt(0.8)), (Kinetic(1, Uniform(8, 1.6)), 1.0)):
        scene = scene_with(np.full(4, 1.0))
        allowed = scene.cells.dx / speed
        assert simulate(scene, method, Fixed(0.999 * allowed, 3)).verdict.kind == "finished"
        with pytest.raises(kinsim.InputError, match=r"breaks the CFL bound \(28\).*take dt <="):
            simulate(scene, method, Fixed(1.001 * allowed, 3))


def test_a_refused_step_names_a_step_that_is_taken() -> None:
    with pytest.raises(kinsim.InputError) as refused:
        simulate(PARABOLA, Macroscopic(3), Fixed(1.0, 3))
    allowed = float(str(refused.value).split("dt <= ")[1].split(",")[0])
    assert simulate(PARABOLA, Macroscopic(3), Fixed(0.999 * allowed, 1)).verdict.kind == "finished"


@pytest.mark.parametrize("method", [Macroscopic(1), Kinetic(1, Uniform(64, 8.0))])
def test_a_bound_broken_on_the_way_stops_the_run(method: Macroscopic | Kinetic) -> None:
    """A layer that accelerates until |u| + c > dx/dt; the last state within the bound is kept."""
    scene, dt = sliding(), 0.02
    run = simulate(scene, method, Fixed(dt, 10_000), save_every=1000)
    assert run.verdict.kind == "cfl-broken"
    limit = scene.cells.dx / dt
    c = math.sqrt(2 * scene.beta * 0.5)
    reached = np.abs(run.u[-1]).max() + c
    cell = 0.0 if isinstance(method, Macroscopic) else 8.0 / 32
    assert limit - cell - dt <= reached <= limit + dt * math.sin(0.6)
    assert 0 < run.verdict.step == run.steps < 10_000
    assert run.t[-1] == pytest.approx(run.steps * dt, rel=1e-15)
    assert f"step {run.steps + 1}" in str(run.verdict)
    assert run.ledger.courant.max() <= 1 + 1e-12


def test_forced_runs_say_so() -> None:
    run = simulate(sliding(), Macroscopic(1), Fixed(0.02, 300), force=True)
    assert run.verdict.kind == "finished"
    assert "CFL bound was broken on demand" in str(run.verdict)
    assert run.ledger.courant.max() > 1
    good = simulate(sliding(), Macroscopic(1), Fixed(0.02, 3), force=True)
    assert "demand" not in str(good.verdict)


def test_a_run_that_turns_non_finite_keeps_its_last_good_state() -> None:
    """Forced far over the bound, heights explode; the verdict names step and cell."""
    scene = scene_with(np.array([1.0, 2.0, 0.5, 1.0, 3.0, 1.0]), delta=0.1)
    run = simulate(scene, Macroscopic(2), Fixed(5.0, 4000), force=True, save_every=10**6)
    assert run.verdict.kind == "non-finite"
    assert 0 <= run.verdict.cell < 6
    assert f"cell {run.verdict.cell}" in str(run.verdict)
    assert np.isfinite(run.h).all()
    assert np.isfinite(run.q).all()
    assert run.steps == run.verdict.step


def test_forced_into_a_blow_up_a_run_stops_and_says_why() -> None:
    """A twin that blows up cannot say how wide the window is to be; any one is outrun, and the run stops there."""
    scene = scene_with(np.array([1.0, 2.0, 0.5, 1.0, 3.0, 1.0]), delta=0.1)
    for velocity in (Uniform(32), Uniform(32, 5.0)):
        run = simulate(scene, Kinetic(2, velocity), Fixed(5.0, 4000), force=True)
        assert run.verdict.kind == "window-too-small"
        assert "the CFL bound was broken on demand" in str(run.verdict)
        assert np.isfinite(run.ledger.to_array()).all()


def test_a_window_that_is_too_small_stops_the_run() -> None:
    """The bound was given, and the mass outruns it; until then f has lost what one velocity cell leaks."""
    scene = sliding()
    run = simulate(scene, Kinetic(1, Uniform(256, 1.5)), Fixed(1e-2, 1000))
    assert run.verdict.kind == "window-too-small"
    assert np.abs(run.u[-1]).max() + math.sqrt(2 * scene.beta * 0.5) == pytest.approx(1.5, abs=1e-2 * math.sin(0.6))
    assert run.ledger.window_loss[-1] < 1e-3 * run.ledger.mass[0]
    assert "outside the window of 1.5" in str(run.verdict)
    advised = float(str(run.verdict).split("take a bound of ")[1].split(")")[0])
    assert simulate(scene, Kinetic(1, Uniform(256, advised)), Fixed(1e-2, run.steps + 2)).verdict.kind == "finished"


@pytest.mark.parametrize("name", ["silo", "sine"])
def test_an_automatic_window_is_wide_enough(name: str) -> None:
    """None takes 1.05 times the largest |u| + c + dt |g| of the closed-form twin.

    f loses nothing if a velocity cell is narrower than a twentieth of that, n > 42; else the linear remap can leak
    out of the outermost cell, and the ledger books it.
    """
    scene, _ = SCENES[name]
    twin = simulate(scene, Macroscopic(3), Fixed(1e-3, 1500), save_every=1)
    largest = float(np.max(np.abs(twin.u) + np.sqrt(2 * scene.beta * twin.h)))
    run = simulate(scene, Kinetic(3, Uniform(64)), Fixed(1e-3, 1500))
    assert run.verdict.kind == "finished"
    assert 1.05 * largest <= run.method.velocity.bound <= 1.2 * largest
    assert run.ledger.window_loss.max() == 0


def test_a_twin_that_blows_up_does_not_widen_the_window() -> None:
    """Scheme 2 on sine ends over the CFL bound; the kinetic run says so itself, in a window of this world."""
    scene, _ = SCENES["sine"]
    run = simulate(scene, Kinetic(2, Uniform(32)), Fixed(1e-3, 2000))
    assert run.verdict.kind in ("cfl-broken", "window-too-small")
    assert run.method.velocity.bound < 1.05 * scene.cells.dx / 1e-3 * 1.2
    assert run.steps > 500


@pytest.mark.parametrize("method", METHODS)
def test_an_interrupted_run_keeps_what_it_has(method: Macroscopic | Kinetic) -> None:
    def stop(share: float) -> None:
        if share > 0.3:
            raise KeyboardInterrupt

    run = simulate(PARABOLA, method, Fixed(1e-3, 200), save_every=1, progress=stop)
    assert run.verdict.kind == "interrupted"
    assert 60 <= run.steps <= 80
    whole = simulate(PARABOLA, method, Fixed(1e-3, 200), save_every=1)
    if isinstance(method, Macroscopic):
        np.testing.assert_array_equal(run.h, whole.h[: run.steps + 1])
    assert len(run.t) == run.steps + 1
    assert run.ledger.sizes["t"] == run.steps + 1


def test_rest_is_called_rest_after_100_still_steps() -> None:
    """max |q| <= 1e-12 over the last 100 steps; 99 are not enough."""
    still = scene_with(np.full(4, 0.5), delta=0.3)
    assert simulate(still, Macroscopic(3), Fixed(1e-3, 99)).verdict.kind == "finished"
    assert simulate(still, Macroscopic(3), Fixed(1e-3, 100)).verdict.kind == "at-rest"
    moving = scene_with(np.full(4, 0.5), np.full(4, 1e-11))
    assert simulate(moving, Macroscopic(3), Fixed(1e-3, 500)).verdict.kind == "finished"


def test_progress_rises_to_the_end() -> None:
    shares: list[float] = []
    simulate(PARABOLA, Macroscopic(3), Fixed(1e-3, 160), progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert shares[0] > 0


# ---- clocks ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_courant_clock_keeps_its_number_and_lands_on_the_end(method: Macroscopic | Kinetic) -> None:
    run = simulate(PARABOLA, method, Courant(0.8, end=0.7), save_every=1)
    assert run.t[-1] == 0.7
    assert run.ledger.courant.max() <= 0.8 * (1 + 1e-12)
    assert run.ledger.courant[1:-1].min() >= 0.8 * (1 - 1e-12)
    assert run.dt.sum() == pytest.approx(0.7, rel=1e-13)


def test_courant_clock_in_a_dry_scene_takes_one_step() -> None:
    """Nothing moves, nothing bounds the step."""
    run = simulate(scene_with(np.zeros(4)), Macroscopic(1), Courant(0.9, end=2.0))
    assert run.steps == 1
    assert run.t[-1] == 2.0


def test_courant_number_above_one_is_refused() -> None:
    with pytest.raises(kinsim.InputError, match="at most 1"):
        simulate(PARABOLA, Macroscopic(3), Courant(1.5, end=1.0))


# ---- requests that make no sense -------------------------------------------------------------------------------------


def test_bad_requests_are_refused() -> None:
    with pytest.raises(kinsim.InputError, match="save_every"):
        simulate(PARABOLA, Macroscopic(3), Fixed(1e-3, 3), save_every=0)
    with pytest.raises(kinsim.InputError, match="need a density"):
        simulate(PARABOLA, Macroscopic(3), Fixed(1e-3, 3), dumps=[Dump()])
    h = np.ones(80)
    for bad in ((h[:3], h), (h, h[:3]), (-h, h), (np.nan * h, h), (h, np.inf * h)):
        with pytest.raises(kinsim.InputError, match="step: h"):
            step(PARABOLA, Macroscopic(3), *bad, 1e-3)
    for dt in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(kinsim.InputError, match="step: dt"):
            step(PARABOLA, Macroscopic(3), h, h, dt)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ((PARABOLA, Macroscopic(3), 0.5), "simulate: clock is of type float; give a Fixed or Courant or Replay"),
        ((PARABOLA, 3, Fixed(1e-3, 3)), "simulate: method is of type int; give a Kinetic or Macroscopic"),
        ((PARABOLA, Macroscopic, Fixed(1e-3, 3)), "method is of type type"),
        (("parabola", Macroscopic(3), Fixed(1e-3, 3)), "simulate: scene is of type str; give a Scene"),
        ((PARABOLA, Macroscopic(3), Fixed(1e-3, 3), 2.5), "save_every = 2.5 is no whole number"),
        ((PARABOLA, Macroscopic(3), Fixed(1e-3, 3), True), "save_every = True is no whole number"),
    ],
)
def test_each_argument_is_what_it_should_be(given: tuple[Any, ...], line: str) -> None:
    with pytest.raises(kinsim.InputError, match=re.escape(line)):
        simulate(*given)


def test_step_leaves_its_arguments_alone() -> None:
    h, q = np.linspace(0.2, 1, 80), np.linspace(-0.1, 0.2, 80)
    kept = h.copy(), q.copy()
    now = step(PARABOLA, Kinetic(3, Uniform(16)), h, q, 1e-3)
    np.testing.assert_array_equal((h, q), kept)
    now.h1[:] = 0
    np.testing.assert_array_equal(h, kept[0])


# ---- densities -------------------------------------------------------------------------------------------------------


def test_dumped_densities_are_those_of_the_step() -> None:
    """M^n, f after transport, f after the force: at the first, every 10th, and the last step."""
    method = Kinetic(3, Uniform(16, 1.2))
    dumps = [Dump("M", "equilibrium", 10), Dump("g", "transport", 10), Dump("f", "force", 10)]
    run = simulate(PARABOLA, method, Fixed(1e-3, 25), save_every=1, dumps=dumps)
    for number, n in enumerate((1, 10, 20, 25)):
        one = step(PARABOLA, method, run.h[n - 1], run.q[n - 1], 1e-3)
        for name, expected in (("M", one.M), ("g", one.f_transport), ("f", one.f_force)):
            np.testing.assert_array_equal(run.dumps[name].values[number], expected)
    np.testing.assert_allclose(run.dumps["f"].t, [0.001, 0.01, 0.02, 0.025])
    np.testing.assert_allclose(run.dumps["M"].t, [0, 0.009, 0.019, 0.024], atol=1e-15)


def test_ledger_books_what_f_holds_beyond_the_state() -> None:
    """sampling_mass = sum f - sum h; zero to rounding for cell averages, not when sampled."""
    run = {
        name: simulate(PARABOLA, Kinetic(3, Uniform(64), name), Fixed(1e-3, 200), dumps=[Dump("f", "force", 100)])
        for name in ("cell-average", "sampled")
    }
    assert np.abs(run["cell-average"].ledger.sampling_mass).max() < 1e-13
    f = run["sampled"].dumps["f"]
    dxi = float(f.xi[1] - f.xi[0])
    dx = PARABOLA.cells.dx
    excess = float(f[-1].sum()) * dxi * dx - run["sampled"].h[-1].sum() * dx
    assert run["sampled"].ledger.sampling_mass[-1] == pytest.approx(excess, rel=1e-10)
    assert abs(excess) > 1e-5


# ---- reproducibility -------------------------------------------------------------------------------------------------

DIGEST = """
import hashlib, kinsim
from kinsim import *
scene = Scene(cells=Cells(-4, 4, 80), heap=Parabola(), chute=ConstantSlope(0.05),
              friction=Coulomb("pi/15"), epsilon=0.4)
for method in (Macroscopic(3), Kinetic(3, Uniform(16)), Kinetic(3, Uniform(16), "sampled", coupling="face")):
    run = simulate(scene, method, Fixed(1e-3, 500))
    print(hashlib.sha256(run.h.tobytes() + run.q.tobytes()).hexdigest())
"""
NAMES = "Scene, Cells, Parabola, ConstantSlope, Coulomb, Macroscopic, Kinetic, Uniform, simulate, Fixed"


def test_runs_repeat_bit_for_bit_also_in_another_process() -> None:
    """Two runs here, and one in each of two processes of their own, started together."""
    code = DIGEST.replace("import *", f"import {NAMES}")
    processes = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) for _ in range(2)]
    scene = replace(PARABOLA, chute=kinsim.ConstantSlope(0.05))
    here = []
    for _ in range(2):
        digests = []
        for method in (Macroscopic(3), Kinetic(3, Uniform(16)), Kinetic(3, Uniform(16), "sampled", coupling="face")):
            run = simulate(scene, method, Fixed(1e-3, 500))
            digests.append(hashlib.sha256(run.h.tobytes() + run.q.tobytes()).hexdigest())
        here.append(digests)
    there = [process.communicate(timeout=100)[0].split() for process in processes]
    assert here[0] == here[1] == there[0] == there[1]
