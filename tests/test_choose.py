"""Predictions, choices, budgets and advice, each against what full runs say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
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
    Scene,
    Uniform,
    advise,
    budget,
    choose,
    compare,
    load_scene,
    simulate,
)  # fmt: skip
from kinsim.cli import app
from kinsim.trades import choose as choosing
from kinsim.trades.choose import candidates, velocity_error
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


def test_predictions_are_pilots_times_the_measured_margin() -> None:
    pilots = Pilots(SILO, Kinetic(), 3.0)
    methods = [Kinetic(velocity=Fitted(1)), Kinetic(velocity=Uniform(16)), Kinetic(velocity=Uniform(32))]
    pilots.ask(methods)
    errors = []
    for count in (20, 40):
        scene = replace(SILO, cells=replace(SILO.cells, count=count))
        twin = simulate(scene, Macroscopic(), Courant(0.8, 3.0))
        clock = Fixed(3.0 / np.ceil(3.0 / twin.dt[:-1].min()), int(np.ceil(3.0 / twin.dt[:-1].min())))
        errors.append([velocity_error(simulate(scene, method, clock)) for method in methods])
    quarter, half = np.array(errors)
    margin = np.exp(1.645 * np.sqrt(np.mean(np.log(half / quarter) ** 2)))
    assert pilots.margin == pytest.approx(margin, rel=1e-9)
    np.testing.assert_allclose([pilots.predicted(method) for method in methods], half * margin, rtol=1e-9)
    assert pilots.foreseen(Kinetic(velocity=Uniform(64))) == 0.0  # two of a kind tell no order
    pilots.ask([Kinetic(velocity=Uniform(64))])
    assert pilots.foreseen(Kinetic(velocity=Uniform(256))) < pilots.foreseen(Kinetic(velocity=Uniform(128))) < half[2]


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
        monkeypatch.setattr(choosing, "seconds_per_step", lambda *_, cost=cost, **__: np.array(cost, dtype=float))
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
    with pytest.raises(InputError, match="there is no mass"):
        choose(replace(SILO, heap=Blocks((), (0.0,))), Kinetic(), CLOCK, accuracy=1e-3)


def test_candidates_keep_the_rest_of_the_method() -> None:
    assert all(isinstance(one.velocity, Uniform) for one in candidates(Kinetic(equilibrium="matched")))
    assert any(isinstance(one.velocity, Fitted) for one in candidates(Kinetic(order=2)))
    assert {one.order for one in candidates(Kinetic(order=2))} == {2}


def test_a_run_with_an_accuracy_tells_what_it_picked_and_what_came_of_it() -> None:
    words = ["run", "silo", "--set", "cells.count=40", "--set", "method.scheme=4", "--set", "clock.steps=200"]
    done = CliRunner().invoke(app, [*words, "--accuracy", "1e-5"], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    assert "picked" in done.stdout
    assert "below the 1e-05 asked for" in done.stdout
    dumped = CliRunner().invoke(app, [*words, "--accuracy", "1e-2", "--dump", "every=100"], env={"COLUMNS": "300"})
    assert "fitted" not in dumped.stdout
    refused = CliRunner().invoke(app, [*words, "--accuracy", "1e-20"])
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)


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
    told = CliRunner().invoke(app, ["advise", "parabola", "--set", "cells.count=40"])
    assert told.exit_code == 0, told.output
    assert "static friction" in told.stdout
