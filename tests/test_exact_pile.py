"""Piles at rest: the straight ones by the balance of forces, the random ones by their share of the Coulomb bound."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from kinsim import Cells, ConstantSlope, Coulomb, InputError, Macroscopic, Profile, Scene, step
from kinsim.exact import StaticPile, coulomb_fill, random_pile

EPS = float(np.finfo(float).eps)
BETA, PULL, RESISTANCE = 0.4, 0.1, 0.3

PILES = {
    "straight, dry toe": StaticPile(0.7, 0.7, BETA, PULL, RESISTANCE, 1.0),
    "peak on dry ground": StaticPile(0.9, -0.8, BETA, PULL, RESISTANCE, 2.0, 0.4),
    "on the bound, wet": StaticPile(1.0, -1.0, BETA, PULL, RESISTANCE, 2.0, -0.3, 0.5),
    "valley": StaticPile(-0.8, 0.6, BETA, PULL, RESISTANCE, 0.2),
    "lake on a slope": StaticPile(0.0, 0.0, BETA, -0.3, 0.0, 1.0),
    "level": StaticPile(-PULL / RESISTANCE, -PULL / RESISTANCE, BETA, PULL, RESISTANCE, 1.0),
    "steep ground, dry toe": StaticPile(0.5, 0.5, BETA, 0.6, 0.2, 1.0),
}


@pytest.fixture(params=PILES)
def pile(request: pytest.FixtureRequest) -> StaticPile:
    return PILES[request.param]


def test_forces_balance(pile: StaticPile) -> None:
    """Over any interval, jumps and kinks included: [beta h^2/2] = s mass + friction, |friction| <= R mass.

    Beside the kinks friction is the stated share of R.
    """
    for left, right in ((-9.0, 9.0), (-1.2, 0.3), (0.5, 1.7), (-30.0, -2.0)):
        cells = Cells(left, right, 2)
        mass = pile.averages(cells, 3.0)[0].sum() * cells.dx
        ends, _ = pile([left, right], 3.0)
        friction = BETA / 2 * (ends[1] ** 2 - ends[0] ** 2) - pile.pull * mass
        assert abs(friction) <= pile.resistance * mass + 32 * EPS * (1 + ends.max()) ** 2
    step = 1e-4
    for x, theta in ((pile.x0 - 0.3, pile.theta_left), (pile.x0 + 0.3, pile.theta_right)):
        (low, high), (mid, _) = pile([x - step, x + step], 0.0)[0], pile([x, x], 0.0)[0]
        if mid > pile.floor:
            share = BETA * (high - low) / (2 * step) - pile.pull - theta * pile.resistance
            assert share == pytest.approx(0.0, abs=4 * EPS / step)


def test_pile_rests_and_is_continuous(pile: StaticPile) -> None:
    x = np.linspace(-8, 8, 100_001)
    h, u = pile(x, 7.0)
    assert (h >= pile.floor).all()
    np.testing.assert_array_equal(u, 0.0)
    np.testing.assert_array_equal(h, pile(x, 0.0)[0])
    assert np.abs(np.diff(h)).max() <= 1.001 * max(map(abs, pile.slopes)) * 16 / 100_000 + 4 * EPS
    assert pile(pile.x0, 0.0)[0] == pile.h0


def test_toes(pile: StaticPile) -> None:
    """The pile reaches its floor there, and stays on it."""
    for toe, away in zip(pile.toes, (-1.0, 1.0), strict=True):
        if math.isfinite(toe):
            assert pile(toe + 0.5 * away, 0.0)[0] == pile.floor
            assert pile(toe, 0.0)[0] == pytest.approx(pile.floor, abs=8 * EPS)
            assert pile(toe - 1e-3 * away, 0.0)[0] > pile.floor
    assert any(map(math.isfinite, PILES["straight, dry toe"].toes))
    assert all(map(math.isfinite, PILES["on the bound, wet"].toes))


def test_averages_are_exact(pile: StaticPile) -> None:
    """By the trapezoidal rule on the pieces between the kinks, which a line needs no more than."""
    cells = Cells(-6, 7, 29)
    edges = np.linspace(-6, 7, 30)
    h, q = pile.averages(cells, 1.0)
    for i, (left, right) in enumerate(itertools.pairwise(edges)):
        cuts = np.array([left, *sorted(k for k in (*pile.toes, pile.x0) if left < k < right), right])
        there = pile(cuts, 0.0)[0]
        area = 0.5 * np.sum((there[1:] + there[:-1]) * np.diff(cuts))
        assert h[i] == pytest.approx(area / cells.dx, rel=1e-13, abs=1e-14)
    np.testing.assert_array_equal(q, 0.0)


def test_mirror_image(pile: StaticPile) -> None:
    mirrored = StaticPile(
        -pile.theta_right, -pile.theta_left, BETA, -pile.pull, pile.resistance, pile.h0, -pile.x0, pile.floor
    )
    x = np.linspace(-5, 5, 201)
    np.testing.assert_array_equal(pile(x, 0.0)[0], mirrored(-x, 0.0)[0])


def test_piles_outside_their_domain() -> None:
    for given, message in (
        ({"theta_left": 1.0 + 1e-9}, "theta_left"),
        ({"theta_right": -1.1}, "theta_right"),
        ({"floor": 1.1}, "below the floor"),
        ({"floor": 0.1, "pull": 0.4}, "would slide"),
        ({"resistance": -0.1}, "resistance"),
    ):
        good = {"theta_left": 0.5, "theta_right": -0.5, "beta": BETA, "pull": PULL, "resistance": RESISTANCE}
        with pytest.raises(InputError, match=message):
            StaticPile(**{**good, **given})
    for t in (-1.0, math.nan):
        with pytest.raises(InputError, match="0 <= t"):
            PILES["level"](0.0, t)
    with pytest.raises(InputError, match="not a number"):
        PILES["level"](math.nan, 0.0)


GROUND = {"pull": PULL, "resistance": RESISTANCE, "beta": BETA}


@pytest.mark.parametrize("fill", [0.0, 0.4, 1.0, 1.3])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 60, 61])
def test_random_piles_fill_what_they_say(fill: float, count: int) -> None:
    """The steepest place by differences written out here, to the rounding of sums of `count` heights.

    On a slope an odd number of cells has no pile per cell with fill 0: copied ghosts halve the slope at both ends.
    """
    cells = Cells(-2, 3, count)
    for per, seed in itertools.product(("face", "cell"), range(5)):
        if (per, fill, count % 2) == ("cell", 0.0, 1):
            with pytest.raises(InputError, match="no fill of 0"):
                random_pile(cells, **GROUND, fill=fill, per=per, rng=seed)
            continue
        h = random_pile(cells, **GROUND, fill=fill, per=per, rng=seed, lowest=0.5).h
        if per == "face":
            slopes = [(h[i + 1] - h[i]) / cells.dx for i in range(count - 1)]
        else:
            slopes = [(h[min(i + 1, count - 1)] - h[max(i - 1, 0)]) / (2 * cells.dx) for i in range(count)]
        theta = (BETA * np.array(slopes) - PULL) / RESISTANCE
        rounding = 8 * EPS * count * h.max() * BETA / (RESISTANCE * cells.dx)
        assert np.abs(theta).max() == pytest.approx(fill, abs=rounding)
        assert coulomb_fill(h, cells.dx, **GROUND, per=per) == pytest.approx(np.abs(theta).max(), abs=rounding)
        assert h.min() == 0.5


def test_piles_per_cell_may_be_steeper_between_cells(rng: np.random.Generator) -> None:
    """(22) sees no zigzag: admissible per cell, far outside the bound per face; not the other way round."""
    cells = Cells(-4, 4, 100)
    dx = cells.dx
    rough = random_pile(cells, **GROUND, fill=0.9, per="cell", rng=rng).h
    assert coulomb_fill(rough, dx, **GROUND, per="cell") < 1 < 2 < coulomb_fill(rough, dx, **GROUND, per="face")
    smooth = random_pile(cells, **GROUND, fill=0.9, per="face", rng=rng).h
    assert coulomb_fill(smooth[1:-1], dx, **GROUND, per="face") <= 0.9 + 1e-12
    inner = (smooth[2:] - smooth[:-2]) / (2 * dx)
    assert np.abs(BETA * inner - PULL).max() <= (0.9 + 1e-12) * RESISTANCE


def test_random_piles_repeat_and_differ() -> None:
    cells = Cells(0, 1, 20)
    first, again, other = (random_pile(cells, **GROUND, fill=0.5, per="cell", rng=seed) for seed in (1, 1, 2))
    assert first == again != other
    assert isinstance(first, Profile)


@pytest.mark.parametrize("fill", [0.6, 1 - 1e-9, 1 + 1e-9, 1.4])
@pytest.mark.parametrize("count", [40, 41])
def test_scheme_2_holds_what_fills_less_than_the_bound(fill: float, count: int, rng: np.random.Generator) -> None:
    """(22) reads these very differences: with fill <= 1 nothing moves in a step, with fill > 1 something does."""
    zeta, dt = math.asin(PULL), 0.01
    ground = {"pull": PULL, "resistance": RESISTANCE, "beta": BETA}
    chute, friction = ConstantSlope(zeta), Coulomb(math.atan(RESISTANCE / math.cos(zeta)))
    cells = Cells(-1, 1, count)
    heap = random_pile(cells, **ground, fill=fill, per="cell", rng=rng)
    scene = Scene(cells=cells, heap=heap, chute=chute, friction=friction, epsilon=BETA / math.cos(zeta))
    after = step(scene, Macroscopic(2), *scene.initial(), dt)
    moved = float(np.abs(after.q1).max())
    if fill < 1:
        assert moved <= 32 * EPS * heap.h.max() ** 2
        np.testing.assert_array_equal(after.h1, heap.h)
    else:
        assert moved >= 0.5 * (fill - 1) * dt * RESISTANCE * heap.h.min()


def test_random_piles_outside_their_domain() -> None:
    cells = Cells(0, 1, 20)
    good = {**GROUND, "fill": 0.5, "per": "cell", "rng": 1}
    for given, message in (
        ({"resistance": 0.0}, "resistance"),
        ({"beta": -1.0}, "beta"),
        ({"pull": math.nan}, "pull"),
        ({"fill": -0.1}, "fill"),
        ({"fill": math.inf}, "fill"),
        ({"lowest": -1.0}, "lowest"),
        ({"per": "node"}, "'face' or 'cell'"),
    ):
        with pytest.raises(InputError, match=message):
            random_pile(cells, **{**good, **given})
    with pytest.raises(InputError, match="no fill of"):
        random_pile(Cells(0, 1, 3), pull=0.5, resistance=0.1, beta=BETA, fill=0.1, per="cell", rng=1)
