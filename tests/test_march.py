"""The compiled time loop: a block of steps is its steps one by one, tiles at rest are skipped, times are landed on."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import EPS
from covering import fewest
from states import random_states, scene_with

from kinsim import (
    Arc,
    Blocks,
    Cells,
    Checkpoint,
    Coulomb,
    Courant,
    Fitted,
    Fixed,
    Inflow,
    InputError,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    SmoothChute,
    Uniform,
    Window,
    resume,
    simulate,
)
from kinsim.clock import AnyClock
from kinsim.exact import random_pile
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.solver.march import COUNTED, IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL, MENDED_ALL
from kinsim.solver.solver import Solver

BOOKS = [IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL, MENDED_ALL]

SCHEMES: dict[str, dict[str, Any]] = {
    "1": {"scheme": 1},
    "2": {"scheme": 2},
    "3 by cell": {"scheme": 3},
    "3 by face": {"scheme": 3, "coupling": "face"},
    "4": {"scheme": 4},
    "4 reflecting": {"scheme": 4, "statics": "reflect"},
    "4 of order 2": {"scheme": 4, "order": 2},
}

FACTORS: dict[str, tuple[Any, ...]] = {
    "scheme": tuple(SCHEMES),
    "flux": ("closed", "fitted", "grid"),
    "equilibrium": tuple(EQUILIBRIA),
    "velocity": ("uniform", "window"),
    "force": tuple(FORCES),
    "projection": ("flux-difference", "re-summed"),
    "boundary": ("open", "wall", "periodic", ("wall", "open"), (Inflow(0.5, 1.2), "open")),
    "clock": ("fixed", "courant"),
    "ground": ("flat", "steep", "smooth"),
}


APART = {("scheme", "equilibrium"), ("scheme", "force")}
"""Factors that meet in other tests, as each pair of them is long to compile."""


def cases() -> list[dict[str, Any]]:
    """Cases in which each two values of two factors meet that can, but for those apart."""
    dice, pool = random.Random(1), []
    for _ in range(1500):
        case = {name: dice.choice(values) for name, values in FACTORS.items()}
        if case["flux"] != "grid":
            case |= {"equilibrium": "", "velocity": "", "force": "", "projection": ""}
        if case["ground"] == "smooth" and (case["scheme"][0] != "4" or case["boundary"] == "periodic"):
            case["ground"] = "flat"
        pool.append(case)
    pool.sort(key=lambda case: case["projection"] == "re-summed")  # what takes long to compile comes last
    pairs = [
        {pair for pair in itertools.combinations(case.items(), 2) if (pair[0][0], pair[1][0]) not in APART}
        for case in pool
    ]
    return [pool[i] for i in fewest(pairs)]


CASES = cases()


def scene_of(case: dict[str, Any]) -> Scene:
    """300 cells, two tiles: dry ones, films of 1e-12 and heights of 1; no such where methods of the paper blow up."""
    dice = np.random.default_rng(3)
    h, u = dice.uniform(0.1, 1.0, 300), dice.uniform(-1, 1, 300) * dice.choice([0.0, 0.1, 1.0], 300)
    if case["scheme"][0] in "23" or case["projection"] == "re-summed":
        h = 0.3 + 0.2 * h
    else:
        h *= dice.choice([0.0, 1e-12, 1.0, 1.0], 300)
        h[100:140] = 0.0
    h[250:270], u[250:270] = 0.4, 0.0
    scene = scene_with(h, u, zeta=0.5 if case["ground"] == "steep" else 0.0, delta=0.3, boundary=case["boundary"])
    return replace(scene, chute=SmoothChute(Arc(30.0, 0.3), 1.0)) if case["ground"] == "smooth" else scene


def method_of(case: dict[str, Any]) -> Macroscopic | Kinetic:
    scheme = SCHEMES[case["scheme"]]
    if case["flux"] == "closed":
        return Macroscopic(**scheme)
    if case["flux"] == "fitted":
        return Kinetic(velocity=Fitted(6), **scheme)
    velocity = Uniform(24, 6.0) if case["velocity"] == "uniform" else Window(0.3)
    chosen = {name: case[name] for name in ("equilibrium", "force", "projection")}
    return Kinetic(velocity=velocity, **chosen, **scheme)


@pytest.mark.parametrize("case", CASES, ids=lambda case: ", ".join(str(value) for value in case.values() if value))
@np.errstate(all="ignore")
def test_a_block_is_its_steps(case: dict[str, Any]) -> None:
    """n steps in a block, in two blocks, and one by one with every stage: the same bits, in the books, too."""
    scene, method = scene_of(case), method_of(case)
    clock: AnyClock = Fixed(0.004, 100) if case["clock"] == "fixed" else Courant(0.5, 1.0)
    whole, parted = Solver(scene, method), Solver(scene, method)
    block = whole.march(clock, 12)
    assert (block.reason, block.dts.size) == (COUNTED, 12)
    assert not np.array_equal(block.h, scene.initial()[0])
    first, second = parted.march(clock, 5).dts, parted.march(clock, 7).dts
    np.testing.assert_array_equal(block.dts, [*first, *second])
    h, q = scene.initial()
    books = np.zeros(4)
    for dt in block.dts:
        stages = whole.stages(h, q, dt)
        h, q = stages["h1"], stages["q1"]
        books += stages.solver.seen[BOOKS]
    for found_h, found_q in ((parted.h, parted.q), (h, q)):
        np.testing.assert_array_equal(found_h, block.h)
        np.testing.assert_array_equal(found_q, block.q)
    np.testing.assert_array_equal(parted.seen, whole.seen)
    np.testing.assert_array_equal(books, whole.seen[BOOKS])


def beside_a_pile(zeta: float) -> Scene:
    """3000 cells of a pile at rest, 12 tiles, and a hump on one of them, the cells 1024 to 1279, that moves."""
    scene = scene_with(np.ones(3000), zeta=zeta, delta=0.3, boundary="wall", dx=0.01)
    fits = {"pull": scene.pull, "resistance": scene.resistance, "beta": scene.beta}
    h = random_pile(scene.cells, **fits, fill=0.9, per="face", rng=1, lowest=0.3)(scene.x)[0]
    hump = np.maximum(1.0 - ((np.arange(3000) - 1180) / 80.0) ** 2, 0.0)
    return replace(scene, heap=Profile(h + 0.4 * hump, np.where(hump > 0.0, 0.8, 0.0)))


@pytest.mark.parametrize("zeta", [0.0, 0.2])
@pytest.mark.parametrize(
    "method", [Macroscopic(4), Macroscopic(4, order=2), Macroscopic(4, statics="reflect"), Kinetic(4, Fitted(6))],
    ids=["first", "second", "reflecting", "fitted"],
)  # fmt: skip
def test_tiles_at_rest_are_skipped_to_the_bit(method: Macroscopic | Kinetic, zeta: float) -> None:
    """A march that looks at few tiles is the chain of staged steps, in which nothing is skipped; and rest wakes up."""
    scene, clock = beside_a_pile(zeta), Fixed(0.002, 300)
    run = simulate(scene, method, clock, 150)
    assert run.awake < 0.7
    h, q = scene.initial()
    single = Solver(scene, method)
    for _ in range(300):
        stages = single.stages(h, q, 0.002)
        h, q = stages["h1"], stages["q1"]
    np.testing.assert_array_equal(run.h[-1], h)
    np.testing.assert_array_equal(run.q[-1], q)
    assert np.flatnonzero(run.h[-1] != run.h[0]).max() > 1280
    assert (run.h[-1][2500:] == run.h[0][2500:]).all()


# ---- times that are asked for --------------------------------------------------------------------------------------


def sliding() -> Scene:
    """A mass that slides over a ring, 60 cells."""
    h, u = random_states(np.random.default_rng(2), 60)
    return replace(scene_with(h, u, zeta=0.3), friction=Coulomb(0.2))


CLOCKS = {"fixed": Fixed(0.007, 100), "courant": Courant(0.8, 0.7)}
TIMES = [0.1, 0.1234567, 0.35, 0.3500001, 0.63]


@pytest.mark.parametrize("method", [Macroscopic(4), Kinetic(4, Uniform(32))], ids=["closed", "grid"])
@pytest.mark.parametrize("name", CLOCKS)
def test_steps_end_on_the_times_asked_for(name: str, method: Macroscopic | Kinetic) -> None:
    """To the bit; steps are shortened for it, and never made longer."""
    scene, clock = sliding(), CLOCKS[name]
    at, even = simulate(scene, method, clock, save_at=TIMES), simulate(scene, method, clock, rows=7)
    np.testing.assert_array_equal(at.t, [0.0, *TIMES, clock.end])
    np.testing.assert_array_equal(even.t, clock.end * np.arange(8) / 7)
    for run in (at, even):
        assert run.verdict.kind == "finished"
        assert float(np.sum(run.dt)) == pytest.approx(clock.end, rel=1e-13)
        if isinstance(clock, Fixed):
            assert run.dt.max() <= clock.dt
        else:
            assert run.entries["courant"].max() <= clock.number * (1 + 4 * EPS)
    if isinstance(clock, Fixed):  # the planned times stay where they were
        ends, planned = np.cumsum(at.dt), clock.dt * np.arange(1, 101)
        assert all(np.abs(ends - t).min() <= 1e-12 for t in planned)
        assert at.steps <= 100 + len(TIMES)


@pytest.mark.parametrize("clock", [Fixed(1e-3, 20), Fixed(1e-3, 1234), Courant(0.9, 3.0)], ids=str)
def test_about_a_hundred_rows_are_kept_where_nobody_says_how_many(clock: AnyClock) -> None:
    run = simulate(sliding(), Macroscopic(4), clock)
    assert min(run.steps, 90) <= run.t.size <= 102
    assert run.t[-1] == clock.end


# ---- observers -----------------------------------------------------------------------------------------------------


class Third:
    """Notes which steps it sees."""

    name, every = "third", 3

    def __init__(self) -> None:
        self.steps: list[int] = []
        self.sums: list[float] = []

    def look(self, block: Any) -> None:
        self.steps.append(block.step)
        self.sums.append(float(block.h.sum()))

    def result(self) -> list[int]:
        return self.steps


def test_an_observer_sees_the_steps_that_it_asks_for() -> None:
    """Every third one, with the state after it; the run is the one without, to the bit."""
    third, clock = Third(), Fixed(0.005, 20)
    run = simulate(sliding(), Macroscopic(4), clock, 1, observers=[third])
    assert third.steps == run.observed["third"] == [3, 6, 9, 12, 15, 18]
    assert third.sums == [float(run.h[step].sum()) for step in third.steps]
    alone = simulate(sliding(), Macroscopic(4), clock, 20)
    np.testing.assert_array_equal(run.h[-1], alone.h[-1])
    np.testing.assert_array_equal(run.dt, alone.dt)


@pytest.mark.parametrize("raises", [False, True], ids=["says so", "raises"])
def test_an_observer_ends_a_run_which_keeps_everything(raises: bool) -> None:
    """By a text, or by an exception of its own: the verdict names it, states and what others noted are there."""

    def watchman(block: Any) -> str | None:
        if block.step < 6:
            return None
        if raises:
            raise ZeroDivisionError("of its own")
        return "high enough"

    watchman.every = 2  # type: ignore[attr-defined]
    third = Third()
    run = simulate(sliding(), Macroscopic(4), Fixed(0.005, 20), 1, observers=[watchman, third])
    whole = simulate(sliding(), Macroscopic(4), Fixed(0.005, 20), 1)
    assert run.verdict.kind == ("observer-failed" if raises else "stopped")
    assert "watchman" in str(run.verdict)
    assert ("ZeroDivisionError: of its own" if raises else "high enough") in str(run.verdict)
    assert (run.steps, run.verdict.step, third.steps) == (6, 6, [3, 6])
    np.testing.assert_array_equal(run.t, whole.t[:7])
    np.testing.assert_array_equal(run.h, whole.h[:7])
    np.testing.assert_array_equal(run.entries["mass"], whole.entries["mass"][:7])


@pytest.mark.parametrize("where", ["start", "next_step", "result", "kept"])
def test_whatever_an_observer_raises_loses_nothing(where: str, tmp_path: Path) -> None:
    """The verdict names it, the states are there, and what is put down can be taken up again."""

    class Bad(Third):
        name = "bad"

    def broken(self: Bad, *given: Any) -> None:
        raise RuntimeError("boom")

    path = str(tmp_path / "run")
    sound = simulate(sliding(), Macroscopic(4), Fixed(0.005, 20), 1, observers=[Third()])
    setattr(Bad, where, broken)
    keep = Checkpoint(path, every=0.0)
    run = simulate(sliding(), Macroscopic(4), Fixed(0.005, 20), 1, observers=[Bad(), Third()], checkpoint=keep)
    assert "observer 'bad' failed: RuntimeError: boom" in str(run.verdict)
    assert run.observed["bad"] is None or where != "result"
    np.testing.assert_array_equal(run.h, sound.h[: run.steps + 1])
    if where == "next_step":  # it stopped there, and goes on once the fault is mended
        again = resume(path, scene=sliding(), observers=[type("Mended", (Third,), {"name": "bad"})(), Third()])
        np.testing.assert_array_equal(again.h, sound.h)
        assert again.verdict.kind == "finished"


def test_observers_have_names_of_their_own_and_no_power_over_the_state() -> None:
    """Two of one kind are both kept; the state that they see is to be read."""
    run = simulate(sliding(), Macroscopic(4), Fixed(0.005, 6), observers=[Third(), Third()])
    assert run.observed == {"third": [3, 6], "third #2": [3, 6]}

    def spoil(block: Any) -> None:
        block.h[:] = 7.0

    run = simulate(sliding(), Macroscopic(4), Fixed(0.005, 6), observers=[spoil])
    assert run.verdict.kind == "observer-failed"
    assert "read-only" in str(run.verdict)
    with pytest.raises(InputError, match="every = '3'"):
        simulate(sliding(), Macroscopic(4), Fixed(0.005, 6), observers=[type("Odd", (Third,), {"every": "3"})()])
    with pytest.raises(InputError, match="give an object"):
        simulate(sliding(), Macroscopic(4), Fixed(0.005, 6), observers=[Third])


@pytest.mark.parametrize(("dt", "steps", "at"), [(0.01, 30, 0.015), (0.1, 5, 0.25), (1e-3, 97, 0.0495)])
def test_a_requested_time_makes_a_run_of_fixed_steps_no_longer(dt: float, steps: int, at: float) -> None:
    """A step is cut in two, and the clock ends when it says."""
    scene = Scene(Cells(0, 1, 20), Blocks((0.5,), (0.3, 0.1)), epsilon=0.01)
    run = simulate(scene, Macroscopic(4), Fixed(dt, steps), save_at=[at])
    assert run.t.tolist() == [0.0, at, pytest.approx(steps * dt, rel=1e-14)]
    assert run.steps == steps + 1


def test_rows_end_with_the_clock() -> None:
    """Whatever multiples of end/rows round to."""
    scene = Scene(Cells(0, 1, 20), Blocks((0.5,), (0.3, 0.1)), epsilon=0.01)
    for clock, rows in ((Courant(0.45, 0.7), 3), (Fixed(1e-3, 97), 10)):
        run = simulate(scene, Macroscopic(4), clock, rows=rows)
        assert run.t.size == rows + 1
        assert run.t[-1] == clock.end
