"""A density that is made on demand is the stored one, bit for bit, in every variant that a step may do without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from states import random_states, scene_with
from test_sleep import heaps

from kinsim import Courant, Dump, Fixed, InputError, Kinetic, Run, Scene, Uniform, Window, simulate
from kinsim.clock import AnyClock
from kinsim.kinetic import choice
from kinsim.kinetic.lean import OnDemand
from kinsim.kinetic.occupied import LANES, sum_cells
from kinsim.kinetic.wing import Density
from kinsim.stepper import Stepper, make_stepper

METHODS = {
    f"scheme {scheme}, {equilibrium}": Kinetic(scheme, Uniform(32), equilibrium)
    for scheme in (1, 4)
    for equilibrium in ("sampled", "cell-average")
}
VELOCITIES = {"uniform": Uniform(32), "cut": Uniform(64, 0.9, beyond="warn"), "window": Window(0.05)}
GROUNDS = {"free": (0.0, None), "flat": (0.0, 0.3), "steep": (0.5, 0.3), "bearing": (0.2, 0.5)}
BOUNDARIES = ["wall", "periodic", "open", ("wall", "open")]
DUMPS = tuple(Dump(stage, stage=stage, every=5) for stage in ("equilibrium", "transport", "force"))
HELD = Dump("standing", stage="held", every=3)


def patchy(ground: str, boundary: str | tuple[str, str]) -> Scene:
    """Cells that flow, some faster than sound, next to dry ones and to some that rest."""
    zeta, delta = GROUNDS[ground]
    h, u = random_states(np.random.default_rng(1), 40)
    h[20:30], u[20:30] = 0.3, 0.0
    return scene_with(h, 2.0 * u, zeta=zeta, delta=delta, boundary=boundary)


def is_the_stored_one(
    monkeypatch: pytest.MonkeyPatch, scene: Scene, method: Kinetic, clock: AnyClock, dumps: tuple[Dump, ...] = (),
    **asked: bool,
) -> Run:  # fmt: skip
    """Compares two runs with ==: states, steps, ledger, causes, dumps and verdict."""
    made = simulate(scene, method, clock, 7, dumps=dumps, **asked)
    with monkeypatch.context() as patch:
        patch.setattr(choice, "may_forget", lambda method, scheme: False)
        stored = simulate(scene, method, clock, 7, dumps=dumps, **asked)
    for name in ("t", "h", "q", "dt"):
        np.testing.assert_array_equal(getattr(made, name), getattr(stored, name), err_msg=name)
    for column, values in stored.entries.items():
        np.testing.assert_array_equal(made.entries[column], values, err_msg=column)
    for name, dump in stored.dumps.items():
        np.testing.assert_array_equal(made.dumps[name].values, dump.values, err_msg=name)
    if stored.causes is not None and made.causes is not None:
        np.testing.assert_array_equal(made.causes["sum"].values, stored.causes["sum"].values)
    assert made.verdict == stored.verdict
    return made


@pytest.mark.parametrize("boundary", BOUNDARIES, ids=str)
@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("velocity", VELOCITIES)
@pytest.mark.parametrize("name", METHODS)
def test_a_run_without_a_stored_density(
    name: str, velocity: str, ground: str, boundary: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every ground and boundary; where the window is too narrow, what leaves it is booked, too."""
    method = replace(METHODS[name], velocity=VELOCITIES[velocity])
    dumps = (*DUMPS, HELD) if method.scheme == 4 else DUMPS
    run = is_the_stored_one(monkeypatch, patchy(ground, boundary), method, Courant(0.9, 0.4), dumps)
    assert (run.entries["window_loss"][-1] > 0) == (velocity == "cut")


@pytest.mark.parametrize("name", METHODS)
def test_a_run_that_is_looked_into(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The moment ledger asks for every density in every step."""
    is_the_stored_one(monkeypatch, patchy("steep", "wall"), METHODS[name], Courant(0.9, 0.2), causes=True)


@pytest.mark.parametrize("name", METHODS)
def test_a_run_with_sleepers(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of a scene make the density of the whole when a row is saved."""
    is_the_stored_one(monkeypatch, heaps("wall"), METHODS[name], Fixed(0.01, 60))


@pytest.mark.parametrize("name", METHODS)
def test_a_run_that_is_stopped(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last row shows the f of the last step, although a step was begun since."""
    method = replace(METHODS[name], velocity=Uniform(32, 1.2))
    slide = scene_with(np.linspace(0.2, 0.4, 24), zeta=0.6, delta=0.1)
    run = is_the_stored_one(monkeypatch, slide, method, Fixed(0.005, 2000))
    assert run.verdict.kind == "window-too-small"
    assert run.verdict.step % 7
    assert run.entries["f_distance"][-1] > 0


@pytest.mark.parametrize("name", METHODS)
def test_a_run_beyond_the_bound(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where (28) is broken on demand f may be negative, and every step is looked at."""
    method = replace(METHODS[name], velocity=Uniform(32, 3.0))
    run = is_the_stored_one(monkeypatch, patchy("flat", "wall"), method, Fixed(0.03, 20), force=True)
    assert run.entries["f_min"].min() < 0


@pytest.mark.parametrize("bound", [0.4, 0.7])
@pytest.mark.parametrize("name", METHODS)
def test_a_run_whose_cells_are_all_faster_than_the_window(
    name: str, bound: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """M of neither of two neighbours ends in the window: its last node is still seen, and judged by the CFL bound."""
    method = replace(METHODS[name], velocity=Uniform(16, bound, beyond="warn"))
    deep = np.arange(64) < 31
    scene = scene_with(np.where(deep, 1.0, 0.01), np.where(deep, 0.3, 0.0), zeta=0.1, delta=0.2, boundary="wall")
    assert is_the_stored_one(monkeypatch, scene, method, Courant(0.9, 0.1)).entries["courant"].max() > 0.2
    layer = scene_with(np.ones(40), zeta=0.3, delta=0.1)
    with pytest.raises(InputError, match="CFL"):
        simulate(layer, method, Fixed(0.2, 5))


@pytest.mark.parametrize("scheme", [1, 4])
@pytest.mark.parametrize("h", [1e-20, 1e-34, 1e-300])
def test_films_too_thin_for_their_speed_to_vary(scheme: int, h: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """u + c is u, at the edge of a velocity cell: half of M stands on either side of it, and what flows is h u."""
    scene, method = scene_with(np.full(4, h), np.full(4, 1.0), delta=0.2), Kinetic(scheme, Uniform(16, 2.0))
    made = make_stepper(scene, method)
    with monkeypatch.context() as patch:
        patch.setattr(choice, "may_forget", lambda method, scheme: False)
        stored = Stepper(scene, method)
    for stepper in (made, stored):
        assert stepper.begin(*scene.initial()) > 1.0
        stepper.advance(1e-3)
        np.testing.assert_allclose(stepper.now.F1[1:-1], h, rtol=1e-14)
    np.testing.assert_array_equal(made.now.F1, stored.now.F1)


def test_a_film_whose_energy_is_zero_has_a_first_node() -> None:
    """2 beta h is 0 in floating point while h is not."""
    h, u, weights = np.array([0.0, 5e-324, 0.0]), np.array([0.0, 1.0, 0.0]), np.ones(8)
    low, high = np.zeros((2, 3))
    sum_cells(h, u, 0.2, 0.5, True, weights, weights, np.zeros(8 * LANES), np.zeros((4, 3)), low, high)
    assert low[1] <= high[1]


@pytest.mark.parametrize("name", METHODS)
def test_nothing_is_stored_that_nobody_asked_for(name: str) -> None:
    """Steps leave no density behind; one that is asked for is made in the same place again and again."""
    scene = patchy("flat", "wall")
    stepper = make_stepper(scene, METHODS[name].within(5.0))
    density = stepper.density
    assert isinstance(density, OnDemand)
    for _ in range(3):
        stepper.begin(*scene.initial())
        stepper.advance(1e-3)
        assert density.least() == 0.0
    assert not density._kept
    first = density.f
    stepper.begin(*scene.initial())
    stepper.advance(1e-3)
    assert density.f is first


@pytest.mark.parametrize(
    "other",
    [
        {"scheme": 2}, {"scheme": 3}, {"order": 2}, {"statics": "reflect"}, {"equilibrium": "matched"},
        {"force": "shift-pfc"}, {"force": "derivative-upwind"}, {"projection": "re-summed"},
    ],
    ids=str,
)  # fmt: skip
def test_other_methods_keep_their_density(other: dict[str, object]) -> None:
    """Where U comes out of f, or f may be negative, or nobody has shown that it is not."""
    method = replace(METHODS["scheme 4, cell-average"].within(5.0), **other)
    assert type(make_stepper(patchy("flat", "wall"), method).density) is Density
