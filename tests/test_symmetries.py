"""Symmetries of the equations that the steps keep: units, whole cells, and frames that move, to their order."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from states import random_states

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fitted,
    Frictionless,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    simulate,
    step,
)

CLOSED = {
    "1": Macroscopic(1),
    "3, face": Macroscopic(3, "face"),
    "4": Macroscopic(4),
    "4, second": Macroscopic(4, order=2),
    "4, reflecting": Macroscopic(4, statics="reflect"),
}
EVERY = CLOSED | {"grid": Kinetic(4, Uniform(32, 4.0)), "fitted": Kinetic(4, Fitted(4))}


def scene(h: np.ndarray, dx: float, epsilon: float, boundary: str = "wall", delta: float = 0.3) -> Scene:
    """On a chute of 0.2."""
    friction = Coulomb(delta) if delta else Frictionless()
    chute = ConstantSlope(0.2 if delta else 0.0)
    return Scene(Cells(0.0, dx * h.size, h.size), Profile(h), chute, friction, boundary, epsilon)


@pytest.mark.parametrize("name", EVERY)
@given(power=st.integers(-60, 60), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_the_unit_of_height_is_free(name: str, power: int, seed: int) -> None:
    """h to s h with beta to beta/s, s a power of two: to the bit, as no threshold has a unit."""
    method, s = EVERY[name], 2.0**power
    h, u = random_states(np.random.default_rng(seed), 24, decades=2)
    one = step(scene(h, 0.05, 0.5), method, h, h * u, 0.004)
    other = step(scene(s * h, 0.05, 0.5 / s), method, s * h, s * h * u, 0.004)
    np.testing.assert_array_equal(other.h1, s * one.h1)
    np.testing.assert_array_equal(other.q1, s * one.q1)


@pytest.mark.parametrize("name", EVERY)
@given(power=st.integers(-30, 30), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_the_unit_of_length_is_free(name: str, power: int, seed: int) -> None:
    """x to s x, h to s h, t to sqrt(s) t, u to sqrt(s) u, s a power of four: to the bit."""
    method, root = EVERY[name], 2.0**power
    s = root * root
    if isinstance(method, Kinetic) and isinstance(method.velocity, Uniform):
        wide = replace(method, velocity=Uniform(32, 4.0 * root))
    else:
        wide = method
    h, u = random_states(np.random.default_rng(seed), 24, decades=2)
    one = step(scene(h, 0.05, 0.5), method, h, h * u, 0.004)
    other = step(scene(s * h, 0.05 * s, 0.5), wide, s * h, s * root * h * u, 0.004 * root)
    np.testing.assert_array_equal(other.h1, s * one.h1)
    np.testing.assert_array_equal(other.q1, s * root * one.q1)


@pytest.mark.parametrize("name", EVERY)
@given(cells=st.integers(1, 23), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_where_the_ring_begins_is_free(name: str, cells: int, seed: int) -> None:
    """A shift by whole cells, to the bit."""
    h, u = random_states(np.random.default_rng(seed), 24, decades=2)
    one = step(scene(h, 0.05, 0.5, "periodic"), EVERY[name], h, h * u, 0.004)
    g, v = np.roll(h, cells), np.roll(u, cells)
    other = step(scene(g, 0.05, 0.5, "periodic"), EVERY[name], g, g * v, 0.004)
    np.testing.assert_array_equal(other.h1, np.roll(one.h1, cells))
    np.testing.assert_array_equal(other.q1, np.roll(one.q1, cells))


@pytest.mark.parametrize(
    ("method", "order"),
    [(Macroscopic(1), 0.8), (Macroscopic(4), 0.8), (Macroscopic(4, order=2), 1.8), (Kinetic(4, Fitted(6)), 0.8)],
)
def test_a_moving_frame_shows_the_same_wave(method: Macroscopic | Kinetic, order: float) -> None:
    """u to u + V without friction, after V t = 1, once round the ring: the same but for the error of the scheme."""
    apart = []
    for count in (50, 100, 200):
        y = 2 * math.pi * (np.arange(count) + 0.5) / count
        h = 1.0 + 0.2 * np.sin(y)
        ring = scene(h, 1.0 / count, 0.4, "periodic", delta=0.0)
        number = 0.45 if method.order == 2 else 0.9
        still, moving = (
            simulate(replace(ring, heap=Profile(h, np.full(count, V))), method, Courant(number, 0.5), 10**6).h[-1]
            for V in (0.0, 2.0)
        )
        apart.append(float(np.abs(still - moving).mean()))
    assert math.log2(apart[1] / apart[2]) >= order
    assert apart[2] < 0.02
