"""Predictions, choices, budgets and advice, each against what full runs say."""

from __future__ import annotations

import math
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from covering import covering
from typer.testing import CliRunner

from kinsim import (
    Blocks,
    Cells,
    Coulomb,
    Courant,
    Fitted,
    Fixed,
    Frictionless,
    InputError,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    Window,
    advise,
    budget,
    choose,
    compare,
    load_scene,
    simulate,
    trade,
)  # fmt: skip
from kinsim.cli import app
from kinsim.progress import COMPILING
from kinsim.trades import budget as budgeting
from kinsim.trades import choose as choosing
from kinsim.trades.choose import candidates, velocity_error
from kinsim.trades.cost import Cost
from kinsim.trades.judge import mass_of
from kinsim.trades.pace import finer, steady, under_way
from kinsim.trades.pilot import Pilots

SILO, _, _ = load_scene("silo")
SILO = replace(SILO, cells=replace(SILO.cells, count=80))
CLOCK = Courant(0.8, 3.0)


def test_the_velocity_error_is_what_compare_finds() -> None:
    method = Kinetic(velocity=Uniform(16))
    run = simulate(SILO, method, CLOCK)
    apart = compare(SILO, [method, method.twin], CLOCK)["h_l1"].values[1, -1]
    assert velocity_error(run) == pytest.approx(apart / (SILO.initial()[0].sum() * SILO.cells.dx), rel=1e-12)
    with pytest.raises(InputError, match="the closed form has none"):
        velocity_error(simulate(SILO, Macroscopic(), CLOCK))


def test_what_is_ruled_out_is_looked_at_by_its_nodes_whatever_the_clock_says() -> None:
    """A machine with other work may time 8 nodes as the dearest; that they do not do rules nothing out but fewer."""

    errors = {8: 1e-2, 32: 5e-4, 64: 1e-5, 256: math.inf}

    class Foretold:
        least_awake = 1.0

        def awake(self, one: Kinetic) -> float:
            return 1.0

        def foreseen(self, one: Kinetic) -> float:
            return 1.0

        def predicted(self, one: Kinetic) -> float:
            return errors[one.velocity.count]

    family = {n: Kinetic(velocity=Uniform(n)) for n in errors}
    costs = {family[n]: Cost(0.0, seconds) for n, seconds in ((32, 1.0), (256, 2.0), (64, 3.0), (8, 4.0))}
    best = choosing._cheapest(sorted(costs, key=lambda one: costs[one].of(1.0)), costs, Foretold(), 1e-3)
    assert best == family[32]


def test_a_prediction_does_not_depend_on_what_else_was_asked() -> None:
    """The margin is told by few nodes of each kind of a family, before any other pilot is run."""
    scene, clock = replace(SILO, cells=replace(SILO.cells, count=240)), Fixed(0.03, 60)
    family = candidates(Kinetic())
    first, then = Pilots(scene, family, clock), Pilots(scene, family, clock)
    asked = Kinetic(velocity=Uniform(64))
    alone = first.predicted(asked)
    then.ask([Kinetic(velocity=Uniform(n)) for n in (24, 96, 256)])
    assert then.predicted(asked) == alone
    assert first.margin == then.margin > 1.0


def test_steps_that_are_too_long_are_refused_as_a_run_does() -> None:
    for clock, remedy in ((Fixed(5.0, 3), r"dt <= 0\."), (Courant(1.3, 1.0), "a Courant number of at most 1")):
        with pytest.raises(InputError, match=rf"choose: dt = .* breaks the CFL bound \(28\): .*; take {remedy}"):
            choose(SILO, Kinetic(), clock, accuracy=1e-3)
    with pytest.raises(InputError, match="take a heap, or a stream"):
        choose(replace(SILO, heap=Blocks((), (0.0,))), Kinetic(), Courant(1.3, 1.0), accuracy=1e-3)


def test_the_nearest_that_can_be_had_is_had() -> None:
    """What a refusal names is not refused, whatever was asked before it."""
    scene, clock = replace(SILO, cells=replace(SILO.cells, count=240)), Courant(0.8, 0.5)
    for accuracy in (1e-15, 1e-9, 1e-7):
        with pytest.raises(InputError, match="cannot be had") as told:
            choose(scene, Kinetic(), clock, accuracy=accuracy, grid=True)
        named = float(str(told.value).rsplit(" ", 1)[1])
        assert choose(scene, Kinetic(), clock, accuracy=named, grid=True).predicted <= named


def test_pilots_that_stop_have_the_error_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """On all cells; a run that stops there has no error, and is not chosen."""
    scene, clock = replace(SILO, cells=replace(SILO.cells, count=240)), Courant(0.8, 0.5)
    method = Kinetic(velocity=Uniform(16))
    pilots = Pilots(scene, [method], clock)
    pilots._found[method][0] = math.nan
    assert not pilots.foretells(method)
    run = simulate(scene, method, clock)
    assert pilots.predicted(method) == velocity_error(run)
    cut = replace(run, verdict=replace(run.verdict, kind="window-too-small"))
    assert velocity_error(cut) == math.inf
    monkeypatch.setattr(Pilots, "_errors", lambda self, of, methods: (np.full((1, 1), math.nan), [math.nan]))
    assert pilots.predicted(method) == math.inf


@pytest.mark.parametrize(("count", "width"), [(600, 0.02), (60, 0.2), (20, 0.7)])
def test_a_heap_that_fewer_cells_miss_is_averaged(count: int, width: float) -> None:
    """A heap of one cell falls between the middles of a quarter of the cells; its mass does not."""
    heap = Blocks((0.9 / count, 0.9 / count + width), (0.0, 1.0, 0.0))
    scene = replace(SILO, heap=heap, cells=replace(SILO.cells, left=-6.0, right=6.0, count=count))
    mass = scene.initial()[0].sum() * scene.cells.dx
    assert mass > 0.0
    for share in (0.25, 1 / 3, 2 / 3):
        coarse = finer(scene, share)
        assert coarse.initial()[0].any()
        if isinstance(coarse.heap, Profile):
            assert coarse.initial()[0].sum() * coarse.cells.dx == pytest.approx(mass, rel=1e-13)
    assert isinstance(finer(scene, 0.25).heap, Profile)
    assert choose(scene, Kinetic(), Courant(0.5, 0.2), accuracy=1e-2).predicted <= 1e-2


def test_no_budget_is_made_of_a_run_that_stops() -> None:
    """The fastest grains of the dam are outside the window."""
    stops = r"budget: a run stops: step 1: velocities reach .*; take a scene and a method that come to the end"
    with pytest.raises(InputError, match=stops):
        budget(SILO, Kinetic(velocity=Uniform(64, 1.3)), Fixed(0.02, 60))


@pytest.mark.parametrize("module", ["trades.choose", "trades.pace", "measure.compare"])
def test_what_interrupts_a_run_interrupts_who_asked_for_it(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that Ctrl-C ended has states, and a verdict; none of them is taken for its end."""
    run = simulate(SILO, Kinetic(velocity=Uniform(16)), CLOCK)
    cut = replace(run, verdict=replace(run.verdict, kind="interrupted"))
    monkeypatch.setattr(import_module(f"kinsim.{module}"), "simulate", lambda *given, **options: cut)
    asked = {
        "trades.choose": lambda: velocity_error(run),
        "trades.pace": lambda: steady(SILO, Kinetic(), 0.8, 3.0),
        "measure.compare": lambda: compare(SILO, [run.method], CLOCK),
    }
    with pytest.raises(KeyboardInterrupt):
        asked[module]()


def test_predictions_are_pilots_times_the_measured_margin() -> None:
    """On a third and two thirds of 240 cells, with steps as long beside dx; the margin reaches as far as is left."""
    scene, clock = replace(SILO, cells=replace(SILO.cells, count=240)), Fixed(0.03, 21)
    methods = [Kinetic(velocity=Fitted(1)), Kinetic(velocity=Uniform(16)), Kinetic(velocity=Uniform(32))]
    pilots = Pilots(scene, methods, clock)
    errors = []
    for count, steps in ((80, 7), (160, 14)):
        coarse = replace(scene, cells=replace(scene.cells, count=count))
        errors.append([velocity_error(simulate(coarse, method, Fixed(0.63 / steps, steps))) for method in methods])
    less, more = np.array(errors)
    margin = np.exp(3.182 * np.log2(1.5) * np.sqrt(np.mean(np.log(more / less) ** 2)))
    assert pilots.margin == pytest.approx(margin, rel=1e-3)  # Student's t with 3 degrees of freedom: 3.182
    np.testing.assert_allclose([pilots.predicted(method) for method in methods], more * margin, rtol=1e-3)
    assert pilots.foreseen(Kinetic(velocity=Uniform(64))) == 0.0  # two of a kind tell no order
    pilots.ask([Kinetic(velocity=Uniform(64))])
    assert pilots.foreseen(Kinetic(velocity=Uniform(256))) < pilots.foreseen(Kinetic(velocity=Uniform(128))) < more[2]


@pytest.mark.parametrize(
    ("count", "clock", "method"),
    covering(
        [2, 7, 80, 239], [Fixed(0.004, 200), Courant(0.45, 0.8)],
        [Kinetic(velocity=Uniform(16)), Kinetic(velocity=Fitted(2), order=2)],
    ),
    ids=repr,
)  # fmt: skip
def test_a_scene_of_few_cells_is_its_own_pilot(count: int, clock: Fixed | Courant, method: Kinetic) -> None:
    """To the bit: the very run, and its twin in the very steps."""
    scene = replace(SILO, heap=Blocks((0,), (1.0, 0.3)), cells=replace(SILO.cells, count=count))
    pilots = Pilots(scene, [method], clock)
    assert pilots.predicted(method) == max(velocity_error(simulate(scene, method, clock)), pilots.floor)
    assert pilots.margin == 1.0


def test_pilots_of_a_courant_clock_take_their_own_steps() -> None:
    scene, clock = replace(SILO, cells=replace(SILO.cells, count=240)), Courant(0.8, 0.5)
    methods = [Kinetic(velocity=Uniform(n)) for n in (16, 32)]
    less, more = np.array([[velocity_error(simulate(finer(scene, share), method, clock)) for method in methods]
                           for share in (1 / 3, 2 / 3)])  # fmt: skip
    told = Pilots(scene, methods, clock)
    margin = np.exp(4.303 * np.log2(1.5) * np.sqrt(np.mean(np.log(more / less) ** 2)))
    assert told.margin == pytest.approx(margin, rel=1e-3)  # Student's t with 2 degrees of freedom: 4.303
    np.testing.assert_allclose([told.predicted(method) for method in methods], more * told.margin, rtol=1e-12)


def test_a_twin_with_a_faster_front_takes_the_same_steps() -> None:
    """On a slide that comes to rest the closed form has a front of its own, too fast for the steps of few nodes."""
    scene, method, clock = load_scene("bend")
    scene, method = replace(scene, cells=replace(scene.cells, count=48)), replace(method, velocity=Uniform(32))
    run = simulate(scene, method, clock)
    assert simulate(scene, method.twin, run.replay).verdict.kind == "cfl-broken"
    twin = simulate(scene, method.twin, run.replay, force=True)
    assert twin.t[-1] == run.t[-1]
    apart = np.abs(run.h[-1] - twin.h[-1]).sum() / scene.initial()[0].sum()
    assert velocity_error(run) == pytest.approx(apart, rel=1e-12)
    assert Pilots(scene, [method], clock).predicted(method) == velocity_error(run) < 0.1


def test_a_heap_given_cell_by_cell_has_pilots() -> None:
    """Averaged, so that no mass is lost; between cells that do not match, too."""
    heap = Profile(*((lambda h, q: (h, q / h))(*SILO.initial())))
    own = replace(SILO, heap=heap)
    for factor in (0.5, 0.3, 1.7):
        other = finer(own, factor)
        for mine, theirs in zip(own.initial(), other.initial(), strict=True):
            assert theirs.sum() * other.cells.dx == pytest.approx(mine.sum() * own.cells.dx, rel=1e-13, abs=1e-15)
    pilots = [Pilots(one, candidates(Kinetic()), Fixed(0.02, 50)) for one in (own, SILO)]
    told = [one.predicted(Kinetic(velocity=Uniform(16))) for one in pilots]
    assert told[0] == pytest.approx(told[1], rel=1e-6)


def test_cells_that_sleep_cost_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A dearer step in which most cells rest is the cheaper one, with any clock."""
    few, many = Kinetic(velocity=Uniform(16)), Kinetic(velocity=Uniform(32))
    monkeypatch.setattr(choosing, "seconds_per_step", lambda *_, **__: [Cost(0.1, 1.0), Cost(0.1, 2.0)])
    monkeypatch.setattr(Pilots, "awake", lambda self, one: 1.0 if one == few else 0.2)
    monkeypatch.setattr(Pilots, "least_awake", property(lambda self: 0.2))
    asked = {"accuracy": 1e-1, "among": [few, many]}
    assert choose(SILO, Kinetic(), Fixed(0.02, 50), **asked).method == many
    assert choose(SILO, Kinetic(), Courant(0.8, 1.0), **asked).method == many


def test_nodes_that_come_to_rest_are_taken_before_few_that_do_not() -> None:
    """16 nodes never rest on this incline, 24 do: a dearer step, and a much cheaper run."""
    scene, _, _ = load_scene("silo-incline")
    scene = replace(scene, cells=replace(scene.cells, count=160))
    among, clock = [Kinetic(velocity=Uniform(n)) for n in (16, 24)], Fixed(0.04, 400)
    awake = [simulate(scene, one, clock, 1000).awake for one in among]
    assert awake[1] < 0.5 * awake[0]
    assert choose(scene, Kinetic(), clock, accuracy=1e-2, among=among).method == among[1]


def test_pilots_see_what_sleeps() -> None:
    """The share that the run itself has."""
    pilots, clock = Pilots(SILO, candidates(Kinetic()), Fixed(0.02, 400)), Fixed(0.02, 400)
    for method in (Kinetic(velocity=Fitted(4)), Kinetic(velocity=Uniform(64))):
        assert pilots.awake(method) == simulate(SILO, method, clock, 1000).awake < 1.0
    assert Pilots(SILO, candidates(Kinetic()), Courant(0.5, 1.0)).awake(Kinetic()) == 1.0


@pytest.mark.parametrize(("accuracy", "grid"), [(1e-2, False), (1e-6, False), (1e-11, False), (1e-4, True)])
def test_what_is_chosen_keeps_its_promise(accuracy: float, grid: bool) -> None:
    chosen = choose(SILO, Kinetic(), CLOCK, accuracy=accuracy, grid=grid)
    assert isinstance(chosen.method.velocity, Uniform) or not grid
    measured = velocity_error(simulate(SILO, chosen.method, CLOCK))
    assert measured <= chosen.predicted <= accuracy
    assert chosen.predicted <= 10.0 * measured


def test_the_cheapest_that_will_do_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """With costs of our own the choice follows them, whatever the order of the candidates."""
    among = [Kinetic(velocity=Uniform(n)) for n in (256, 16, 64)] + [Kinetic(velocity=Fitted(6))]
    for cost, wanted in (([3, 1, 2, 4], 64), ([3, 1, 4, 2], 6), ([1, 3, 2, 4], 256)):
        monkeypatch.setattr(choosing, "seconds_per_step", lambda *_, cost=cost, **__: [Cost(0.0, one) for one in cost])
        chosen = choose(SILO, Kinetic(), CLOCK, accuracy=1e-4, among=among)
        assert chosen.method.velocity.count == wanted


def test_what_cannot_be_had_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"below 1e-20 cannot be had; the nearest is .* with 8 fitted nodes: ask for"):
        choose(SILO, Kinetic(), CLOCK, accuracy=1e-20)
    with pytest.raises(InputError, match="with 512 nodes: ask for") as told:
        choose(SILO, Kinetic(), CLOCK, accuracy=1e-12, grid=True)
    asked = float(str(told.value).rsplit(" ", 1)[1])
    assert choose(SILO, Kinetic(), CLOCK, accuracy=asked, grid=True).predicted <= asked
    for bad in (0.0, -1.0, float("nan"), True, "small"):
        with pytest.raises(InputError, match="is no error to stay below"):
            choose(SILO, Kinetic(), CLOCK, accuracy=bad)
    with pytest.raises(InputError, match="the closed form has no velocity error"):
        choose(SILO, Macroscopic(), CLOCK, accuracy=1e-3)
    with pytest.raises(InputError, match="take scheme 4"):
        choose(SILO, Kinetic(1), CLOCK, accuracy=1e-3)
    with pytest.raises(InputError, match="no candidates"):
        choose(SILO, Kinetic(), CLOCK, accuracy=1e-3, among=[])
    with pytest.raises(InputError, match="none is there and none comes"):
        choose(replace(SILO, heap=Blocks((), (0.0,))), Kinetic(), CLOCK, accuracy=1e-3)


@pytest.mark.parametrize(
    ("among", "line"),
    [
        ([Kinetic(), Macroscopic()], r"among\[1\] is Macroscopic"),
        ([Kinetic(velocity=Window(0.3), equilibrium="sampled")], r"among\[0\] is .*; give Kinetic methods with"),
        ([Kinetic(1)], r"among\[0\] has another closed form"),
        ([Kinetic(order=2)], r"among\[0\] has another closed form"),
        (Kinetic(), "among is a Kinetic; give a list"),
    ],
)
def test_candidates_of_ones_own_share_the_twin(among: object, line: str) -> None:
    with pytest.raises(InputError, match=line):
        choose(SILO, Kinetic(), CLOCK, accuracy=1e-3, among=among)  # type: ignore[arg-type]


def test_arguments_of_a_choice() -> None:
    with pytest.raises(InputError, match="choose: scene is a str; give a"):
        choose("silo", Kinetic(), CLOCK, accuracy=1e-3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="advise: scene is a str; give a"):
        advise("silo", CLOCK)  # type: ignore[arg-type]
    for what in (budget, trade):
        with pytest.raises(InputError, match=rf"{what.__name__}: clock is a float; give a?"):
            what(SILO, Kinetic(), 0.1)  # type: ignore[operator]
    with pytest.raises(TypeError, match="unexpected keyword argument 'acuracy'"):
        choose(SILO, Kinetic(), CLOCK, accuracy=1e-3, acuracy=1)
    chosen = choose(SILO, Kinetic(), CLOCK, accuracy=np.float32(1e-3), among=[Kinetic()])  # type: ignore[arg-type]
    assert type(chosen.accuracy) is float


def test_candidates_keep_the_rest_of_the_method() -> None:
    assert all(isinstance(one.velocity, Uniform) for one in candidates(Kinetic(equilibrium="matched")))
    assert any(isinstance(one.velocity, Fitted) for one in candidates(Kinetic(order=2)))
    assert {one.order for one in candidates(Kinetic(order=2))} == {2}


def test_a_stream_onto_dry_ground() -> None:
    """Errors are measured in what comes in; the rest, and what steps cost, is that of a chute which is filled."""
    scene, _, _ = load_scene("crest")
    scene, clock = replace(scene, cells=replace(scene.cells, count=24)), Courant(0.8, 6.0)
    run = simulate(scene, Macroscopic(), clock, 1000)
    came = run.entries["inflow_left"][-1]
    assert mass_of(scene, 6.0) == pytest.approx(came, rel=1e-12)  # all of it comes in
    assert abs(run.mass_drift) < 1e-14
    filled = under_way(scene)
    assert (filled.initial()[0] > 0.0).all()
    assert under_way(filled) is filled
    chosen = choose(scene, Kinetic(), clock, accuracy=1e-2, among=[Kinetic(velocity=Uniform(n)) for n in (16, 32)])
    assert 0.0 < velocity_error(simulate(scene, chosen.method, clock)) == chosen.predicted <= 1e-2
    found = advise(scene, clock)
    assert {part.name for part in found.parts if part.needed} >= {"pull of the chute", "friction"}
    assert found.dry[0] == 1.0
    assert found.dry[-1] == 0.0
    assert "nan" not in str(found.parts)
    assert trade(scene, Kinetic(), clock, lines=["closed form"], repeats=1)["total_error"].item() < 0.1
    assert budget(scene, Macroscopic(), clock).total < 0.1


@pytest.mark.parametrize("name", ["bend", "rest-gallery"])
def test_advice_on_a_smooth_chute_looks_at_each_place(name: str) -> None:
    """Mass comes to rest, or stays there, where friction holds it; the printed schemes do not run there."""
    scene, _, clock = load_scene(name)
    scene = replace(scene, cells=replace(scene.cells, count=64))
    parts = {part.name.split(" (")[0]: part for part in advise(scene, clock).parts}
    assert parts["static friction"].needed
    because = parts["friction"].because
    if name == "rest-gallery":
        assert because.endswith("holds mass")
    else:  # 35 degrees at 17.5 and 0 at 21.5, a friction angle of 25
        flat_enough = float(np.mean(scene.x > 17.5 + 4.0 * 10.0 / 35.0))
        assert float(because.split()[-4]) / 100.0 == pytest.approx(flat_enough, abs=1.5 / 64), because
    assert "which alone can run the scene" in parts["static friction"].costs


def test_pilots_that_tell_too_little_are_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the margin is larger than what is promised, errors are measured on all cells."""
    scene, clock, method = replace(SILO, cells=replace(SILO.cells, count=240)), Courant(0.8, 0.5), Kinetic()
    pilots = Pilots(scene, [method], clock)
    monkeypatch.setattr(pilots, "margin", 3.2)
    assert pilots.predicted(method) == velocity_error(simulate(scene, method, clock))
    monkeypatch.setattr(Pilots, "_margin", lambda *_: 3.2)
    assert "measured on all cells" in choose(scene, method, clock, accuracy=1e-3, among=[method]).why


def test_a_run_with_an_accuracy_tells_what_it_picked_and_what_came_of_it() -> None:
    words = ["run", "silo", "--set", "cells.count=40", "--set", "method.scheme=4", "--set", "clock.steps=200"]
    done = CliRunner().invoke(app, [*words, "--accuracy", "1e-5"], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    assert "picked" in done.stdout
    assert "below the 1e-05 asked for" in done.stdout
    dumped = CliRunner().invoke(app, [*words, "--accuracy", "1e-2", "--dump", "every=100"], env={"COLUMNS": "300"})
    assert "fitted" not in dumped.stdout
    refused = CliRunner().invoke(app, [*words, "--accuracy", "1e-20"])
    said = [line for line in refused.stderr.splitlines() if not line.startswith(COMPILING.split()[0])]
    assert (refused.exit_code, len(said)) == (2, 1)


def test_a_budget_adds_what_separate_runs_say() -> None:
    scene, _, _ = load_scene("riemann")
    scene = replace(scene, cells=replace(scene.cells, count=60))
    clock = Fixed(0.05, 40)
    found = budget(scene, Kinetic(velocity=Uniform(16), force="derivative-upwind"), clock)
    assert found.judge == "the exact solution"
    assert found.force == 0.0  # nothing pulls
    mass = scene.initial()[0].sum()
    twin, half, quarter = (simulate(scene, Macroscopic(), Fixed(0.05 / k, 40 * k)).h[-1] for k in (1, 2, 4))
    first, second = (np.abs(a - b).sum() / mass for a, b in ((twin, half), (half, quarter)))
    assert found.dt == pytest.approx(first**2 / (first - second), rel=1e-9)
    run = simulate(scene, Kinetic(velocity=Uniform(16)), clock).h[-1]
    assert found.velocity == pytest.approx(np.abs(run - twin).sum() / mass, rel=1e-9)
    assert "nodes would do for less than 10 percent" in found.words or "Fewer nodes" in found.words
    forced = budget(SILO, Kinetic(velocity=Uniform(32), force="derivative-upwind"), Fixed(0.02, 20))
    assert 1e-6 < forced.force < forced.dx
    assert budget(SILO, Macroscopic(), Fixed(0.02, 20)).velocity == 0.0
    told = CliRunner().invoke(app, ["budget", "silo", "--set", "cells.count=40", "--set", "clock.steps=50"])
    assert told.exit_code == 0, told.output
    assert "of the dx error" in " ".join(told.stdout.split())


@pytest.mark.parametrize(("dearer", "told"), [(1.0, "8 nodes would do for less than 10 percent, 4 times faster."),
                                              (-1.0, "Fewer nodes would not be faster."),
                                              (0.0, "Fewer nodes would not be faster.")])  # fmt: skip
def test_only_what_is_faster_is_advised(monkeypatch: pytest.MonkeyPatch, dearer: float, told: str) -> None:
    def costs(scene: Scene, methods: list[Kinetic], **options: object) -> list[Cost]:
        return [Cost((one.velocity.count / 32.0) ** dearer, 0.0) for one in methods]  # type: ignore[union-attr]

    monkeypatch.setattr(budgeting, "seconds_per_step", costs)
    assert budget(SILO, Kinetic(velocity=Uniform(32)), Fixed(0.02, 50)).advice == told


def test_too_few_nodes_are_told_how_many_would_do() -> None:
    few = budget(SILO, Kinetic(velocity=Uniform(8), equilibrium="sampled"), Fixed(0.02, 50))
    assert few.velocity > 0.1 * few.dx
    count = int(few.advice.split()[0])
    assert count > 8
    assert f"{count} nodes would do for less than 10 percent" in few.advice
    enough = budget(SILO, Kinetic(velocity=Uniform(count), equilibrium="sampled"), Fixed(0.02, 50))
    assert enough.velocity < 0.1 * enough.dx


@pytest.mark.parametrize("scheme", [1, 2, 3])
def test_no_nodes_are_advised_where_no_pilot_tells_the_error(scheme: int) -> None:
    found = budget(SILO, Kinetic(scheme, Uniform(32)), Fixed(0.005, 20))
    assert f"scheme {scheme} amplifies any rounding" in found.words
    assert "would do for" not in found.words


def test_a_change_that_no_printed_digit_shows_is_none() -> None:
    found = budget(SILO, Macroscopic(), Fixed(0.02, 20))
    assert "change nothing" in replace(found, closed=0.15201, shorter=0.15199).words
    assert "make the whole smaller, 0.151 for 0.152" in replace(found, closed=0.152, shorter=0.151).words


@pytest.mark.parametrize(("name", "finest"), [("riemann", 1), ("parabola", 2), ("silo", 2), ("sine", 2)])
def test_what_the_second_order_would_do_is_foreseen(name: str, finest: int) -> None:
    """Within a half of what the two orders do on all cells; mass that friction stops is no smooth wave."""
    scene, _, clock = load_scene(name)
    scene = finer(scene, finest)
    pace = steady(scene, Kinetic(), 0.4, clock.end)
    ends = [simulate(scene, Macroscopic(4, order=order), pace, 10**6).h[-1] for order in (1, 2)]
    apart = np.abs(ends[0] - ends[1]).sum() * scene.cells.dx / mass_of(scene, clock.end)
    assert advise(scene, clock).smeared == pytest.approx(apart, rel=0.5)


def test_advice_names_what_a_scene_needs() -> None:
    def needs(scene: Scene, end: float) -> set[str]:
        return {part.name.split(" (")[0] for part in advise(scene, Courant(0.4, end)).parts if part.needed}

    dry = Scene(Cells(-4, 4, 80), Blocks((-1, 1), (0, 1, 0)), friction=Frictionless(), epsilon=0.4)
    assert needs(dry, 1.0) >= {"dry ground"}
    assert needs(dry, 1.0).isdisjoint({"friction", "static friction", "coupling of slow and fast", "pull of the chute"})
    assert needs(SILO, 8.0) >= {"friction", "static friction", "coupling of slow and fast"}
    steep = replace(SILO, chute={"zeta": 0.5}, friction=Coulomb(0.1))
    assert needs(steep, 2.0) >= {"friction", "pull of the chute", "every cell in every step"}
    assert "static friction" not in needs(steep, 2.0)
    assert needs(dry, 1.0) >= {"second order"}  # a dam that breaks
    assert "second order" not in needs(replace(dry, cells=replace(dry.cells, count=1600)), 1.0)
    still = replace(SILO, heap=Blocks((), (1.0,)))
    assert advise(still, Courant(0.4, 1.0)).smeared == 0.0
    told = CliRunner().invoke(app, ["advise", "parabola", "--set", "cells.count=40"])
    assert told.exit_code == 0, told.output
    assert "static friction" in told.stdout
