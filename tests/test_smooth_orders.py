"""Smooth chutes against solutions of (13): a steady stream on an arc, and a manufactured solution."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import sympy

import kinsim
from kinsim import (
    Arc,
    Cells,
    Coulomb,
    Courant,
    Fitted,
    Inflow,
    InputError,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    SlopeFormula,
    SmoothChute,
)  # fmt: skip
from kinsim.exact import SteadyStream

DELTA, EPSILON, ETA = 0.4, 0.4, 0.7

METHODS = {
    1: {"hold": Macroscopic(), "reflect": Macroscopic(statics="reflect"), "fitted": Kinetic(velocity=Fitted(6))},
    2: {"mc": Macroscopic(order=2, limiter="mc"), "between": Macroscopic(order=2)},
}
LEAST = {1: 0.95, 2: 1.8}
CASES = [(order, name) for order, methods in METHODS.items() for name in methods]


CHUTE = SmoothChute(Arc(6.0, 0.45, 2.0), ETA)


@cache
def stream_on_an_arc() -> SteadyStream:
    """It enters with u = 2 and h = 0.3."""
    return SteadyStream(CHUTE, Coulomb(DELTA), EPSILON, 0.6, 2.0, 0.0, 4.0)


def test_steady_stream_solves_its_equations() -> None:
    """By differences of the flux, and of the sides of a hill where it is as fast as its waves."""
    x, step = np.linspace(0.3, 3.7, 60), 1e-4

    def flux(x: np.ndarray) -> np.ndarray:
        h, u = stream_on_an_arc()(x)
        return h * u * u + 0.5 * EPSILON * np.cos(CHUTE.zeta(x)[0]) * h * h

    h, u = stream_on_an_arc()(x)
    zeta, rise = CHUTE.zeta(x)
    g = np.sin(zeta) - math.tan(DELTA) * (np.cos(zeta) - ETA * rise * u * u)
    np.testing.assert_allclose((flux(x + step) - flux(x - step)) / (2.0 * step), g * h, atol=1e-7)
    np.testing.assert_allclose(h * u, 0.6, rtol=1e-14)
    slowed = SteadyStream(SmoothChute(Arc(4.0, 0.0)), Coulomb(0.6), EPSILON, 0.6, 1.0, 0.0, 4.0)
    with pytest.raises(InputError, match="faster than its waves"):
        slowed(np.array([3.9]))


@pytest.mark.parametrize(("order", "name"), CASES)
def test_steady_stream_on_an_arc(order: int, name: str) -> None:
    errors = []
    for n in (32, 64, 128):
        cells = Cells(0.0, 4.0, n)
        h, u = stream_on_an_arc()(cells.x)
        scene = Scene(cells, Profile(h, u), CHUTE, Coulomb(DELTA), (Inflow(0.3, 2.0), "open"), EPSILON)
        run = kinsim.simulate(scene, METHODS[order][name], Courant(0.45, 8.0))
        inner = slice(n // 8, -n // 8)  # the ghosts of the ends know the stream to first order only
        errors.append(np.abs(run.u[-1] - u)[inner].mean())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] >= LEAST[order], (errors, orders)
    assert orders[-1] <= order + 0.6


@cache
def manufactured() -> tuple[object, object, object, object]:
    """h, u and what (13) lacks for them, as functions of x and t; sympy writes them."""
    x, t = sympy.symbols("x t")
    zeta = sympy.Float(0.1) + sympy.Rational(7, 20) * sympy.sin(x)
    h = 1 + sympy.Rational(3, 10) * sympy.sin(x - t)
    u = sympy.Rational(9, 10) + sympy.cos(x - 2 * t) / 5
    beta = EPSILON * sympy.cos(zeta)
    g = sympy.sin(zeta) - math.tan(DELTA) * (sympy.cos(zeta) - ETA * sympy.diff(zeta, x) * u**2)
    mass = sympy.diff(h, t) + sympy.diff(h * u, x)
    momentum = sympy.diff(h * u, t) + sympy.diff(h * u**2 + beta * h**2 / 2, x) - g * h
    return tuple(sympy.lambdify((x, t), term, "numpy") for term in (h, u, mass, momentum))


@pytest.mark.parametrize(("order", "name"), CASES)
def test_manufactured_solution(order: int, name: str) -> None:
    """What is lacking is added in halves before and after each step, which is of second order in dt."""
    h_of, u_of, mass, momentum = manufactured()
    errors = []
    for n in (40, 80, 160):
        cells = Cells(0.0, 2.0 * math.pi, n)
        x = cells.x
        h, q = h_of(x, 0.0), h_of(x, 0.0) * u_of(x, 0.0)
        chute = SmoothChute(SlopeFormula("0.1 + 0.35*sin(x)", 0.5), ETA)
        scene = Scene(cells, Profile(h), chute, Coulomb(DELTA), "periodic", EPSILON)
        dt = 0.16 * cells.dx
        steps = round(0.5 / dt)
        dt = 0.5 / steps
        for step in range(steps):
            t = step * dt
            done = kinsim.step(
                scene, METHODS[order][name], h + 0.5 * dt * mass(x, t), q + 0.5 * dt * momentum(x, t), dt
            )
            h, q = done.h1 + 0.5 * dt * mass(x, t + dt), done.q1 + 0.5 * dt * momentum(x, t + dt)
        exact = h_of(x, 0.5)
        errors.append(np.abs(h - exact).mean() + np.abs(q - exact * u_of(x, 0.5)).mean())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] >= LEAST[order], (errors, orders)
    assert orders[-1] <= order + 0.6
