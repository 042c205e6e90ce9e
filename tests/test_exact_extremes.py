"""Exact solutions at the ends of floating point: they work there, or say in one line that they cannot."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from kinsim import Cells, InputError
from kinsim.exact import (
    AcceleratedRiemann,
    FreeTransport,
    Motion,
    ParabolicCap,
    Riemann,
    SlidingWedge,
    StaticPile,
    TravellingShock,
    UniformSlide,
    coulomb_fill,
    random_pile,
)

EPS = float(np.finfo(float).eps)

HEIGHTS = (0.0, 5e-324, 1e-300, 1.0, 1e300)
SPEEDS = (0.0, 1.0, 1e300, -1e300)
BETAS = (0.4, 1e-300, 1e300)

SOLUTIONS: dict[str, tuple[Callable[..., Any], tuple[tuple[float, ...], ...]]] = {
    "Riemann": (Riemann, (HEIGHTS, SPEEDS, HEIGHTS, SPEEDS, BETAS)),
    "AcceleratedRiemann": (
        lambda *given: AcceleratedRiemann(Riemann(*given[:5]), *given[5:]),
        (HEIGHTS[2:], SPEEDS[1:], HEIGHTS[2:], SPEEDS[1:], BETAS[:2], (0.2, 1e300), (0.0, 0.1, 1e300)),
    ),
    "ParabolicCap": (ParabolicCap, (HEIGHTS, HEIGHTS, BETAS, (0.2, -1e300), (0.0, 1e-300, 0.1, 1e300), SPEEDS)),
    "TravellingShock": (TravellingShock, (HEIGHTS, SPEEDS, HEIGHTS, BETAS, (0.2, 1e300), (0.0, 0.1, 1e300))),
    "StaticPile": (StaticPile, ((0.5, -1.0), (-0.5,), BETAS, (0.1, 1e300), (0.3, 1e300), HEIGHTS)),
    "SlidingWedge": (SlidingWedge, (HEIGHTS, SPEEDS, SPEEDS, BETAS, (0.2, -1e300), (0.0, 0.3, 1e300))),
    "UniformSlide": (UniformSlide, (SPEEDS, (0.2, -1e300), (0.0, 0.3, 1e-300, 1e300), HEIGHTS)),
}


@pytest.mark.parametrize("name", SOLUTIONS)
def test_extreme_numbers_work_or_get_one_line(name: str) -> None:
    """Nothing but finite numbers or an `InputError`; numpy's own warnings are errors here."""
    make, choices = SOLUTIONS[name]
    answered, refusals = 0, []
    for given in itertools.product(*choices):
        try:
            solution = make(*given)
            t = min(1.0, getattr(solution, "until", math.inf))
            found = (*solution(np.array([-1.0, 0.0, 1.0]), t), *solution.averages(Cells(-1, 1, 4), t))
            assert all(np.isfinite(part).all() for part in found), given
            assert (found[0] >= 0).all(), given
            answered += 1
        except InputError as error:
            refusals.append(str(error))
    assert not any("\n" in line for line in refusals)
    assert min(answered, len(refusals)) > 0.1 * (answered + len(refusals))


WIDE = [
    (1e300, 0.0, 1e-300, 0.0), (1e-300, 1.0, 1e-300, -1.0), (1e300, 0.0, 1.0, 0.0), (1.0, 1e300, 1.0, -1e300),
    (1e-300, 1e-150, 1e300, 1e150), (1e-12, 3.0, 1e12, -2.0), (1e300, 1e150, 1e300, 0.0),
]  # fmt: skip


@pytest.mark.parametrize("given", WIDE)
def test_the_middle_of_a_wide_pair_lies_on_both_curves(given: tuple[float, float, float, float]) -> None:
    """In 700 digits: h* solves the equation between the two curves to 1e-14, and u* lies on the curve of the thicker.

    On that of the thinner side the digits of u* are those of the velocities that cancel.
    """
    of = Riemann(*given, beta=0.4)
    h_left, u_left, h_right, u_right = (mp.mpf(number) for number in given)
    with mp.workdps(700):

        def phi(h: Any, side: Any) -> Any:
            if h <= side:
                return 2 * (mp.sqrt(of.beta * h) - mp.sqrt(of.beta * side))
            return (h - side) * mp.sqrt(of.beta * (1 / h + 1 / side) / 2)

        h = mp.mpf(of.middle[0])
        low, high = (phi(h * k, h_left) + phi(h * k, h_right) + u_right - u_left for k in (1 - 1e-14, 1 + 1e-14))
        assert low < 0 < high
        u = (u_left - phi(h, h_left) + u_right + phi(h, h_right)) / 2
        size = abs(u_left) + abs(u_right) + abs(phi(h, h_left)) + abs(phi(h, h_right))
        assert abs(of.middle[1] - u) < 1e-15 * size


@pytest.mark.parametrize("power", [-400, 400])
def test_scaled_problems_have_scaled_solutions(power: int) -> None:
    """h times 4^k and u times 2^k, over 240 decades of height, up to the last digit of squares and roots."""
    k, x = 2.0**power, np.linspace(-2, 2, 41)
    for h_left, u_left, h_right, u_right in ((1, 0, 0.5, 0), (1, 0.8, 0.7, -0.9), (1, -0.3, 0.6, 0.4), (0, 0, 1, 0.3)):
        one = Riemann(h_left, u_left, h_right, u_right, 0.4)
        other = Riemann(k * k * h_left, k * u_left, k * k * h_right, k * u_right, 0.4)
        (h, u), (h_far, u_far) = one(x, 1.0), other(x * k, 1.0)
        np.testing.assert_allclose(h_far, k * k * h, rtol=4 * EPS)
        np.testing.assert_allclose(u_far, k * u, rtol=4 * EPS, atol=4 * EPS * k)
        steep = Riemann(k * k * h_left, k * k * u_left, k * k * h_right, k * k * u_right, 0.4 * k * k)
        h_far, u_far = steep(x * k * k, 1.0)  # beta, too, whose product with h would be far outside
        np.testing.assert_allclose(h_far, k * k * h, rtol=4 * EPS)
        np.testing.assert_allclose(u_far, k * k * u, rtol=4 * EPS, atol=4 * EPS * k * k)
    one, other = ParabolicCap(1, 1, 0.4, 0.2, 0.3, 0.5), ParabolicCap(k * k, k, 0.4, 0.2 * k, 0.3 * k, 0.5 * k)
    assert other.until == pytest.approx(one.until, rel=4 * EPS)
    t = 0.9 * one.until
    (h, u), (h_far, u_far) = one(x, t), other(x * k, t)
    np.testing.assert_allclose(h_far, k * k * h, rtol=4 * EPS, atol=4 * EPS * k * k)
    np.testing.assert_allclose(u_far, k * u, rtol=4 * EPS, atol=4 * EPS * k)
    one, other = TravellingShock(1, 1.2, 0.5, 0.4), TravellingShock(k * k, 1.2 * k, 0.5 * k * k, 0.4)
    assert (other.u_right, other.speed) == pytest.approx((k * one.u_right, k * one.speed), rel=4 * EPS)


def test_a_cap_at_a_very_early_time_is_not_taken_for_a_later_one() -> None:
    """Products of tiny numbers are 0: w solves sinh w + w = 2 V t/L, so that G' = 2 beta h0 t/L at first."""
    for t in (1e-100, 1e-200, 1e-300):
        assert ParabolicCap(1, 1, 0.4).shape(t)[2] == pytest.approx(0.8 * t, rel=1e-14)


ALL: dict[str, Callable[[Any, Any], Any]] = {
    "Riemann": Riemann(1, 0, 0.5, 0, 0.4),
    "AcceleratedRiemann": AcceleratedRiemann(Riemann(1, 0, 0.5, 0, 0.4), 0.5, 0.2),
    "ParabolicCap": ParabolicCap(1, 1, 0.4),
    "TravellingShock": TravellingShock(1, 0, 0.5, 0.4),
    "StaticPile": StaticPile(0.5, -0.5, 0.4, 0.0, 0.3),
    "SlidingWedge": SlidingWedge(2, 0.1, 0.5, 0.4),
    "UniformSlide": UniformSlide(1.0, 0.2),
    "FreeTransport": lambda x, t: FreeTransport(lambda x, xi: x + xi)(x, 0.0, t),
}


@pytest.mark.parametrize("name", ALL)
def test_times_and_places_are_real_numbers(name: str) -> None:
    solution = ALL[name]
    for t in (None, "1", 1j, [0.5], np.array([0.1, 0.2]), np.array([0.1])):
        with pytest.raises(InputError, match=rf"^{name}: t is of type {type(t).__name__}, not one time"):
            solution(0.0, t)
    for x in (1j, np.array([0.0, 1.0 + 0j]), "0", ["a"], [[0.0], [1.0, 2.0]], None, [math.inf], 10**400):
        with pytest.raises(InputError, match=rf"^{name}: x (is|holds) .*not a number"):
            solution(x, 0.5)
    one, *others = [solution(x, t) for x, t in ((0, 1), (0.0, np.array(1.0)), (np.float32(0), np.int64(1)))]
    for other in others:
        np.testing.assert_array_equal(one, other)


def test_motion_asks_for_a_time() -> None:
    for t in (-1.0, None, math.nan):
        with pytest.raises(InputError, match="Motion: t"):
            Motion(1.0, 0.2, 0.1)(t)


def test_a_density_that_is_not_real_is_refused() -> None:
    for f0 in (lambda x, xi: x + 1j, lambda x, xi: None, lambda x, xi: np.full(np.shape(x), np.nan)):
        with pytest.raises(InputError, match="FreeTransport: f0"):
            FreeTransport(f0)(1.0, 0.0, 1.0)


GROUND = {"pull": 0.1, "resistance": 0.3, "beta": 0.4, "per": "face"}


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"h": [1.0, math.nan, 2.0]}, "pile: h holds nan"),
        ({"h": [1.0, 1j]}, "pile: h is not a number"),
        ({"h": 1.0}, "two heights or more"),
        ({"h": [1.0]}, "two heights or more"),
        ({"h": [[1.0, 2.0]]}, "two heights or more"),
        ({"dx": 0.0}, "pile: dx: should be greater than 0"),
        ({"dx": math.nan}, "pile: dx: should be a finite number"),
        ({"dx": None}, "pile: dx: should be a valid number"),
        ({"beta": "x"}, "pile: beta"),
        ({"pull": math.nan}, "pile: pull"),
        ({"h": [1e308, 0.0], "dx": 1e-10}, "pile: floating point"),
    ],
)
def test_the_fill_of_no_pile(given: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        coulomb_fill(**{"h": [1.0, 2.0], "dx": 0.1, **GROUND, **given})


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"rng": -1}, "pile: rng: should be greater than or equal to 0"),
        ({"rng": None}, "pile: rng: should be a valid integer"),
        ({"fill": 1e300}, "pile: fill: should be less than or equal to 1000000"),
        ({"fill": None}, "pile: fill: should be a valid number"),
        ({"resistance": 1e300, "beta": 1e-300}, "pile: floating point"),
    ],
)
def test_no_random_pile(given: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        random_pile(Cells(0, 1, 20), **{**GROUND, "fill": 0.5, "rng": 1, **given})
