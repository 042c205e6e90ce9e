"""Whole runs over extreme inputs: refused before, or stopped with a verdict, or sound; never a NaN or a traceback."""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import TypeVar

import numpy as np
import psutil
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory.extremes import attempt, draw, wrong

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fixed,
    InputError,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    Window,
    simulate,
    step,
)  # fmt: skip
from kinsim.schemes.formulas import is_dry

T = TypeVar("T")


class Drawn:
    """Dice that hypothesis throws, and shrinks."""

    def __init__(self, draw: Callable[..., object]) -> None:
        self._draw = draw

    def choice(self, among: Sequence[T]) -> T:
        return self._draw(st.sampled_from(among))  # type: ignore[return-value]


@settings(max_examples=40)
@given(st.data())
def test_any_run_is_refused_or_stopped_or_sound(data: st.DataObject) -> None:
    """Warnings are errors here; any error but the one-line refusal passes through."""
    _, bad = attempt(Drawn(data.draw))
    assert not bad


def test_the_space_holds_what_it_should() -> None:
    """Runs that end, are refused and are stopped; all schemes, wings and orders."""
    kinds = Counter(attempt(random.Random(seed))[0] for seed in range(40))
    assert {"finished", "refused", "too-many-steps"} <= set(kinds)
    asked = [_drawn(seed) for seed in range(400)]
    methods = [one.method for one in asked if one]
    assert {method.scheme for method in methods} == {1, 2, 3, 4}
    assert {method.order for method in methods} == {1, 2}
    assert {getattr(method, "equilibrium", "") for method in methods} == {
        "", "cell-average", "sampled", "matched", "entropic"}  # fmt: skip
    assert len({type(getattr(method, "velocity", None)) for method in methods}) == 4


def _drawn(seed: int) -> object:
    try:
        return draw(random.Random(seed))
    except InputError:
        return None


def test_the_property_can_fail() -> None:
    """A number that is none is seen, and the look for faults is what keeps it out."""
    scene = Scene(Cells(0, 1, 4), Profile((1.0, 0.0, 2.0, 0.5), (1e8, 0.0, -1e8, 0.0)), friction=Coulomb(0.3))
    asked = SimpleNamespace(scene=scene, method=Macroscopic(2))
    run = simulate(scene, Macroscopic(2), Fixed(1e30, 20), 1, force=True)
    assert run.verdict.kind == "non-finite"
    assert f"step {run.steps + 1}: " in str(run.verdict)
    assert "in cell" in str(run.verdict)
    assert wrong(asked, run) == ""
    spoiled = run.h.copy()
    spoiled[-1, 2] = np.nan
    assert "not finite" in wrong(asked, replace(run, h=spoiled))


@pytest.mark.parametrize("method", [Macroscopic(1), Macroscopic(4), Macroscopic(4, statics="reflect")], ids=repr)
def test_heights_never_fall_below_zero_at_courant_1(method: Macroscopic) -> None:
    """Exactly 1, and fast dry-ended masses, where all that a cell holds leaves it: rounding leaves no height."""
    dice = np.random.default_rng(3)
    for _ in range(300):
        h = 10.0 ** dice.uniform(-60, 1, 12) * (dice.random(12) < 0.7)
        u = dice.choice([-1.0, 0.0, 1.0, 1e4], 12) * np.sqrt(0.8 * h)
        scene = Scene(Cells(0, 1, 12), Profile(h, u), ConstantSlope(0.2), Coulomb(0.1), "periodic", epsilon=0.4)
        dt = scene.cells.dx / scene.fastest if scene.fastest else 0.0
        taken = step(scene, method, h, h * u, dt or 1.0)
        assert taken.h1.min() >= 0.0
        assert not (taken.q1[taken.h1 == 0.0]).any()
        assert math.fsum(taken.h1) == pytest.approx(math.fsum(h), rel=1e-14)


def test_a_rounding_below_zero_is_cut_and_a_broken_bound_is_shown() -> None:
    """Beyond (28) scheme 1 does fall below 0, and has to show it."""
    assert is_dry(1.0, 1.0, 1.0, -8e-53)
    assert is_dry(1.0, 1.0, 1.0, 1e-310)
    assert not is_dry(1.0, 1.0, 1.0, -1e-3)
    assert not is_dry(1.0, 1.0, 1.0, math.nan)


def test_a_refusal_in_the_middle_keeps_what_there_is() -> None:
    """A window that would need too many cells stops the run with a verdict."""
    scene = Scene(Cells(0, 1, 8), Profile(np.ones(8), np.linspace(0, 3, 8)), ConstantSlope(1.5), boundary="periodic")
    run = simulate(scene, Kinetic(4, Window(0.05)), Fixed(1e3, 9), force=True)
    assert run.verdict.kind == "refused"
    assert str(run.verdict).startswith(f"step {run.steps + 1}: velocity: a window of")
    assert run.t[-1] == run.steps * 1e3 > 0
    assert all(np.isfinite(column).all() for column in run.entries.values())


def test_a_run_that_is_stopped_shows_f_of_its_last_state() -> None:
    """To the bit what the same steps leave in a run that ends there, though f went on to a step that was given up."""
    scene = Scene(Cells(0, 1, 8), Profile(np.linspace(1, 2, 8)), ConstantSlope(0.5), boundary="periodic", epsilon=0.4)
    stopped = simulate(scene, Kinetic(4, Window(0.05)), Courant(0.9, 1e3, most=7), 100)
    ended = simulate(scene, Kinetic(4, Window(0.05)), stopped.replay, 100)
    assert (stopped.verdict.kind, ended.verdict.kind) == ("too-many-steps", "finished")
    for name, column in ended.entries.items():
        np.testing.assert_array_equal(stopped.entries[name], column, err_msg=name)


def test_summing_anew_is_booked() -> None:
    """Few sampled nodes hold another mass than the cells; the books say how much, also where the window cuts."""
    scene = Scene(Cells(0, 1, 20), Profile(np.linspace(0.1, 1, 20)), ConstantSlope(0.8), Coulomb(0.1), "wall")
    for beyond, bound in (("stop", None), ("warn", 0.8)):
        method = Kinetic(4, Uniform(6, bound, beyond), "sampled", projection="re-summed")
        book = simulate(scene, method, Courant(0.9, 0.1), 1).ledger
        assert abs(book.mended[-1]) > 1e-3 * book.mass[0]
        assert float(np.abs(book.mass - book.mass[0] - book.mended).max()) < 1e-13


@pytest.mark.parametrize(
    ("clock", "every", "what"),
    [
        (Fixed(1e-9, 10**8), 1, "100000001 rows and 100000000 steps would take"),
        (Courant(1e-9, 1.0, most=10**9), 10, r"rows and \d+ steps would take"),
    ],
)
def test_rows_beyond_memory_are_refused(monkeypatch: pytest.MonkeyPatch, clock: object, every: int, what: str) -> None:
    """Rows of states, rows of the ledger and lengths of steps, before the first step."""
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=2**30))
    scene = Scene(Cells(0, 1, 100), Profile(np.ones(100)))
    with pytest.raises(InputError, match=what):
        simulate(scene, Macroscopic(4), clock, every)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Cells(0, 5e-324, 2), "are 0 long"),
        (lambda: Cells(-1e308, 1e308, 2), "are inf long"),
        (lambda: Fixed(1e307, 20), "have no finite end"),
        (lambda: Scene(Cells(0, 1, 2), Profile((1e12, 1), (1e300, 0))), "no finite momentum flux"),
        (lambda: Scene(Cells(0, 1, 2), Profile((1, 1)), epsilon=1e200, k=1e200), "beta"),
        (lambda: Scene(Cells(0, 1, 2), Profile((1, 1)), epsilon=1e-200, k=1e-200), "beta"),
        (
            lambda: simulate(Scene(Cells(0, 1, 2), Profile((1, 1))), Kinetic(4, Uniform(8, 1e101)), Fixed(1, 1)),
            "1e.100",
        ),
    ],
)
def test_what_no_number_can_hold_is_refused(make: Callable[[], object], words: str) -> None:
    """In one line, without a warning."""
    with pytest.raises(InputError, match=words) as refused:
        make()
    assert "\n" not in str(refused.value)
