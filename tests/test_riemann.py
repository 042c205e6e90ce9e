"""The exact Riemann solution, tested by its own residual before it judges anything."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import kinsim
from kinsim import Cells
from kinsim.exact import Riemann

BETA = 0.4

PATTERNS = {
    "fan, shock": (1.0, 0.0, 0.5, 0.0),
    "shock, fan": (0.2, 0.1, 1.3, -0.2),
    "two shocks": (1.0, 0.8, 0.7, -0.9),
    "two fans": (1.0, -0.3, 0.6, 0.4),
    "single shock": (0.5, 0.2, 0.1, None),
    "supersonic to the right": (1.0, 3.0, 0.4, 2.5),
    "strong": (10.0, 0.0, 1e-3, 0.0),
    "vacuum in the middle": (1.0, -2.0, 0.5, 2.0),
    "vacuum just opens": (1.0, -2.0 * math.sqrt(BETA), 1.0, 2.0 * math.sqrt(BETA)),
    "dry left": (0.0, 0.0, 1.0, 0.3),
    "dry right": (1.0, -0.2, 0.0, 0.0),
    "dry": (0.0, 0.0, 0.0, 0.0),
    "identical": (0.7, 0.3, 0.7, 0.3),
}


def build(name: str, x0: float = 0.25) -> Riemann:
    h_left, u_left, h_right, u_right = PATTERNS[name]
    if u_right is None:  # to the right of a shock that alone joins the two states
        u_right = u_left - (h_left - h_right) * math.sqrt(BETA / 2 * (1 / h_left + 1 / h_right))
    return Riemann(h_left, u_left, h_right, u_right, BETA, x0)


@pytest.fixture(params=PATTERNS)
def solution(request: pytest.FixtureRequest) -> Riemann:
    return build(request.param)


def flux(h: float, u: float) -> np.ndarray:
    return np.array([h * u, h * u * u + BETA * h * h / 2])


def states(of: Riemann) -> list[tuple[float, float]]:
    return [(of.h_left, of.u_left), of.middle, (of.h_right, of.u_right)]


@pytest.mark.parametrize(
    ("name", "waves"),
    [
        ("fan, shock", "fs"),
        ("shock, fan", "sf"),
        ("two shocks", "ss"),
        ("two fans", "ff"),
        ("strong", "fs"),
        ("vacuum in the middle", "ff"),
        ("dry left", "sf"),
        ("dry right", "fs"),
    ],
)
def test_patterns_are_what_they_are_called(name: str, waves: str) -> None:
    """The list above covers every pattern; the missing wave beside dry ground has no width, as a shock."""
    begin_left, end_left, begin_right, end_right = build(name).speeds
    assert "sf"[begin_left < end_left] + "sf"[begin_right < end_right] == waves


def test_shocks_satisfy_rankine_hugoniot_and_lax(solution: Riemann) -> None:
    """s [U] = [F(U)], and the characteristics of the shock's own family run into it."""
    left, middle, right = states(solution)
    for (h1, u1), (h2, u2), (begin, end), sign in (
        (left, middle, solution.speeds[:2], -1),
        (middle, right, solution.speeds[2:], 1),
    ):
        if begin < end or min(h1, h2) == 0.0 or abs(h1 - h2) < 1e-12:
            continue
        jump = np.array([h2 - h1, h2 * u2 - h1 * u1])
        np.testing.assert_allclose(begin * jump, flux(h2, u2) - flux(h1, u1), atol=2e-15 * (1 + max(h1, h2)) ** 2)
        assert u1 + sign * math.sqrt(BETA * h1) > begin > u2 + sign * math.sqrt(BETA * h2)


def test_fans_solve_the_equations(solution: Riemann) -> None:
    """Residual of (1) inside each fan, with a complex step in x and t, free of cancellation."""
    step = 1e-200
    for begin, end in (solution.speeds[:2], solution.speeds[2:]):
        for share in (0.1, 0.5, 0.9) if end - begin > 1e-9 else ():
            t = 1.3
            ray = begin + share * (end - begin)
            piece = 1 if (begin, end) == solution.speeds[:2] else 3

            def state(x: complex, t: complex, piece: int = piece) -> np.ndarray:
                sign, h, u = {1: (-1, solution.h_left, solution.u_left), 3: (1, solution.h_right, solution.u_right)}[
                    piece
                ]
                far = u - sign * 2 * np.sqrt(BETA * h)
                a = sign * ((x - solution.x0) / t - far) / 3
                return np.array([a * a / BETA, far + sign * 2 * a])

            x = solution.x0 + ray * t
            h, u = solution(x, t)
            np.testing.assert_allclose(state(x, t), [h, u], rtol=1e-14, atol=1e-15)  # the code is this formula
            (h_t, u_t), (h_x, u_x) = state(x, t + step * 1j).imag / step, state(x + step * 1j, t).imag / step
            assert h_t + u * h_x + h * u_x == pytest.approx(0, abs=1e-15)
            assert h * (u_t + u * u_x + BETA * h_x) == pytest.approx(0, abs=1e-15)


def test_pieces_meet(solution: Riemann) -> None:
    """Continuous at both ends of each fan, to the rounding of the ray."""
    t = 2.0
    for begin, end in (solution.speeds[:2], solution.speeds[2:]):
        for ray in (begin, end) if end - begin > 1e-9 else ():
            x = solution.x0 + t * ray + np.array([-1e-9, 1e-9])
            h, u = solution(x, t)
            assert h[0] == pytest.approx(h[1], abs=1e-8)
            assert h[0] * u[0] == pytest.approx(h[1] * u[1], abs=1e-8)


def test_box_balance(solution: Riemann) -> None:
    """Over a box that the waves have not left: mass and momentum change by what flows through its ends."""
    t = 0.9
    box = Cells(-12, 13, 400)
    h, q = solution.averages(box, t)
    h0, q0 = solution.averages(box, 0.0)
    left, _, right = states(solution)
    for now, before, inflow in zip((h, q), (h0, q0), flux(*left) - flux(*right), strict=True):
        assert np.sum(now - before) * box.dx == pytest.approx(t * inflow, abs=1e-12 * (1 + np.abs(now).sum()) * box.dx)


def test_averages_are_those_of_the_pointwise_solution(solution: Riemann) -> None:
    """Against the midpoint rule, cell by cell; cells that hold a jump are off by at most one of its 2000 points."""
    t, cells = 1.1, Cells(-6, 6, 24)
    h, q = solution.averages(cells, t)
    fine = Cells(-6, 6, 24 * 2000).x
    h_there, u_there = solution(fine, t)
    largest = np.max(np.abs(h_there * (1 + np.abs(u_there))))
    np.testing.assert_allclose(h, h_there.reshape(24, -1).mean(axis=1), atol=2e-3 * largest + 1e-15)
    np.testing.assert_allclose(q, (h_there * u_there).reshape(24, -1).mean(axis=1), atol=2e-3 * largest + 1e-15)


def test_averages_over_halved_cells_add_up(solution: Riemann) -> None:
    """An exact integral does not depend on where cells are cut."""
    coarse, fine = (solution.averages(Cells(-6, 6, count), 1.1) for count in (30, 60))
    for whole, halves in zip(coarse, fine, strict=True):
        np.testing.assert_allclose(whole, halves.reshape(-1, 2).mean(axis=1), rtol=1e-13, atol=1e-14)


def test_mirror_image(solution: Riemann) -> None:
    """x, u to -x, -u."""
    mirrored = Riemann(
        solution.h_right, -solution.u_right, solution.h_left, -solution.u_left, BETA, x0=-solution.x0
    )  # fmt: skip
    x = np.linspace(-5, 5, 401) + 1e-3
    h, u = solution(x, 1.7)
    h_mirrored, u_mirrored = mirrored(-x, 1.7)
    np.testing.assert_allclose(h, h_mirrored, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(u, -u_mirrored, rtol=1e-13, atol=1e-14)


def test_moving_observer_sees_the_same(solution: Riemann) -> None:
    """Galilei: another uniform velocity only carries the picture along (on wet ground; dry ground has no velocity)."""
    v, t = 0.8, 1.2
    carried = Riemann(
        solution.h_left, solution.u_left + v, solution.h_right, solution.u_right + v, BETA, x0=solution.x0
    )  # fmt: skip
    x = np.linspace(-5, 5, 401) + 1e-3
    h, u = solution(x, t)
    h_carried, u_carried = carried(x + v * t, t)
    np.testing.assert_allclose(h_carried, h, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(u_carried[h > 0], u[h > 0] + v, rtol=1e-12, atol=1e-13)


def test_start_is_the_data(solution: Riemann) -> None:
    x = np.array([-2.0, solution.x0, np.nextafter(solution.x0, 1), 3.0])
    h, u = solution(x, 0.0)
    np.testing.assert_array_equal(h, [solution.h_left] * 2 + [solution.h_right] * 2)
    wet = h > 0
    np.testing.assert_array_equal(u[wet], np.array([solution.u_left] * 2 + [solution.u_right] * 2)[wet])
    np.testing.assert_array_equal(u[~wet], 0.0)


def test_identical_states_stay() -> None:
    h, u = build("identical")(np.linspace(-3, 3, 50), 2.0)
    np.testing.assert_array_equal(h, 0.7)
    np.testing.assert_array_equal(u, 0.3)


def test_dry_dam_front_runs_at_twice_the_wave_speed() -> None:
    """Ritter (1892): front at 2 a, back at -a, h = 4/9 h0 and u = 2/3 a for ever at the dam."""
    dam = Riemann(1.0, 0.0, 0.0, 0.0, BETA)
    a = math.sqrt(BETA)
    assert dam.speeds == pytest.approx((-a, 2 * a, 2 * a, 2 * a), rel=1e-15)
    h, u = dam(0.0, 3.0)
    assert (h, u) == pytest.approx((4 / 9, 2 * a / 3), rel=1e-15)
    h, u = dam(2 * a + 0.01, 1.0)
    assert (h, u) == (0, 0)


def test_single_waves_have_no_second_one() -> None:
    """A state behind a shock by construction: the other wave has no strength."""
    shock = build("single shock")
    assert shock.middle == pytest.approx((shock.h_left, shock.u_left), rel=1e-14)


def test_random_states_have_one_middle(rng: np.random.Generator) -> None:
    """The middle state lies on both wave curves, over ten decades of height."""
    for h_left, h_right, u_left, u_right in zip(
        *10 ** rng.uniform(-6, 4, (2, 200)), *rng.normal(scale=2.0, size=(2, 200)), strict=True
    ):
        of = Riemann(h_left, u_left, h_right, u_right, BETA)
        h, u = of.middle
        if h == 0.0:
            assert u_right - u_left >= 2 * (math.sqrt(BETA * h_left) + math.sqrt(BETA * h_right))
            continue
        size = abs(u_left) + abs(u_right) + 2 * math.sqrt(BETA * max(h_left, h_right, h))
        for h_side, u_side, sign in ((h_left, u_left, -1), (h_right, u_right, 1)):
            if h > h_side:
                found = u_side + sign * (h - h_side) * math.sqrt(BETA / 2 * (1 / h + 1 / h_side))
            else:
                found = u_side + sign * 2 * (math.sqrt(BETA * h) - math.sqrt(BETA * h_side))
            assert found == pytest.approx(u, abs=1e-13 * size * max(1.0, math.sqrt(h / h_side)))


def test_speeds_ascend(rng: np.random.Generator) -> None:
    for h_left, h_right in itertools.product([0.0, 1e-6, 0.5, 1.0, 30.0], repeat=2):
        for u_left, u_right in rng.normal(size=(10, 2)):
            speeds = Riemann(h_left, u_left, h_right, u_right, BETA).speeds
            assert all(b >= a - 1e-13 * (1 + abs(a)) for a, b in itertools.pairwise(speeds))


@pytest.mark.parametrize("t", [-1e-9, math.nan, math.inf])
def test_only_times_after_the_start(t: float) -> None:
    with pytest.raises(kinsim.InputError, match="0 <= t"):
        build("two fans")(0.0, t)
    with pytest.raises(kinsim.InputError, match="0 <= t"):
        build("two fans").averages(Cells(-1, 1, 4), t)


def test_places_are_numbers() -> None:
    with pytest.raises(kinsim.InputError, match="not a number"):
        build("two fans")([0.0, math.nan], 1.0)


@pytest.mark.parametrize(
    "wrong", [{"h_left": -1.0}, {"h_right": math.nan}, {"beta": 0.0}, {"beta": -0.4}, {"u_left": math.inf}]
)
def test_data_outside_the_domain_are_refused(wrong: dict[str, float]) -> None:
    good = {"h_left": 1.0, "u_left": 0.0, "h_right": 0.5, "u_right": 0.0, "beta": 0.4}
    with pytest.raises(kinsim.InputError, match=next(iter(wrong))):
        Riemann(**{**good, **wrong})


def test_is_a_value() -> None:
    assert build("dry") == build("dry")
    assert "h_left=1.0" in repr(build("two fans"))
    with pytest.raises(AttributeError):
        build("dry").beta = 1.0  # type: ignore[misc]
