"""What the paper assumes: cells, chute, friction, heaps, ends; and that all of it are values."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, replace
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENES

import kinsim
from kinsim import (
    Blocks,
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Expression,
    Fixed,
    Frictionless,
    InputError,
    Kinetic,
    Macroscopic,
    Parabola,
    Profile,
    Scene,
    Sine,
    Table,
    Uniform,
)  # fmt: skip
from kinsim.schemes.tile import OPEN, RING, STREAM, WALL, End
from kinsim.solver.march import fill

VALUES = [
    Cells(-1, 1, 4), ConstantSlope("pi/6"), Coulomb(0.3), Frictionless(), Blocks((0,), (1, 2)), Parabola(), Sine(),
    Expression("1 + x**2"), Profile([1.0, 2.0]), Uniform(64), Kinetic(), Macroscopic(), Fixed(1e-3, 5), Courant(0.9, 1),
    Scene(Cells(-1, 1, 4), Parabola()),
]  # fmt: skip


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_are_frozen_equal_and_readable(value: object) -> None:
    """`repr` is Python that gives the value back."""
    name = next(iter(type(value).__dataclass_fields__))
    with pytest.raises(FrozenInstanceError):
        setattr(value, name, 1)
    again = eval(repr(value), vars(kinsim) | {each: getattr(kinsim, each) for each in kinsim.__all__})
    assert again == value
    assert hash(again) == hash(value)
    assert replace(value) == value  # type: ignore[type-var]
    assert value != object()


def test_different_values_differ() -> None:
    assert Cells(-1, 1, 4) != Cells(-1, 1, 5)
    assert Frictionless() != Coulomb(0.0)
    assert Profile([1.0, 2.0]) != Profile([1.0, 2.1])
    assert Profile([1.0, 2.0]) == Profile([1.0, 2.0], [0.0, 0.0])
    assert Fixed(1e-3, 5) != Courant(1e-3, 5)


def test_cell_centres() -> None:
    """left + (i + 1/2) dx, and mirrored ends give bitwise mirrored centres."""
    cells = Cells(-3, 11, 280)
    assert cells.dx == pytest.approx(0.05, rel=1e-15)
    np.testing.assert_allclose(cells.x, -3 + (np.arange(280) + 0.5) * 0.05, atol=4e-15)
    for half, count in ((8, 320), (0.7, 33), (math.pi, 1000)):
        x = Cells(-half, half, count).x
        np.testing.assert_array_equal(x, -x[::-1])


def test_blocks_jump_at_their_edges() -> None:
    """An edge belongs to the block on its left: h = h_l if x <= x0."""
    h, u = Blocks((-1, 1), (0.3, 2.3, 0.3))(np.array([-2, -1, np.nextafter(-1, 0), 0, 1, np.nextafter(1, 2)]))
    np.testing.assert_array_equal(h, [0.3, 0.3, 2.3, 2.3, 2.3, 0.3])
    np.testing.assert_array_equal(u, 0)


def test_heaps_may_move():
    x = np.array([-2.0, -1.0, 0.0, 1.0, 1.5])
    np.testing.assert_array_equal(Blocks((-1, 1), (0.3, 2.3, 0.3), (1, 0, -2))(x)[1], [1, 1, 0, 0, -2])
    for heap in (Parabola(velocity=0.4), Sine(velocity=0.4)):
        np.testing.assert_array_equal(heap(x)[1], np.full(5, 0.4))
        np.testing.assert_array_equal(heap(x)[0], type(heap)()(x)[0])


def test_parabola_and_sine_are_the_papers() -> None:
    x = np.linspace(-4, 4, 1001)
    h, u = Parabola(peak=1, steepness=4)(x)
    np.testing.assert_array_equal(h, np.maximum(0.1, 1 - 4 * x**2))
    assert not u.any()
    h, u = Sine(0.6)(x)
    y = x - 0.6
    inside = np.maximum(0.9 * np.sin(np.pi * y) - 0.3 * np.sin(2 * np.pi * y), 0.1)
    np.testing.assert_allclose(h, np.where((x > 0.6) & (x < 1.6), inside, 0.1), rtol=1e-15)
    assert not u.any()


def test_expression_and_profile_and_table_say_the_same(tmp_path: Path) -> None:
    cells = Cells(0, 1, 10)
    h, u = 1 + cells.x**2, 0.1 * cells.x
    path = tmp_path / "heap.csv"
    rows = [f"{x!r},{a!r},{b!r}" for x, a, b in zip(cells.x.tolist(), h.tolist(), u.tolist(), strict=True)]
    path.write_text("# a comment\nx, h, u\n" + "\n".join(rows) + "\n\n")
    scenes = [Scene(cells, heap) for heap in (Expression("1 + x**2", "0.1*x"), Profile(h, u), Table(path))]
    for scene in scenes:
        np.testing.assert_allclose(scene.initial(), [h, h * u], rtol=1e-15)


def test_table_is_linear_between_rows_and_constant_beyond(tmp_path: Path) -> None:
    path = tmp_path / "heap.csv"
    path.write_text("x,h\n0,1\n2,3\n")
    h, u = Table(path)(np.array([-1.0, 0.0, 0.5, 2.0, 9.0]))
    np.testing.assert_array_equal(h, [1, 1, 1.5, 3, 3])
    np.testing.assert_array_equal(u, 0)


@pytest.mark.parametrize("name", SCENES)
def test_beta_and_resistance_are_derived(name: str) -> None:
    scene, _ = SCENES[name]
    assert scene.beta == pytest.approx(scene.epsilon * math.cos(scene.chute.zeta), rel=1e-15)
    assert scene.resistance == pytest.approx(math.cos(scene.chute.zeta) * math.tan(scene.friction.delta), rel=1e-15)


def test_ghosts() -> None:
    """Two beyond each end: open ends copy, walls mirror and turn u, a ring goes on, a stream is itself."""
    for kind, h_ghosts, q_ghosts in (
        (OPEN, (1, 1, 3, 3), (5, 5, 7, 7)),
        (WALL, (2, 1, 3, 2), (-6, -5, -7, -6)),
        (RING, (2, 3, 1, 2), (6, 7, 5, 6)),
        (STREAM, (4, 4, 4, 4), (8, 8, 8, 8)),
    ):
        h, q = np.array([9.0, 9, 1, 2, 3, 9, 9]), np.array([9.0, 9, 5, 6, 7, 9, 9])
        fill(End(kind, 4.0, 2.0), h, q, 1, 1)
        fill(End(kind, 4.0, 2.0), h, q, 5, -1)
        np.testing.assert_array_equal(h, [*h_ghosts[:2], 1, 2, 3, *h_ghosts[2:]])
        np.testing.assert_array_equal(q, [*q_ghosts[:2], 5, 6, 7, *q_ghosts[2:]])


TWO = Cells(0, 1, 2)

BAD = [
    (lambda: Cells(1, -1, 4), r"left.*right"),
    (lambda: Cells(1, 1, 4), r"left.*right"),
    (lambda: Cells(0, 1, 1), "count"),
    (lambda: Cells(0, math.nan, 4), "right"),
    (lambda: Cells(0, 1, 4.5), "count"),
    (lambda: Cells(0, 1, True), "count"),
    (lambda: Cells(0, "wide", 4), "right"),
    (lambda: Cells(0, 1, 4, colour=3), r"unknown key"),
    (lambda: Cells(left=0, rigth=1, count=4), r"rigth|right"),
    (lambda: ConstantSlope(math.pi / 2), "zeta"),
    (lambda: ConstantSlope(-2), "zeta"),
    (lambda: Coulomb(-0.1), "delta"),
    (lambda: Coulomb("pi/2"), "delta"),
    (lambda: Coulomb(math.nan), "delta"),
    (lambda: Scene(TWO, Profile([1.0, 1.0]), epsilon=0), "epsilon"),
    (lambda: Scene(TWO, Profile([1.0, 1.0]), epsilon=-0.1), "epsilon"),
    (lambda: Scene(TWO, Profile([1.0, 1.0]), k=0), "k"),
    (lambda: Scene(TWO, Profile([1.0, 1.0]), boundary="shut"), "boundary"),
    (lambda: Scene(TWO, Profile([1.0, 1.0]), boundary=("periodic", "open")), "boundary"),
    (lambda: Scene(TWO, Profile([1.0, -1e-9])), r"height -1e-09 at x = 0\.75"),
    (lambda: Scene(TWO, Profile([1.0, math.nan])), "finite"),
    (lambda: Scene(TWO, Profile([1.0, 1.0, 1.0])), r"3 values.*2 cells|3.*2 cells"),
    (lambda: Scene(TWO, Profile([1.0, 1.0], [0.0])), "u 1"),
    (lambda: Scene(TWO, Expression("0.5 - x")), r"height -0\.25 at x = 0\.75"),
    (lambda: Scene(TWO, Expression("1/(x - 0.25)")), r"0\.25"),
    (lambda: Expression("h0 + x"), "h0"),
    (lambda: Blocks((0, 0), (1, 2, 3)), "increase"),
    (lambda: Blocks((0, 1), (1, 2)), "heights"),
    (lambda: Blocks((0,), (1, 2), (0,)), "velocities"),
    (lambda: Fixed(0, 5), "dt"),
    (lambda: Fixed(-1e-3, 5), "dt"),
    (lambda: Fixed(1e-3, 0), "steps"),
    (lambda: Fixed(1e-3, 1.5), "steps"),
    (lambda: Courant(0, 1), "number"),
    (lambda: Courant(0.9, -1), "end"),
    (lambda: Uniform(7), "odd"),
    (lambda: Uniform(0), "count"),
    (lambda: Uniform(8, 0.0), "bound"),
    (lambda: Macroscopic(5), "scheme"),
    (lambda: Macroscopic(3, order=2), "belongs to scheme 4"),
    (lambda: Kinetic(4, limiter="mc"), "belongs to order 2"),
    (lambda: Macroscopic(4, order=2, statics="reflect"), "belongs to order 1"),
    (lambda: Macroscopic(3, "both"), "coupling"),
    (lambda: Kinetic(equilibrium="exact"), "equilibrium"),
    (lambda: Table("nowhere.csv"), "nowhere.csv"),
]


@pytest.mark.parametrize(("make", "named"), BAD)
def test_bad_values_are_refused_in_one_line_that_names_the_place(make, named) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=named) as refused:
        make()
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("", "first line"),
        ("x;h\n0;1\n1;1\n", "first line"),
        ("h,x\n0,1\n1,1\n", "first line"),
        ("x,h\n0,1\n", "two rows"),
        ("x,h\n0,1\n1\n", "2 numbers"),
        ("x,h\n0,1\n1,tall\n", "2 numbers"),
        ("x,h\n0,1\n1,nan\n", "finite"),
        ("x,h\n0,1\n0,2\n", "does not increase at data row 2"),
        ("x,h\n0,1\n1,1\n0.5,1\n", "does not increase at data row 3"),
    ],
)
def test_bad_tables_are_refused(text: str, named: str, tmp_path: Path) -> None:
    path = tmp_path / "heap.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=named) as refused:
        Table(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_numbers_may_be_written_as_the_paper_writes_them() -> None:
    assert Coulomb("pi/10") == Coulomb(math.pi / 10)
    assert Cells("-2*pi", np.float64(1), np.int64(4)) == Cells(-2 * math.pi, 1.0, 4)


def test_profiles_do_not_change_with_what_they_were_made_of() -> None:
    h = np.ones(2)
    profile = Profile(h)
    h[:] = 7
    np.testing.assert_array_equal(profile.h, 1)
    with pytest.raises(ValueError, match="read-only"):
        profile.h[0] = 3
    scene = Scene(TWO, profile)
    scene.initial()[0][:] = 5
    np.testing.assert_array_equal(scene.initial()[0], 1)
