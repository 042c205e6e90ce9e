"""Bodies under Coulomb friction: the uniform slide and the sliding wedge, with what comes after the arrest."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from residual import Formula, residual

import kinsim
from kinsim import Cells
from kinsim.exact import Motion, SlidingWedge, UniformSlide

BETA = 0.4
EPS = float(np.finfo(float).eps)

MOTIONS = {
    "runs": Motion(0.5, 0.6, 0.2),
    "slows down and stays": Motion(1.0, 0.1, 0.5),
    "slows down and turns": Motion(1.0, -0.6, 0.5),
    "turns, from the left": Motion(-0.7, 0.6, 0.2),
    "rests": Motion(0.0, 0.3, 0.3),
    "starts": Motion(0.0, -0.5, 0.2),
    "without friction": Motion(1.0, -0.4, 0.0),
    "coasts": Motion(0.8, 0.3, 0.3),
    "nothing": Motion(0.0, 0.0, 0.0),
}


@pytest.fixture(params=MOTIONS)
def motion(request: pytest.FixtureRequest) -> Motion:
    return MOTIONS[request.param]


def test_motion_is_that_of_an_implicit_integrator(motion: Motion) -> None:
    """Implicit Euler for u' + R Sgn(u) containing D is soft thresholding; it is exact but in the step of the arrest.

    There it errs by dt (|D| + R) at most, and so it does ever after; in the way by t times that, and by the dt u of the
    rectangle rule.
    """
    steps, end = 20_000, 4.0
    dt, u, way = end / steps, motion.u0, 0.0
    bound = dt * (abs(motion.drive) + motion.resistance)
    for n in range(1, steps + 1):
        pulled = u + dt * motion.drive
        u = math.copysign(max(abs(pulled) - dt * motion.resistance, 0.0), pulled)
        way += dt * u
        if n % 1000 == 0:
            exact_u, exact_way = motion(n * dt)
            assert u == pytest.approx(exact_u, abs=bound + 1e-11)
            assert way == pytest.approx(exact_way, abs=(n * dt) * 2 * bound + dt * 2 + 1e-11)


def test_mirrored_motion(motion: Motion) -> None:
    mirrored = Motion(-motion.u0, -motion.drive, motion.resistance)
    for t in (0.0, 0.7, 3.1):
        assert mirrored(t) == tuple(-value for value in motion(t))


def test_arrest() -> None:
    """u0/(R - s), and what happens then: it stays iff |D| <= R."""
    stays, turns = MOTIONS["slows down and stays"], MOTIONS["slows down and turns"]
    assert stays.arrest == 1.0 / (0.5 - 0.1)
    assert stays(stays.arrest)[0] == 0.0
    assert stays(1e6) == (0.0, pytest.approx(0.5 * 2.5, rel=2 * EPS))
    assert turns(turns.arrest + 2.0)[0] == pytest.approx(2.0 * (-0.6 + 0.5), rel=8 * EPS)
    assert MOTIONS["runs"].arrest == MOTIONS["coasts"].arrest == math.inf
    assert MOTIONS["coasts"](9.0)[0] == 0.8


def test_uniform_slide_is_everywhere_the_same() -> None:
    slide = UniformSlide(u0=1.0, pull=0.1, resistance=0.5, h=0.7)
    h, u = slide([[-3.0, 0.0], [2.0, 1e9]], 0.5)
    assert h.shape == u.shape == (2, 2)
    assert (h == 0.7).all()
    assert u == pytest.approx(1.0 - 0.4 * 0.5, rel=2 * EPS)
    averages = slide.averages(Cells(-1, 1, 4), 0.5)
    np.testing.assert_array_equal(averages, [[0.7] * 4, [0.7 * u[0, 0]] * 4])


def test_level_wedge_is_a_uniform_slide() -> None:
    x = np.linspace(-2, 2, 9)
    for t in (0.0, 1.0, 9.0):
        np.testing.assert_array_equal(
            SlidingWedge(0.7, 0.0, 1.0, BETA, 0.1, 0.5)(x, t), UniformSlide(1.0, 0.1, 0.5, 0.7)(x, t)
        )


WEDGES = {
    "runs": SlidingWedge(2.0, 0.1, 0.5, BETA, 0.4, 0.2),
    "stays": SlidingWedge(2.0, -0.2, 0.3, BETA, 0.1, 0.4),
    "turns": SlidingWedge(2.0, 0.3, 0.3, BETA, -0.2, 0.1),
    "from the left": SlidingWedge(2.0, 0.3, -0.6, BETA, 0.5, 0.1),
    "toe, running": SlidingWedge(0.5, -0.5, 0.5, BETA, 0.4, 0.2),
    "toe, that stays": SlidingWedge(0.4, -0.5, 0.3, BETA, 0.0, 0.4),
}


@pytest.fixture(params=WEDGES)
def wedge(request: pytest.FixtureRequest) -> SlidingWedge:
    return WEDGES[request.param]


def formula_about(wedge: SlidingWedge, t: float) -> tuple[Formula, float]:
    """h and u about the time t, with the velocity as a polynomial in t, and the source.

    The source is s - sgn(u) R where it moves, and what keeps it at rest, beta b, where it does not.
    """
    motion, turned = wedge.motion, t > wedge.motion.arrest
    moving = motion(t)[0]
    start = motion.arrest if turned else 0.0
    source = wedge.pull - math.copysign(wedge.resistance, moving) if moving else BETA * wedge.b
    u_start, way_start = motion(start)
    g = source - BETA * wedge.b

    def formula(x: object, t: object) -> tuple[object, object]:
        after = t - start
        u = u_start + g * after
        return wedge.a + wedge.b * (x - way_start - u_start * after - g * after**2 / 2), u

    return formula, source


def test_wedge_solves_the_equations(wedge: SlidingWedge) -> None:
    """Residual in 40 digits of the formula, which the code is."""
    for t in (0.3, 1.2, 2.9):
        formula, source = formula_about(wedge, t)
        assert abs(source - wedge.pull) <= wedge.resistance * (1 + EPS)  # friction never pulls harder than it can
        assert residual(formula, BETA, source, 0.4, t) < 1e-15
        np.testing.assert_allclose(wedge(0.4, t), [float(value) for value in formula(0.4, t)], rtol=1e-14, atol=1e-14)


def test_wedge_averages_are_exact(wedge: SlidingWedge) -> None:
    """h is linear, so that its average is its value at the centre of what is wet; u is the same there."""
    cells, toe = Cells(-2, 3, 13), wedge.toe(1.7)
    edges = np.linspace(-2, 3, 14)
    if wedge.b < 0.0:
        begin, end = edges[:-1], np.maximum(np.minimum(edges[1:], toe), edges[:-1])
    else:
        begin, end = np.minimum(np.maximum(edges[:-1], toe), edges[1:]), edges[1:]
    h, u = wedge(0.5 * (begin + end), 1.7)
    h *= (end - begin) / cells.dx
    averages = wedge.averages(cells, 1.7)
    np.testing.assert_allclose(averages, [h, h * u], rtol=8 * EPS, atol=8 * EPS)


def test_mirrored_wedge(wedge: SlidingWedge) -> None:
    mirrored = SlidingWedge(wedge.a, -wedge.b, -wedge.u0, BETA, -wedge.pull, wedge.resistance)
    x = np.linspace(-2, 2, 21)
    for t in (0.0, 1.0, 2.5):
        (h, u), (h_mirrored, u_mirrored) = wedge(x, t), mirrored(-x, t)
        np.testing.assert_array_equal(h, h_mirrored)
        np.testing.assert_array_equal(u, -u_mirrored)


def test_wedge_is_arrested_iff_the_slope_is_admissible(rng: np.random.Generator) -> None:
    """Definition 1: |s - beta b| <= R; else it moves after any arrest."""
    seen = set()
    for b, u0, pull, resistance in zip(
        rng.normal(size=300), rng.normal(size=300), rng.normal(size=300), rng.uniform(0.1, 2.0, 300), strict=True
    ):
        motion = SlidingWedge(1.0, b, u0, BETA, pull, resistance).motion
        admissible = abs(pull - BETA * b) <= resistance
        assert (motion(1e6)[0] == 0.0) == admissible
        seen.add((admissible, motion.arrest < math.inf))
    assert seen == {(True, True), (False, True), (False, False)}


def test_wedge_ends_where_it_is_dry() -> None:
    """The toe goes the way of the wedge, so that the mass beside it stays; h and q end in 0 there."""
    wedge = SlidingWedge(1.0, -0.5, 0.4, BETA, 0.3, 0.2)
    assert wedge([1.0, 2.0, 2.001, 9.0], 0.0)[0].tolist() == [0.5, 0.0, 0.0, 0.0]
    assert wedge([2.0, 9.0], 0.0)[1].tolist() == [0.0, 0.0]
    for t in (0.0, 0.7, 3.0):
        way = wedge.motion(t)[1]
        assert wedge.toe(t) == pytest.approx(2.0 + way, abs=8 * EPS * (1 + way))
        h, q = wedge.averages(Cells(way, way + 20, 41), t)
        assert h.sum() * 20 / 41 == pytest.approx(1.0, rel=1e-13)
        assert q.sum() * 20 / 41 == pytest.approx(wedge.motion(t)[0], rel=1e-13)
        assert wedge(wedge.toe(t) - 1e-9, t)[0] == pytest.approx(0.5e-9, rel=1e-5)
    assert SlidingWedge(1.0, 0.0, 0.4, BETA).toe(1.0) == math.inf


@pytest.mark.parametrize("exact", [UniformSlide(1.0, 0.0), SlidingWedge(1.0, 0.1, 0.0, BETA)])
def test_questions_outside(exact: UniformSlide | SlidingWedge) -> None:
    for t in (-1.0, math.nan, math.inf):
        with pytest.raises(kinsim.InputError, match="0 <= t"):
            exact(0.0, t)
        with pytest.raises(kinsim.InputError, match="0 <= t"):
            exact.averages(Cells(-1, 1, 2), t)
    with pytest.raises(kinsim.InputError, match="not a number"):
        exact(math.nan, 1.0)
    with pytest.raises(kinsim.InputError, match=r"^averages: cells is of type int; give kinsim.Cells"):
        exact.averages(5, 0.1)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [{"resistance": -0.1}, {"h": 0.0}, {"u0": math.nan}])
def test_data_outside(wrong: dict[str, float]) -> None:
    with pytest.raises(kinsim.InputError, match=next(iter(wrong))):
        UniformSlide(**{"u0": 1.0, "pull": 0.1, **wrong})


def test_kinsim_alone_loads_no_scipy() -> None:
    """Exact solutions load when they are used."""
    code = "import sys, kinsim; kinsim.Cells; sys.exit('scipy' in sys.modules or 'kinsim.exact' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
