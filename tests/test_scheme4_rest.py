"""Scheme 4 at rest: bit for bit, disturbed, too steep; starting and stopping."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import SCENES
from covering import covering
from hypothesis import given, settings
from hypothesis import strategies as st
from repaired import (
    CLOSED,
    DELTA,
    IN_CLOSED_FORM,
    LEANING,
    LEANING_ANY,
    METHODS,
    VARIANTS,
    WINGS,
    leaning,
    of_methods,
    on_piles,
    pile,
    steps,
)
from states import scene_with

from kinsim import Courant, Kinetic, Macroscopic, Profile, Scene, simulate, step
from kinsim.clock import Replay

EVERY_LEANING = pytest.mark.parametrize(
    ("method", "zeta", "boundary", "seed"), of_methods(on_piles(LEANING, WINGS, VARIANTS))
)


def keeps(scene: Scene, method: Macroscopic | Kinetic, count: int) -> bool:
    """Whether the scene is bitwise as it was, whenever one looks."""
    run = simulate(scene, method, steps(scene, method, count), 100)
    return bool((run.h == scene.initial()[0]).all() and (run.q == 0).all())


@pytest.mark.parametrize(
    ("method", "zeta", "boundary", "seed"), of_methods(on_piles(LEANING_ANY, ["closed"], VARIANTS))
)
def test_rest_is_bitwise(method: Macroscopic, zeta: float, boundary: str, seed: int) -> None:
    """Random piles that take 100 percent of what friction can hold, 2000 steps."""
    assert keeps(pile(zeta, boundary, seed), method, 2000)


@EVERY_LEANING
def test_rest_is_bitwise_in_both_wings(method: Macroscopic | Kinetic, zeta: float, boundary: str, seed: int) -> None:
    """The same with densities of 32 nodes."""
    assert keeps(pile(zeta, boundary, seed), method, 200)


@pytest.mark.parametrize(
    ("name", "zeta", "boundary", "seed"),
    on_piles(LEANING, ["closed, first", "closed, second", "matched, first", "fitted, second, mc"]),
)
def test_a_disturbed_pile_stops_again_and_stays(name: str, zeta: float, boundary: str, seed: int) -> None:
    """Noise of 1e-8 in h and u. Above the friction angle a film that spilled onto bare ground (< 1e-12) runs on.

    At zeta = delta nothing slows down what runs downhill, so that its roundings may go on. Cell averages on a grid stop
    below the friction angle only: their second moment errs by n^-2.
    """
    method = METHODS[name]
    scene = pile(zeta, boundary, seed)
    h, _ = scene.initial()
    rng = np.random.default_rng(seed)
    shaken = h * (1 + 1e-8 * rng.standard_normal(h.size))
    heap = Profile(shaken, 1e-8 * rng.standard_normal(h.size) * (h > 0))
    run = simulate(replace(scene, heap=heap), method, steps(scene, method, 2000), 1000)
    film = (h == 0) & (run.h[-1] < 1e-12) & (abs(zeta) > DELTA)
    assert np.abs(run.q[-1][~film]).max() <= (1e-15 if abs(zeta) == DELTA else 0.0)
    assert np.abs(run.h[-1] - run.h[-2]).max() <= (1e-12 if film.any() or abs(zeta) == DELTA else 0.0)
    assert np.abs(run.h[-1] - h).max() <= 1e-6


@pytest.mark.parametrize(
    ("name", "lowest", "zeta"),
    covering(["closed, first", "closed, second", "fitted, first"], [0.0, 0.05, 1.0], [0.8, 1.0, -1.0, 1.2]),
)
def test_a_pile_that_leans_on_a_steep_chute_stops_again_and_stays(name: str, lowest: float, zeta: float) -> None:
    """A third of the faces and then all are at the bound where the pile would begin to move downhill.

    At the bound nothing slows down what moves; there, and at toes lower than a jump, the noise decays little by little.
    """
    for share in (0.3, 1.0):
        scene = leaning(zeta, lowest, share, seed=3)
        h, _ = scene.initial()
        rng = np.random.default_rng(3)
        shaken = Profile(h * (1 + 1e-8 * rng.standard_normal(h.size)), 1e-8 * rng.standard_normal(h.size) * (h > 0))
        run = simulate(replace(scene, heap=shaken), METHODS[name], steps(scene, METHODS[name], 2000, 0.01), 1000)
        film = (h == 0) & (run.h[-1] < 1e-12)
        assert np.abs(run.q[-1][~film]).max() <= (0.0 if share < 1.0 and lowest == 1.0 else 1e-8)
        assert np.abs(run.h[-1] - h).max() <= 1e-6


@pytest.mark.parametrize("ratio", [1.1, 2.0, 3.0, 5.0, 30.0])
@given(heights=st.lists(st.floats(1e-3, 20.0), min_size=2, max_size=2), creep=st.floats(1e-9, 1e-3))
@settings(max_examples=50, deadline=None)
def test_what_creeps_downhill_moves_mass_downhill(ratio: float, heights: list[float], creep: float) -> None:
    """Between cells whose jump is the one that would just move, for sin zeta up to 30 R: they lean, and compress."""
    low, more = sorted(heights)
    zeta = 1.2
    delta = math.atan(math.tan(zeta) / ratio)
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(delta), 0.4 * math.cos(zeta)
    scene = scene_with([low, more], zeta=zeta, delta=delta, boundary="wall", dx=(more - low) * beta / (s - R) or 1.0)
    u = np.array([0.0 if creep < 1e-5 else creep, creep])
    now = step(scene, Macroscopic(), np.array([low, more]), np.array([low, more]) * u, 1e-9)
    assert now.flux[0, 1] > 0.0


@EVERY_LEANING
def test_one_face_five_percent_too_steep_starts(method, zeta: float, boundary: str, seed: int) -> None:
    """Wherever it is."""
    scene = pile(zeta, boundary, seed)
    h, _ = scene.initial()
    s, R, beta, dx = scene.chute.sin, scene.resistance, scene.beta, scene.cells.dx
    for face in (5, 20, 33):
        steep = h.copy()
        steep[face + 1 :] += (s + 1.05 * R) * dx / beta - (h[face + 1] - h[face])
        steep -= min(steep.min(), 0.0)
        tilted = replace(scene, heap=Profile(steep))
        run = simulate(tilted, method, steps(tilted, method, 8), 8)
        assert (run.h[-1] != steep).any()


@pytest.mark.parametrize(("method", "ground"), of_methods(covering(WINGS, VARIANTS, [(0.15, 0.0), (-0.28, 0.2)])))
def test_closed_masses_stop(method: Macroscopic | Kinetic, ground: tuple[float, float]) -> None:
    """Below the friction angle, wet and dry: u is exactly 0 at the end, and stays."""
    zeta, film = ground
    x = (np.arange(48) + 0.5) / 48
    h = np.where(np.abs(x - 0.5) < 0.15, 1.0, film)
    scene = scene_with(h, 0.5 * (h > 0.5), zeta=zeta, delta=DELTA, boundary="wall")
    run = simulate(scene, method, Courant(0.9, 60.0), 10)
    at = np.flatnonzero((run.q != 0).any(axis=1))
    assert at.max() < len(run.t) - 3
    assert run.mass_drift == pytest.approx(0, abs=1e-14)


@IN_CLOSED_FORM
@pytest.mark.parametrize("number", [None, 0.9])
def test_a_strong_wave_has_no_ripples(method: Macroscopic, number: float | None) -> None:
    """`riemann`: total variation of h less that of the exact solution, 0.5: at most 1e-3, in order 2 2e-3, mc 1e-2."""
    scene, paper = SCENES["riemann"]
    end = simulate(scene, method, paper if number is None else Courant(number, 5.0), 10**6).h[-1]
    assert np.abs(np.diff(end)).sum() - 0.5 <= (1e-2 if method.limiter == "mc" else 1e-3 * method.order)


@IN_CLOSED_FORM
def test_moving_masses_do_not_chatter(method: Macroscopic) -> None:
    """A disturbance of 1e-13 in `sine` stays below 1e-11."""
    scene, _ = SCENES["sine"]
    h, _ = scene.initial()
    run = simulate(scene, method, Courant(0.9, 4.0), 10**6)
    nudge = 1e-13 * np.random.default_rng(0).standard_normal(h.size)
    nudged = replace(scene, heap=Profile(h * (1 + nudge)))
    again = simulate(nudged, method, Replay(tuple(run.dt.tolist()), end=float(run.t[-1])), 10**6, force=True)
    assert np.abs(run.h[-1] - again.h[-1]).max() <= 1e-11


@pytest.mark.parametrize("name", CLOSED)
def test_odd_even_piles_decay(name: str) -> None:
    """A zigzag steeper than friction holds is no rest, unlike under (22): it starts, decays and stops."""
    h = 1.0 + 0.1 * (-1.0) ** np.arange(40)
    scene = scene_with(h, delta=DELTA, boundary="periodic")
    run = simulate(scene, CLOSED[name], Courant(0.9, 20.0), 10**6)
    steepest = np.abs(np.diff(run.h[-1])).max() / scene.cells.dx * scene.beta
    assert (run.q[-1] == 0).all()
    assert steepest <= scene.resistance * (1 + 1e-3)
    assert math.fsum(run.h[-1]) == pytest.approx(40.0, rel=1e-14)
