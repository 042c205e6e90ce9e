"""The closed half-range moments against adaptive quadrature of M itself, and the printed ones with their misprints."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import cache

import mpmath
import numpy as np
import pytest
from states import scene_with

from kinsim import Macroscopic, printed, step
from kinsim.exact import Riemann
from kinsim.macroscopic.closed_form import half_moments_closed
from kinsim.schemes.formulas import acceleration

BETA = 0.4
DIGITS = 30


@cache
def scaled_quadrature(ratio: float, k: int, positive: bool) -> mpmath.mpf:
    """Integral of xi^k M over one side of xi = 0 for c = h = 1, u = `ratio`.

    Tanh-sinh, which takes the square roots at the edges of the support.
    """
    with mpmath.workdps(DIGITS):
        low, high = (
            (max(mpmath.mpf(edge) + ratio, 0) for edge in (-1, 1))
            if positive
            else (min(mpmath.mpf(edge) + ratio, 0) for edge in (-1, 1))
        )
        if low == high:
            return mpmath.mpf(0)
        return mpmath.quad(
            lambda xi: xi**k * 2 / mpmath.pi * mpmath.sqrt(max(1 - (xi - ratio) ** 2, 0)), [low, (low + high) / 2, high]
        )


def quadrature(h: float, u: float, beta: float, k: int, positive: bool) -> mpmath.mpf:
    """Integral of xi^k M(h, xi - u) over xi >= 0 or xi < 0; with xi measured in c, so that no h is too small."""
    c = mpmath.sqrt(2 * mpmath.mpf(beta) * h)
    return h * c**k * scaled_quadrature(float(u / c), k, positive)


def scale(h: float, u: float, beta: float, k: int) -> float:
    """The flux scale h (|u| + c)^k."""
    return h * (abs(u) + math.sqrt(2 * beta * h)) ** k


def by_quadrature(h: float, u: float, beta: float) -> list[float]:
    return [float(quadrature(h, u, beta, k, positive)) for positive in (True, False) for k in (1, 2)]


RATIOS = [
    sign * ratio
    for sign in (1, -1)
    for ratio in (0.0, 1e-300, 1e-12, 0.03, 0.5, 0.9, 1 - 1e-3, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12, 1 - 2**-53,
                  1.0, 1 + 2**-52, 1 + 1e-9, 1 + 1e-3, 1.5, 10.0, 1e6)
]  # fmt: skip
"""u/c in all three branches, and close to their borders."""


@pytest.mark.parametrize("h", [1e-100, 1e-12, 1e-3, 1.0, 37.0, 1e9, 1e100])
def test_closed_moments_are_integrals_of_M(h: float) -> None:
    """To 1e-13 of the flux scale in all regimes of a, the borders |a| = 1 included."""
    for beta, ratio in itertools.product((1e-3, BETA, 20.0), RATIOS):
        u = ratio * math.sqrt(2 * beta * h)
        found = half_moments_closed(h, u, beta)
        for value, right, k in zip(found, by_quadrature(h, u, beta), (1, 2, 1, 2), strict=True):
            assert abs(value - right) <= 1e-13 * scale(h, u, beta, k), (beta, ratio, k)


def test_quadrature_is_trustworthy() -> None:
    """The judge is judged: its scaling is that of M itself as (12) has it, and both halves add up to (3)."""
    h, u = 0.7, -0.31
    with mpmath.workdps(DIGITS):
        c = mpmath.sqrt(2 * mpmath.mpf(BETA) * h)

        def M(xi: mpmath.mpf) -> mpmath.mpf:
            return mpmath.sqrt(2 * h) / (mpmath.pi * mpmath.sqrt(BETA)) * mpmath.sqrt(max(1 - ((xi - u) / c) ** 2, 0))

        for k, total in enumerate([h, mpmath.mpf(h) * u, mpmath.mpf(h) * u * u + mpmath.mpf(BETA) * h * h / 2]):
            positive, negative = (
                mpmath.quad(lambda xi, k=k: xi**k * M(xi), ends) for ends in ([0, u + c], [u - c, u, 0])
            )
            assert abs(positive + negative - total) < 1e-20
            assert abs(positive - quadrature(h, u, BETA, k, True)) < 1e-15
            assert abs(negative - quadrature(h, u, BETA, k, False)) < 1e-15


def test_moments_over_both_halves_are_the_totals(rng: np.random.Generator) -> None:
    """(3), lines two and three."""
    for h, ratio in zip(10 ** rng.uniform(-8, 3, 300), rng.uniform(-1.5, 1.5, 300), strict=True):
        u = ratio * math.sqrt(2 * BETA * h)
        p1, p2, n1, n2 = half_moments_closed(h, u, BETA)
        assert p1 + n1 == pytest.approx(h * u, abs=2e-16 * scale(h, u, BETA, 1))
        assert p2 + n2 == pytest.approx(h * u * u + 0.5 * BETA * h * h, rel=4e-16)


def test_moments_have_their_sign(rng: np.random.Generator) -> None:
    """Particles with xi >= 0 carry mass to the right, all carry momentum forward, also where a -> 1."""
    for h in 10 ** rng.uniform(-8, 3, 100):
        for ratio in RATIOS:
            p1, p2, n1, n2 = half_moments_closed(h, ratio * math.sqrt(2 * BETA * h), BETA)
            assert p1 >= 0
            assert p2 >= 0
            assert n1 <= 0
            assert n2 >= 0


def test_mirrored_states_have_mirrored_moments_bit_for_bit(rng: np.random.Generator) -> None:
    for h, u in zip(10 ** rng.uniform(-8, 3, 300), rng.normal(size=300), strict=True):
        p1, p2, n1, n2 = half_moments_closed(h, u, BETA)
        assert half_moments_closed(h, -u, BETA) == (-n1, n2, -p1, p2)


@pytest.mark.parametrize("h", [0.0, -0.0, -1e-3])
def test_no_mass_no_flux(h: float) -> None:
    """Dry cells, and those that a slow cell made negative, emit nothing; and nothing divides by zero."""
    assert half_moments_closed(h, 0.7, BETA) == (0.0, 0.0, 0.0, 0.0)


def test_flux_takes_the_right_half_from_each_side(rng: np.random.Generator) -> None:
    """F = (I1 + I2, I3 + I4) of (24): xi >= 0 from the left cell, xi < 0 from the right one."""
    h, u = rng.uniform(0, 2, (2, 12)) - [[0], [1]]
    F1, F2 = step(scene_with(h), Macroscopic(1), h, h * u, 1e-9).flux
    for i in range(12):
        p1, p2, _, _ = by_quadrature(h[i - 1], u[i - 1], BETA)
        _, _, n1, n2 = by_quadrature(h[i], u[i], BETA)
        assert F1[i] == pytest.approx(p1 + n1, abs=1e-13 * scale(2, 1, BETA, 1))
        assert F2[i] == pytest.approx(p2 + n2, abs=1e-13 * scale(2, 1, BETA, 2))


def test_flux_is_consistent(rng: np.random.Generator) -> None:
    """F(U, U) = (hu, hu^2 + beta h^2/2)."""
    h, u = rng.uniform(0, 2, 50), rng.normal(size=50)
    h, u = np.repeat(h, 2), np.repeat(u, 2)
    now = step(scene_with(h), Macroscopic(1), h, h * u, 1e-9)
    h, u, (F1, F2) = h[::2], now.u[::2], now.flux[:, 1::2]
    np.testing.assert_allclose(F1, h * u, atol=1e-15)
    np.testing.assert_allclose(F2, h * u * u + 0.5 * BETA * h * h, rtol=1e-15)


# ---- the formulas as printed; theory.md, section 1 -------------------------------------------------------------------

MIDDLE = [(1.0, 0.3), (1.0, -0.3), (0.2, 0.35), (2.3, -1.2), (0.05, 0.0)]
"""States with |a| < 1."""

ALL_BRANCHES = [*MIDDLE, (1.0, 1.0), (1.0, -1.0), (0.05, 0.7), (0.05, -0.7)]


def misfit(formula: Callable[..., float], k: int, positive: bool, states: list[tuple[float, float]]) -> float:
    """Largest deviation of a printed formula from quadrature, in flux scales."""
    return max(
        abs(formula(h, u, BETA) - float(quadrature(h, u, BETA, k, positive))) / scale(h, u, BETA, k) for h, u in states
    )


@pytest.mark.parametrize(
    ("formula", "k", "positive"),
    [
        (printed.I1, 1, True),
        (printed.I2, 1, False),
        (printed.I4, 2, False),
        (printed.I3_tilde, 2, True),
        (printed.I4_tilde, 2, False),
    ],
)
def test_formulas_without_misprint_are_right_as_printed(formula: Callable[..., float], k: int, positive: bool) -> None:
    """I1, I2, I~3, I~4, and I4 within one cell."""
    assert misfit(formula, k, positive, ALL_BRANCHES) <= 1e-13


def test_misprint_I3_sine_of_four_arcsines() -> None:
    """Printed: 1/32 sin(a1). Right: 1/32 sin(4 arcsin a1)."""
    assert misfit(lambda *state: printed.I3(*state, sign_mended=True), 2, True, MIDDLE) > 1e-3
    assert misfit(lambda *state: printed.I3(*state, sine_mended=True, sign_mended=True), 2, True, ALL_BRANCHES) <= 1e-13


def test_misprint_I3_sign_of_the_cosine_term() -> None:
    """Printed: - 4/(3 pi) sqrt(2 beta) (hu) sqrt(h) cos^3. Right: +."""
    assert misfit(lambda *state: printed.I3(*state, sine_mended=True), 2, True, MIDDLE) > 1e-2
    assert misfit(lambda *state: printed.I3(*state, sine_mended=True, sign_mended=True), 2, True, ALL_BRANCHES) <= 1e-13


def test_misprint_I3_makes_the_flux_inconsistent() -> None:
    """At h = 1, u = 0.3, beta = 0.4 the second component of F(U, U) is 0.110 instead of 0.290."""
    h, u = 1.0, 0.3
    assert printed.I3(h, u, BETA) + printed.I4(h, u, BETA) == pytest.approx(0.110, abs=5e-4)
    _, p2, _, n2 = half_moments_closed(h, u, BETA)[:4]
    assert p2 + n2 == pytest.approx(0.290, rel=1e-15)
    mended = printed.I3(h, u, BETA, sine_mended=True, sign_mended=True) + printed.I4(h, u, BETA)
    assert mended == pytest.approx(0.290, rel=1e-14)


def test_misprint_I4_velocity_of_the_wrong_cell() -> None:
    """Branch a2 >= 1, printed: h_{i+1} (u_i)^2. Right: h_{i+1} (u_{i+1})^2."""
    h, u, u_left = 0.05, -0.7, 0.2
    right = float(quadrature(h, u, BETA, 2, False))
    assert abs(printed.I4(h, u, BETA, u_left=u_left) - right) > 0.3 * scale(h, u, BETA, 2)
    assert abs(printed.I4(h, u, BETA) - right) <= 1e-13 * scale(h, u, BETA, 2)


def test_misprint_I1_tilde_term_outside_the_bracket() -> None:
    """Printed: 1/4 sin(2 arcsin) beside the bracket. Right: inside, so that (2/pi) hbar u_i multiplies it."""
    assert misfit(printed.I1_tilde, 1, True, MIDDLE) > 1e-2
    assert misfit(lambda *state: printed.I1_tilde(*state, bracket_mended=True), 1, True, ALL_BRANCHES) <= 1e-13


def test_misprint_I2_tilde_term_outside_the_bracket() -> None:
    """The same, with u_{i+1}."""
    assert misfit(printed.I2_tilde, 1, False, MIDDLE) > 1e-2
    assert misfit(lambda *state: printed.I2_tilde(*state, bracket_mended=True), 1, False, ALL_BRANCHES) <= 1e-13


def test_misprint_I4_tilde_third_condition() -> None:
    """Printed: a~2 >= . (no number). Right: 1, where the middle branch ends in the same value, without a jump."""
    h = 0.4
    c = math.sqrt(2 * BETA * h)
    before, after = (printed.I4_tilde(h, -c * a, BETA) for a in (1 - 1e-9, 1 + 1e-9))
    assert before == pytest.approx(after, abs=1e-8)
    assert after == pytest.approx(h * c * c + BETA * h * h / 2, rel=1e-8)


def test_misprint_balanced_flux_integrates_the_upwind_density() -> None:
    """Printed: (F~)^1, (F~)^2 are integrals of M_{i+1/2}. Right: of M~_{i+1/2}, as the formulas below them are."""
    h_left, h_right = 1.0, 0.5
    mean = 0.5 * (h_left + h_right)
    tilde = printed.I1_tilde(mean, 0.0, BETA, bracket_mended=True) + printed.I2_tilde(
        mean, 0.0, BETA, bracket_mended=True
    )
    of_upwind = float(quadrature(h_left, 0.0, BETA, 1, True) + quadrature(h_right, 0.0, BETA, 1, False))
    of_balanced = float(quadrature(mean, 0.0, BETA, 1, True) + quadrature(mean, 0.0, BETA, 1, False))
    assert abs(tilde - of_upwind) > 0.05
    assert abs(tilde - of_balanced) <= 1e-15


def test_misprint_velocity_in_the_fan() -> None:
    """Printed: 2/3 [(x-x0)/t + sqrt(beta h_l) - u_l/2]. Right: + u_l/2; alike only for u_l = 0."""
    h_left, u_left, t = 1.0, 0.4, 1.7
    fan = Riemann(h_left, u_left, 0.2, u_left, BETA)
    rays = np.linspace(fan.speeds[0], fan.speeds[1], 7)[1:-1]
    h, u = fan(rays * t, t)
    for ray, h_there, u_there in zip(rays, h, u, strict=True):
        assert printed.fan_height(ray, h_left, u_left, BETA) == pytest.approx(h_there, rel=1e-14)
        assert printed.fan_velocity(ray, h_left, u_left, BETA, sign_mended=True) == pytest.approx(u_there, rel=1e-14)
        assert printed.fan_velocity(ray, h_left, u_left, BETA) - u_there == pytest.approx(-2 / 3 * u_left, rel=1e-12)


def test_misprint_hyperbolic_at_zero_height() -> None:
    """Printed: hyperbolic for h >= 0. Right: strictly for h > 0; at h = 0 the flux Jacobian has one eigenvector."""

    def jacobian(h: float, u: float) -> np.ndarray:
        return np.array([[0.0, 1.0], [BETA * h - u * u, 2 * u]])

    values, vectors = np.linalg.eig(jacobian(0.5, 0.3))
    np.testing.assert_allclose(np.sort(values), [0.3 - math.sqrt(0.5 * BETA), 0.3 + math.sqrt(0.5 * BETA)])
    assert abs(np.linalg.det(vectors)) > 0.1
    dry = jacobian(0.0, 0.3) - 0.3 * np.eye(2)
    assert np.linalg.matrix_rank(dry) == 1
    np.testing.assert_allclose(dry @ dry, 0.0, atol=1e-16)


def test_misprint_g_of_q_is_g_of_u() -> None:
    """Schemes 2 and 3 print g(q); the law is g(u), and the sign is the same wherever there is mass."""
    for h in (1e-200, 0.3, 5.0):
        for u in (-2.0, -1e-9, 1e-9, 2.0):
            assert acceleration(h * u, 0.2, 0.3) == acceleration(u, 0.2, 0.3)


def test_misprint_rest_condition_on_a_curved_chute() -> None:
    """Printed: beta h_x = g, (8). Right where beta varies: beta h_x + beta' h/2 = g, as (beta h^2/2)_x = g h says."""
    with mpmath.workdps(30):
        h, beta = (lambda x: 1 + mpmath.sin(x) / 3), (lambda x: mpmath.mpf("0.4") * mpmath.cos(x / 2))
        x = mpmath.mpf("0.7")
        pressure = mpmath.diff(lambda y: beta(y) * h(y) ** 2 / 2, x) / h(x)
        as_printed = beta(x) * mpmath.diff(h, x)
        corrected = as_printed + mpmath.diff(beta, x) * h(x) / 2
        assert abs(pressure - as_printed) > 1e-2
        assert abs(pressure - corrected) < 1e-12
