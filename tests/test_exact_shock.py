"""The travelling shock, by its jump conditions, and by the Riemann solution that it is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_riemann import flux

from kinsim import Cells, InputError
from kinsim.exact import AcceleratedRiemann, Riemann, TravellingShock

BETA = 0.4
EPS = float(np.finfo(float).eps)

SHOCKS = {
    "into the right, slower": TravellingShock(1.0, 1.4, 0.5, BETA, 0.1, 0.3, 0.2),
    "into the right, faster": TravellingShock(2.0, 1.4, 0.5, BETA, 0.5, 0.2),
    "into the left": TravellingShock(0.5, 1.9, 1.0, BETA, 0.1, 0.2, -0.3),
    "stands, then runs downhill": TravellingShock(0.5, 1.8, 1.0, BETA, 0.5, 0.2),
    "to the left": TravellingShock(1.0, -0.4, 0.2, BETA, 0.1, 0.2),
    "both ways, no friction": TravellingShock(1.0, 0.1, 0.4, BETA, -0.3, 0.0),
    "strong": TravellingShock(10.0, 40.0, 0.02, BETA, 0.3, 0.4),
}


@pytest.fixture(params=SHOCKS)
def shock(request: pytest.FixtureRequest) -> TravellingShock:
    return SHOCKS[request.param]


def late(shock: TravellingShock) -> float:
    return min(0.9 * shock.until, 1.3)


def test_rankine_hugoniot_and_lax(shock: TravellingShock) -> None:
    """With states read from both sides at the time t, and the speed as the derivative of the place."""
    t = late(shock)
    (h1, u1), (h2, u2) = (map(float, shock(shock.place(t) + side, t)) for side in (-1e-9, 1e-9))
    speed = (shock.place(t + 0.25) - shock.place(t - 0.25)) / 0.5  # exact for a parabola
    size = (1 + max(h1, h2)) * (1 + abs(u1) + abs(u2) + abs(speed)) ** 2
    jump = np.array([h2 - h1, h2 * u2 - h1 * u1])
    np.testing.assert_allclose(speed * jump, flux(h2, u2) - flux(h1, u1), atol=16 * EPS * size)
    sign = 1 if h1 > h2 else -1
    assert u1 + sign * math.sqrt(BETA * h1) > speed > u2 + sign * math.sqrt(BETA * h2)


def test_layers_slide_under_friction(shock: TravellingShock) -> None:
    """Beside the shock u' = s - sgn(u) R."""
    times = np.linspace(0, late(shock), 5)
    for x in (-80.0, 120.0):
        u = np.array([float(shock(x, t)[1]) for t in times])
        sign = np.sign(u[1:-1]) if shock.resistance else 0.0
        np.testing.assert_allclose(
            (u[2:] - u[:-2]) / (times[2:] - times[:-2]), shock.pull - sign * shock.resistance, rtol=0, atol=1e-13
        )


def test_box_balance(shock: TravellingShock) -> None:
    """Mass and momentum in a box against flux through its ends and source, integrated by hand."""
    t, m, box = late(shock), shock.m, Cells(-90, 110, 640)
    (h, q), (h0, q0) = shock.averages(box, t), shock.averages(box, 0.0)
    entered, pushed, mass_in = 0.0, 0.0, 0.0
    for h_side, u_side, sign in ((shock.h_left, shock.u_left, 1), (shock.h_right, shock.u_right, -1)):
        entered += sign * h_side * (u_side * t + m * t**2 / 2)
        mass_in += sign * h_side * (u_side * t**2 / 2 + m * t**3 / 6)
        pushed += sign * (flux(h_side, u_side)[1] * t + h_side * (u_side * m * t**2 + m**2 * t**3 / 3))
    rounding = 64 * EPS * (1 + h.sum() + np.abs(q).sum() + np.abs(q0).sum()) * box.dx
    assert np.sum(h - h0) * box.dx == pytest.approx(entered, abs=rounding)
    assert np.sum(q - q0) * box.dx == pytest.approx(pushed + m * (h0.sum() * box.dx * t + mass_in), abs=rounding)


def test_is_the_riemann_solution_of_its_layers(shock: TravellingShock) -> None:
    """Found by other means: a root instead of a formula; the other wave has no strength."""
    flat = Riemann(shock.h_left, shock.u_left, shock.h_right, shock.u_right, BETA, shock.x0)
    riemann = AcceleratedRiemann(flat, shock.pull, shock.resistance)
    t, x = late(shock), np.linspace(-3.01, 4.03, 97)
    for found, expected in zip(shock(x, t), riemann(x, t), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert shock.until == pytest.approx(riemann.until, rel=1e-12)


def test_mirror_image(shock: TravellingShock) -> None:
    mirrored = TravellingShock(
        shock.h_right, -shock.u_right, shock.h_left, BETA, -shock.pull, shock.resistance, -shock.x0
    )
    t, x = late(shock), np.linspace(-3, 4, 97) + 1e-3
    assert mirrored.until == pytest.approx(shock.until, rel=1e-12)
    (h, u), (h_mirrored, u_mirrored) = shock(x, t), mirrored(-x, t)
    np.testing.assert_array_equal(h, h_mirrored)
    np.testing.assert_allclose(u, -u_mirrored, rtol=1e-13, atol=1e-13)


def test_valid_until_a_layer_comes_to_rest() -> None:
    """The slower layer, here the right one, stops first."""
    shock = SHOCKS["into the right, slower"]
    assert shock.until == pytest.approx(shock.u_right / 0.2, rel=4 * EPS)
    assert shock(50.0, shock.until)[1] == pytest.approx(0.0, abs=4 * EPS)
    for ask in (lambda t: shock(0.0, t), lambda t: shock.averages(Cells(-1, 1, 4), t)):
        with pytest.raises(InputError, match="come to rest"):
            ask(shock.until + 1e-9)
    assert SHOCKS["into the right, faster"].until == math.inf


def test_questions_and_data_outside() -> None:
    shock = SHOCKS["strong"]
    for t in (-1e-9, math.nan, math.inf):
        with pytest.raises(InputError, match="0 <= t"):
            shock(0.0, t)
    with pytest.raises(InputError, match="not a number"):
        shock(math.nan, 0.5)
    with pytest.raises(InputError, match="h_right"):
        TravellingShock(1.0, 0.3, 0.0, BETA)
    with pytest.raises(InputError, match="h_left = h_right = 1 leaves no shock"):
        TravellingShock(1, 1.2, 1, 0.4)
    with pytest.raises(InputError, match="cells is of type list"):
        shock.averages([0.0, 1.0], 0.1)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="both signs"):
        TravellingShock(1.0, 0.1, 0.4, BETA, 0.3, 0.1)
