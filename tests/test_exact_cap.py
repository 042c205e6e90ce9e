"""The parabolic cap of Savage and Hutter (1989), by its residual, its books and its rear."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from residual import residual

from kinsim import Cells, InputError
from kinsim.exact import ParabolicCap

BETA = 0.4
EPS = float(np.finfo(float).eps)

CAPS = {
    "speeds up": ParabolicCap(1.0, 1.5, BETA, 0.5, 0.2, 1.2, 0.3),
    "from rest, steep": ParabolicCap(0.5, 2.0, BETA, 0.6, 0.3),
    "slows down": ParabolicCap(1.0, 0.7, BETA, 0.1, 0.3, 2.5),
    "coasts": ParabolicCap(1.0, 0.7, BETA, 0.2, 0.2, 1.1),
    "coasts and outruns its spread": ParabolicCap(1.0, 0.7, BETA, 0.2, 0.2, 1.4),
    "rear stops, then would go on": ParabolicCap(2.0, 1.0, BETA, 0.5, 0.3, 0.8),
    "to the left": ParabolicCap(1.0, 1.5, BETA, 0.1, 0.3, -2.0),
    "spreads without friction": ParabolicCap(3.0, 0.5, BETA, 0.0, 0.0),
    "falls without friction": ParabolicCap(3.0, 0.5, BETA, -0.4, 0.0, 0.6),
}


@pytest.fixture(params=CAPS)
def cap(request: pytest.FixtureRequest) -> ParabolicCap:
    return CAPS[request.param]


def late(cap: ParabolicCap) -> float:
    return min(0.9 * cap.until, 2.3)


def half_length(cap: ParabolicCap, t: Any) -> Any:
    """G by the closed form t(G) of the paper, another parametrisation than the one under test, in 40 digits."""
    rate, length = 2 * mp.sqrt(mp.mpf(BETA) * cap.h0), mp.mpf(cap.length)

    def late_by(s: Any) -> Any:
        return length / rate * (mp.sqrt(s * (s - 1)) + mp.log(mp.sqrt(s) + mp.sqrt(s - 1))) - t

    return length * mp.findroot(late_by, (1 + mp.mpf("1e-30"), 2 + rate * t / length), solver="anderson", tol=1e-60)


def test_half_length_solves_its_equation(cap: ParabolicCap) -> None:
    """G'' = 2 beta h0 L/G^2 in 40 digits, and the code agrees on G and G'."""
    for t in np.array([0.1, 0.5, 1.0]) * late(cap):
        with mp.workdps(40):
            G, slope, bend = (mp.diff(lambda t: half_length(cap, t), mp.mpf(t), n) for n in range(3))
            assert abs(bend - 2 * mp.mpf(BETA) * cap.h0 * cap.length / G**2) < 1e-15  # a second difference, 40 digits
        _, found, spreading = cap.shape(t)
        assert found == pytest.approx(float(G), rel=8 * EPS)
        assert spreading == pytest.approx(float(slope), rel=1e-14)


def test_cap_solves_the_equations(cap: ParabolicCap) -> None:
    """Residual in 40 digits; the code is this formula.

    G is the Taylor polynomial of the ODE about t, to the order that first derivatives of u = ... G' need.
    """
    t = late(cap)
    middle, half, _ = cap.shape(t)
    with mp.workdps(40):
        G0 = half_length(cap, mp.mpf(t))
        G1 = 2 * mp.sqrt(mp.mpf(BETA) * cap.h0 * (1 - cap.length / G0))
        G2 = 2 * mp.mpf(BETA) * cap.h0 * cap.length / G0**2
        t0 = mp.mpf(t)
    for y in (-0.9, -0.3, 0.0, 0.6):
        x = middle + y * half
        source = cap.pull - math.copysign(cap.resistance, float(cap(x, t)[1]))

        def formula(x: Any, t: Any, source: float = source) -> tuple[Any, Any]:
            after = t - t0
            G, slope = G0 + G1 * after + G2 * after**2 / 2, G1 + G2 * after
            centre = cap.x0 + cap.u0 * t + mp.mpf(source) * t**2 / 2
            place = (x - centre) / G
            return cap.h0 * cap.length / G * (1 - place**2), cap.u0 + mp.mpf(source) * t + place * slope

        with mp.workdps(40):
            h, u = (float(value) for value in formula(mp.mpf(x), t0))
        assert residual(formula, BETA, source, x, t0) < 1e-15
        assert cap(x, t) == (pytest.approx(h, rel=1e-13), pytest.approx(u, rel=1e-13))


def test_books(cap: ParabolicCap) -> None:
    """Mass 4/3 h0 L for ever; momentum is mass times (u0 + m t); nothing outside the cap."""
    mass = 4 / 3 * cap.h0 * cap.length
    for t in np.linspace(0, late(cap), 4):
        middle, half, _ = cap.shape(t)
        cells = Cells(middle - 1.13 * half, middle + 1.07 * half, 57)
        h, q = cap.averages(cells, t)
        assert h.sum() * cells.dx == pytest.approx(mass, rel=16 * EPS)
        assert q.sum() * cells.dx == pytest.approx(
            mass * (cap.u0 + cap.m * t), abs=16 * EPS * np.abs(q).sum() * cells.dx + EPS
        )
        for outside in (middle - 1.0001 * half, middle + 1.0001 * half, -1e9):
            assert cap(outside, t) == (0.0, 0.0)


def test_start(cap: ParabolicCap) -> None:
    x = cap.x0 + cap.length * np.linspace(-0.99, 0.99, 12)
    h, u = cap(x, 0.0)
    np.testing.assert_allclose(h, cap.h0 * (1 - ((x - cap.x0) / cap.length) ** 2), rtol=0, atol=4 * EPS * cap.h0)
    np.testing.assert_array_equal(u, cap.u0)


def test_averages_over_halved_cells_add_up(cap: ParabolicCap) -> None:
    for whole, halves in zip(*(cap.averages(Cells(-5, 6, count), late(cap)) for count in (37, 74)), strict=True):
        np.testing.assert_allclose(whole, halves.reshape(-1, 2).mean(axis=1), rtol=1e-13, atol=1e-14)


def test_averages_match_the_points(cap: ParabolicCap) -> None:
    """Against the midpoint rule with 2000 points a cell; its error is O(1/2000^2) but in cells with an edge."""
    t, cells = late(cap), Cells(-5, 6, 11)
    h, u = cap(Cells(-5, 6, 22_000).x, t)
    for average, points in zip(cap.averages(cells, t), (h, h * u), strict=True):
        np.testing.assert_allclose(average, points.reshape(11, -1).mean(axis=1), atol=1e-5 * np.abs(points).max())


def test_mirror_image(cap: ParabolicCap) -> None:
    mirrored = ParabolicCap(cap.h0, cap.length, BETA, -cap.pull, cap.resistance, -cap.u0, -cap.x0)
    assert mirrored.until == cap.until
    x, t = np.linspace(-6, 6, 101), late(cap)
    (h, u), (h_mirrored, u_mirrored) = cap(x, t), mirrored(-x, t)
    np.testing.assert_array_equal(h, h_mirrored)
    np.testing.assert_array_equal(u, -u_mirrored)


def rear(cap: ParabolicCap, t: float) -> float:
    """Slowest velocity in the direction of motion: |u0 + m t| - G', G' from the frictionless twin."""
    free = ParabolicCap(cap.h0, cap.length, BETA, cap.m, 0.0, cap.u0, cap.x0)
    towards = -1.0 if cap.u0 < 0 or (cap.u0 == 0 and cap.m < 0) else 1.0
    return towards * (cap.u0 + cap.m * t) - free.shape(t)[2]


@pytest.mark.parametrize(
    ("name", "ends"),
    [
        ("speeds up", False),
        ("from rest, steep", False),
        ("slows down", True),
        ("coasts", True),
        ("coasts and outruns its spread", False),
        ("rear stops, then would go on", True),
        ("to the left", True),
    ],
)
def test_valid_until_the_rear_stops(name: str, ends: bool) -> None:
    """The first time at which the rear is at rest; beyond it questions are refused."""
    cap = CAPS[name]
    assert math.isfinite(cap.until) == ends
    times = np.linspace(0, cap.until if ends else 60.0, 500)
    assert min(rear(cap, t) for t in times) >= -1e-14
    if ends:
        assert rear(cap, cap.until) == pytest.approx(0.0, abs=1e-14)
        assert rear(cap, cap.until * (1 + 1e-6)) < 0.0
        for ask in (lambda t: cap(0.0, t), lambda t: cap.averages(Cells(-1, 1, 4), t), cap.shape):
            with pytest.raises(InputError, match="come to rest"):
                ask(cap.until * (1 + 1e-12))


def test_rear_that_stops_would_go_on() -> None:
    """The case in the list is the one that a look at late times alone would miss."""
    cap = CAPS["rear stops, then would go on"]
    assert cap.m > 0
    assert rear(cap, 30.0) > 0


@pytest.mark.parametrize(("pull", "resistance"), [(0.1, 0.2), (0.2, 0.2), (0.5, 0.2)])
def test_rest_starts_both_ways(pull: float, resistance: float) -> None:
    """2 beta h0/L = 0.8 outweighs m: the rear starts uphill, where friction has the other sign."""
    cap = ParabolicCap(1.0, 1.0, BETA, pull, resistance)
    assert cap.until == 0.0
    assert cap(0.0, 0.0) == (1.0, 0.0)
    with pytest.raises(InputError, match="0 <= t <= 0"):
        cap(0.0, 1e-6)


def test_until_at_random(rng: np.random.Generator) -> None:
    """Against a scan in time, finite or not."""
    kinds = set()
    for h0, length, u0, m in zip(
        *np.exp(rng.normal(size=(3, 200))), rng.normal(scale=0.5, size=200), strict=True
    ):  # fmt: skip
        cap = ParabolicCap(h0, length, BETA, m + 0.1, 0.1, u0)
        end = min(cap.until, 200.0)
        size = u0 + abs(cap.m) * end + 2 * math.sqrt(BETA * h0)
        assert min(rear(cap, t) for t in np.linspace(0, end, 40)) >= -1e-14 * size
        if cap.until < math.inf:
            assert rear(cap, cap.until) == pytest.approx(0.0, abs=1e-14 * size)
        kinds.add((cap.until < math.inf, m > 0))
    assert kinds == {(True, True), (True, False), (False, True)}


def test_questions_and_data_outside() -> None:
    cap = CAPS["speeds up"]
    for t in (-1e-9, math.nan, math.inf):
        with pytest.raises(InputError, match="0 <= t"):
            cap(0.0, t)
    with pytest.raises(InputError, match="not a number"):
        cap([0.0, math.nan], 1.0)
    for wrong in ({"h0": 0.0}, {"length": -1.0}, {"beta": 0.0}, {"resistance": -0.1}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            ParabolicCap(**{"h0": 1.0, "length": 1.0, "beta": BETA, **wrong})
