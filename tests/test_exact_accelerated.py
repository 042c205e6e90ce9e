"""Riemann problems on an incline with friction, all wave patterns, in the frame that slides along."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from covering import covering
from residual import residual
from test_riemann import BETA, PATTERNS, build, flux

import kinsim
from kinsim import Cells, InputError
from kinsim.exact import AcceleratedRiemann, Riemann

EPS = float(np.finfo(float).eps)
GROUNDS = {"down": (0.5, 0.2), "up": (0.1, 0.3), "without friction": (-0.3, 0.0)}
"""pull and resistance."""


def carried(of: Riemann, v: float) -> Riemann:
    """The same seen by another uniform observer."""
    return Riemann(of.h_left, of.u_left + v, of.h_right, of.u_right + v, of.beta, of.x0)


def forward(name: str, ground: str, back: bool = False) -> AcceleratedRiemann:
    """A pattern, carried so that all of it moves to the right at 0.5 or more, or to the left."""
    flat = build(name)
    v = -0.5 - flat.velocities[1] if back else 0.5 - flat.velocities[0]
    return AcceleratedRiemann(carried(flat, v), *GROUNDS[ground])


@pytest.fixture(params=covering(PATTERNS, GROUNDS, (False, True)), ids=str)
def solution(request: pytest.FixtureRequest) -> AcceleratedRiemann:
    return forward(*request.param)


def late(solution: AcceleratedRiemann) -> float:
    """A time at which it is valid."""
    return min(0.9 * solution.until, 1.3)


@pytest.mark.parametrize("name", PATTERNS)
def test_velocities_are_those_of_wet_points(name: str) -> None:
    """At any time, up to the width of the finest fan sample; fronts are reached in the limit."""
    flat = build(name)
    lowest, highest = flat.velocities
    for t in (0.3, 2.0):
        spread = t * np.linspace(flat.speeds[0] - 0.1, flat.speeds[3] + 0.1, 20_001)
        h, u = flat(flat.x0 + spread, t)
        if not (h > 0).any():
            assert (lowest, highest) == (0.0, 0.0)
            continue
        step = (flat.speeds[3] - flat.speeds[0] + 0.2) / 20_000
        assert lowest == pytest.approx(u[h > 0].min(), abs=2 * step)
        assert highest == pytest.approx(u[h > 0].max(), abs=2 * step)
        assert lowest <= u[h > 0].min() + 1e-13
        assert highest >= u[h > 0].max() - 1e-13


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("name", [name for name in PATTERNS if build(name).speeds[0] < build(name).speeds[1] - 1e-9])
def test_fans_solve_the_equations(name: str, ground: str) -> None:
    """Residual in 40 digits inside left fans (right ones are their mirror images); the code is this formula."""
    of = forward(name, ground)
    flat, t = of.riemann, late(of)
    begin, end, *_ = flat.speeds

    def formula(x: Any, t: Any) -> tuple[Any, Any]:
        far = flat.u_left + 2 * mp.sqrt(BETA * mp.mpf(flat.h_left))
        ray = (x - of.m * t**2 / 2 - flat.x0) / t
        return ((far - ray) / 3) ** 2 / BETA, (far + 2 * ray) / 3 + of.m * t

    for share in (0.1, 0.5, 0.9):
        x = flat.x0 + t * (begin + share * (end - begin)) + 0.5 * of.m * t * t
        assert residual(formula, BETA, of.m, x, t) < 1e-15
        h, u = formula(x, t)
        assert of(x, t) == (pytest.approx(float(h), rel=1e-13), pytest.approx(float(u), rel=1e-14))


def test_box_balance(solution: AcceleratedRiemann) -> None:
    """Mass and momentum in a box whose ends no wave has reached, against flux and source integrated by hand.

    The ends slide with u_K + m t, so that what flows in is a polynomial in time; the source is m times the mass.
    """
    t, m, flat = late(solution), solution.m, solution.riemann
    box = Cells(-22, 23, 700)
    (h, q), (h0, q0) = solution.averages(box, t), solution.averages(box, 0.0)
    entered, pushed, mass_in = 0.0, 0.0, 0.0
    for h_side, u_side, sign in ((flat.h_left, flat.u_left, 1), (flat.h_right, flat.u_right, -1)):
        entered += sign * h_side * (u_side * t + m * t**2 / 2)
        mass_in += sign * h_side * (u_side * t**2 / 2 + m * t**3 / 6)
        pushed += sign * (flux(h_side, u_side)[1] * t + h_side * (u_side * m * t**2 + m**2 * t**3 / 3))
    rounding = 64 * EPS * (1 + np.abs(h).sum() + np.abs(q).sum() + np.abs(q0).sum()) * (1 + abs(m)) * box.dx * 8
    assert np.sum(h - h0) * box.dx == pytest.approx(entered, abs=rounding)
    source = m * (h0.sum() * box.dx * t + mass_in)
    assert np.sum(q - q0) * box.dx == pytest.approx(pushed + source, abs=rounding)


def test_shocks_satisfy_rankine_hugoniot(solution: AcceleratedRiemann) -> None:
    """S [U] = [F(U)] across both waves where they are shocks, with the states read beside them at the time t."""
    t, flat = late(solution), solution.riemann
    for begin, end in (flat.speeds[:2], flat.speeds[2:]):
        place = flat.x0 + begin * t + 0.5 * solution.m * t * t
        (h1, u1), (h2, u2) = (solution(place + side * 1e-9, t) for side in (-1, 1))
        if begin == end and min(h1, h2) > 0.0 and h1 != pytest.approx(h2, abs=1e-6):
            speed = begin + solution.m * t
            left, right = flux(float(h1), float(u1)), flux(float(h2), float(u2))
            size = (1 + max(h1, h2)) ** 2 * (1 + abs(speed)) ** 2
            np.testing.assert_allclose(speed * np.array([h2 - h1, h2 * u2 - h1 * u1]), right - left, atol=8e-15 * size)
            sign = 1 if h1 > h2 else -1
            assert u1 + sign * math.sqrt(BETA * h1) > speed > u2 + sign * math.sqrt(BETA * h2)


def test_mirror_image(solution: AcceleratedRiemann) -> None:
    flat = solution.riemann
    mirrored = AcceleratedRiemann(
        Riemann(flat.h_right, -flat.u_right, flat.h_left, -flat.u_left, BETA, -flat.x0),
        -solution.pull,
        solution.resistance,
    )
    assert mirrored.until == pytest.approx(solution.until, rel=1e-12)
    x, t = np.linspace(-5, 5, 401) + 1e-3, late(solution)
    (h, u), (h_mirrored, u_mirrored) = solution(x, t), mirrored(-x, t)
    np.testing.assert_allclose(h, h_mirrored, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(u, -u_mirrored, rtol=1e-12, atol=1e-13)


def test_averages_match_the_points(solution: AcceleratedRiemann) -> None:
    """Against the midpoint rule with 1000 points a cell; cells with a jump are off by one point at most."""
    t, cells = late(solution), Cells(-6, 7, 13)
    h, u = solution(Cells(-6, 7, 13_000).x, t)
    largest = float(np.max(h * (1 + np.abs(u))))
    for average, points in zip(solution.averages(cells, t), (h, h * u), strict=True):
        np.testing.assert_allclose(average, points.reshape(13, -1).mean(axis=1), atol=4e-3 * largest + 1e-15)


def test_friction_never_changes_sign(solution: AcceleratedRiemann) -> None:
    """Up to `until`, where the slowest wet point comes to rest; without friction for ever."""
    lowest, highest = solution.riemann.velocities
    if solution.resistance == 0.0:
        assert (solution.m, solution.until) == (solution.pull, math.inf)
        return
    sign = math.copysign(1.0, lowest + highest)
    if (lowest, highest) != (0.0, 0.0):
        assert solution.m == solution.pull - sign * solution.resistance
    if math.isinf(solution.until):
        assert sign * solution.m >= 0.0
        return
    x = np.linspace(-30, 30, 3001)
    h, u = solution(x, solution.until)
    assert (sign * u[h > 0]).min() >= -1e-14
    assert min(abs(lowest + solution.m * solution.until), abs(highest + solution.m * solution.until)) < 1e-15
    for ask in (lambda t: solution(x, t), lambda t: solution.averages(Cells(-1, 1, 4), t)):
        with pytest.raises(InputError, match="come to rest"):
            ask(solution.until * (1 + 1e-12))


@pytest.mark.parametrize(("h_left", "h_right"), [(1.0, 0.4), (1.0, 0.0)])
def test_dam_breaks_from_rest_only_beyond_the_angle_of_friction(h_left: float, h_right: float) -> None:
    """zeta >= delta; at zeta = delta the layer behind stays at rest, held by all the friction there is."""
    flat = Riemann(h_left, 0.0, h_right, 0.0, BETA)
    assert AcceleratedRiemann(flat, 0.3, 0.2).until == AcceleratedRiemann(flat, 0.2, 0.2).until == math.inf
    assert AcceleratedRiemann(flat, 0.2, 0.2)(-50.0, 9.0) == (1.0, 0.0)
    gentle = AcceleratedRiemann(flat, 0.1, 0.2)
    assert gentle(-1.0, 0.0) == (1.0, 0.0)
    with pytest.raises(InputError, match="0 <= t <= 0"):
        gentle(-1.0, 1e-9)


def test_level_rest_is_held_or_starts() -> None:
    """A level lake on an incline: friction holds it up to |s| = R, beyond that it slides downhill."""
    lake = Riemann(0.7, 0.0, 0.7, 0.0, BETA)
    assert AcceleratedRiemann(lake, -0.2, 0.2)(1.0, 5.0) == (0.7, 0.0)
    assert AcceleratedRiemann(lake, -0.5, 0.2)(1.0, 5.0) == (0.7, pytest.approx(-0.3 * 5, rel=4 * EPS))


def test_motion_both_ways_needs_ground_without_friction() -> None:
    flat = build("two fans")
    assert AcceleratedRiemann(flat, 0.2, 0.0).until == math.inf
    with pytest.raises(InputError, match="both signs"):
        AcceleratedRiemann(flat, 0.2, 0.1)


def test_questions_and_data_outside() -> None:
    solution = forward("fan, shock", "down")
    for t in (-1e-9, math.nan, math.inf):
        with pytest.raises(InputError, match="0 <= t"):
            solution(0.0, t)
        with pytest.raises(InputError, match="0 <= t"):
            solution.averages(Cells(-1, 1, 4), t)
    with pytest.raises(InputError, match="not a number"):
        solution([math.nan], 1.0)
    with pytest.raises(kinsim.InputError, match="resistance"):
        AcceleratedRiemann(build("two fans"), 0.1, -0.2)
    assert solution == forward("fan, shock", "down")
