"""The kinetic entropy of a step: its parts by quadrature, the inequality where it is proved, the work of the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest
from repaired import EPS, wild
from scipy.integrate import quad
from states import BETA, random_states, scene_with

from kinsim import Macroscopic, step
from kinsim.errors import InputError
from kinsim.measure.entropy import Entropy, entropy, entropy_flux, of_state

STATES = [(0.7, 0.0), (0.7, 0.3), (0.7, -0.3), (0.02, 0.9), (0.02, -0.9), (1.0, -0.89), (1e-6, 1e-4), (0.0, 0.0)]
SINGLE = pytest.mark.parametrize("method", [Macroscopic(1), Macroscopic(4)], ids=["scheme 1", "scheme 4"])


def density(xi: float, h: float, u: float) -> float:
    """H(M, xi), written down anew from (12)."""
    M = math.sqrt(max(2 * BETA * h - (xi - u) ** 2, 0.0)) / (math.pi * BETA)
    return 0.5 * xi**2 * M + math.pi**2 * BETA**2 / 6 * M**3


def integral(of, h: float, u: float, positive: bool) -> float:
    c = math.sqrt(2 * BETA * h)
    low, high = (max(u - c, 0.0), max(u + c, 0.0)) if positive else (u - c, u + c)
    return quad(of, low, high, epsabs=0.0, epsrel=1e-11, limit=200)[0] if low < high else 0.0


@pytest.mark.parametrize(("h", "u"), STATES)
def test_flux_and_height_are_integrals(h: float, u: float) -> None:
    """int over xi > 0 of xi H, and int H = h u^2/2 + beta h^2/2."""
    flux = integral(lambda xi: xi * density(xi, h, u), h, u, True)
    scale = h * (abs(u) + math.sqrt(2 * BETA * h)) ** 3
    assert entropy_flux(np.array([h]), np.array([u]), BETA)[0] == pytest.approx(flux, abs=1e-10 * scale)
    whole = integral(lambda xi: density(xi, h, u), h, u, False)
    assert of_state(np.array([h]), np.array([h * u]), BETA)[0] == pytest.approx(whole, rel=1e-9, abs=1e-16)


def test_the_two_halves_make_the_whole_flux(rng: np.random.Generator) -> None:
    """int xi H(M) = u (h u^2/2 + beta h^2)."""
    h, u = random_states(rng, 200)
    whole = entropy_flux(h, u, BETA) - entropy_flux(h, -u, BETA)
    np.testing.assert_allclose(whole, u * (0.5 * h * u * u + BETA * h * h), atol=1e-12)


def taken(method: Macroscopic, seed: int, number: float, states=wild, zeta: float = 0.3) -> tuple[Entropy, float]:
    """The entropy of a step of a random state at a Courant number, and what rounding may make of it."""
    h, u = states(np.random.default_rng(seed))
    scene = scene_with(h, u, zeta=zeta, delta=0.3, boundary="wall" if seed % 2 else "periodic")
    speed = float(np.max(np.abs(u) + np.sqrt(2 * scene.beta * h)))
    found = entropy(scene, step(scene, method, h, h * u, number * scene.cells.dx / speed))
    return found, 64 * EPS * float((h * speed**2).max())


@SINGLE
@pytest.mark.parametrize("seed", range(12))
def test_transport_makes_no_entropy_where_nothing_is_held(method: Macroscopic, seed: int) -> None:
    """Courant number 1 exactly, dry cells, films of 1e-300 and 1e-12."""
    for states in (wild, lambda rng: random_states(rng, 60)):
        found, rounding = taken(method, seed, 1.0, states, zeta=(-0.6, 0.0, 0.3)[seed % 3])
        assert found.free.any()
        assert found.production[found.free].max() <= rounding


@SINGLE
def test_broken_on_purpose_it_makes_entropy(method: Macroscopic, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the Courant number 1, and with a flux of entropy that lacks its cubic part."""

    def worst(number: float) -> float:
        found = [taken(method, seed, number, lambda rng: random_states(rng, 60)) for seed in range(10)]
        return max(float(each.production[each.free].max() / rounding) for each, rounding in found)

    assert worst(1.0) <= 1.0
    assert worst(2.0) > 1e3
    monkeypatch.setattr("kinsim.measure.entropy.entropy_flux", lambda h, u, beta: 0.9 * entropy_flux(h, u, beta))
    assert worst(1.0) > 1e3


@SINGLE
def test_on_a_ring_production_is_what_is_lost(method: Macroscopic, rng: np.random.Generator) -> None:
    """Summed over a ring, nothing flows out: after - before = production + work."""
    h, u = random_states(rng, 60)
    scene = scene_with(h, u, zeta=0.2, delta=0.3)
    found = entropy(scene, step(scene, method, h, h * u, 0.01))
    assert math.fsum(found.outflow) == pytest.approx(0, abs=1e-14)
    made = math.fsum(found.production) + math.fsum(found.gravity) + math.fsum(found.friction)
    assert math.fsum(found.after) - math.fsum(found.before) == pytest.approx(made, abs=1e-13)


@pytest.mark.parametrize("zeta", [-0.5, -0.2, 0.0, 0.2, 0.5])
def test_work_of_the_ground(zeta: float, rng: np.random.Generator) -> None:
    """Together J (qhat + q)/(2 h); where it slides, friction takes R per mass and way; where it stops, all there is."""
    h, u = random_states(rng, 80)
    dt, scene = 0.01, scene_with(h, u, zeta=zeta, delta=0.3)
    now = step(scene, Macroscopic(4), h, h * u, dt)
    found = entropy(scene, now)
    wet = now.h1 > 0
    mean = 0.5 * (now.qhat + now.q1)
    np.testing.assert_allclose((found.gravity + found.friction)[wet], (now.impulse * mean / now.h1)[wet], atol=1e-14)
    sliding = wet & (now.qhat * now.q1 > 0) & found.free
    assert sliding.sum() > 20
    np.testing.assert_allclose(found.friction[sliding], -dt * scene.resistance * np.abs(mean[sliding]), atol=1e-14)
    # where gravity stops or turns a cell within the step, what holds it there is booked for the way before, too
    turned = found.free & (now.qhat * now.q1 <= 0)
    assert found.friction[found.free & ~turned].max() <= 1e-15
    assert (found.friction[turned] <= 0.5 * dt * scene.resistance * np.abs(now.qhat[turned])).all()


@pytest.mark.parametrize(
    "method", [Macroscopic(2), Macroscopic(3), Macroscopic(4, order=2), Macroscopic(4, statics="reflect")]
)
def test_steps_without_faces_of_their_own_are_refused(method: Macroscopic) -> None:
    h = np.ones(8)
    scene = scene_with(h, delta=0.3)
    with pytest.raises(InputError, match="single flux per face"):
        entropy(scene, step(scene, method, h, 0 * h, 0.01))
