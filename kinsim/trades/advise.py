"""What a scene requires of the model, seen on a coarse run, and what each part costs, timed on the scene itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..clock import Courant, Fixed
from ..kinetic.velocity import Fitted, Uniform
from ..method import Kinetic, Macroscopic
from ..model.friction import Frictionless
from ..scene import Scene
from ..studies.given import check_given
from ..studies.study import study
from .cost import ROUNDS, short_clock
from .judge import check_ended, mass_of
from .pace import finer, steady, under_way
from .pilot import OWN

if TYPE_CHECKING:
    import xarray

COARSE = 0.25
"""Cells of the coarse run over those of the scene, if these are many: it takes `OWN` at least, as pilots do."""

ROWS = 50
"""States of the coarse run that are looked at, about."""

STILL = 1e-6
"""A cell whose |u| is below this share of the largest ever is at rest."""

SMEARED = 0.01
"""The first order is not enough if it is foreseen to put this share of the mass where the second does not."""

NUMBER = 0.4
FEW, MANY = 4, 64
"""Fitted nodes and cells of a grid that are timed."""


@dataclass(frozen=True)
class Part:
    """A part of the model: whether the scene needs it, why, and what it costs."""

    name: str
    needed: bool
    because: str
    costs: str


@dataclass(frozen=True, eq=False)
class Advice:
    """What a scene requires, and the coarse run behind it.

    Attributes:
        parts: Each part of the model.
        t: Times, shape (nt,).
        low, high: Range of the velocities u - c to u + c over time, shape (nt,); NaN where there is no mass.
        moving: Share of the cells that move, shape (nt,).
        resting: Share of the cells that hold mass at rest, shape (nt,).
        dry: Share of the cells without mass, shape (nt,).
        smeared: What first order in place of second does on all cells: L1(h) at the end over the mass, foreseen.
    """

    parts: tuple[Part, ...]
    t: Array
    low: Array
    high: Array
    moving: Array
    resting: Array
    dry: Array
    smeared: float


def advise(scene: Scene, clock: Fixed | Courant, **options: Any) -> Advice:
    """Say which parts of the model a scene needs.

    Args:
        scene: What happens.
        clock: Its end is looked up to.
        options: `keep`, `resume`, `tell`, ... of `kinsim.study`.

    Raises:
        InputError: The scene has no mass, or the coarse run does not come to its end.
    """
    check_given("advise", scene, Macroscopic(4), clock)
    share = min(max(COARSE, OWN / scene.cells.count), 1.0)
    coarse = finer(scene, share)
    both, apart = _both_orders(coarse, clock.end, options)
    smeared = apart
    if share < 1.0:
        _, before = _both_orders(finer(coarse, 0.5), clock.end, options)
        halved = np.clip(apart / before, 0.5, 1.0) if before > 0.0 else 1.0
        smeared *= float(halved) ** -math.log2(share)
    found = both.isel(method=0)
    t, h, u = (found[f"history_{name}"].to_numpy() for name in ("t", "h", "u"))
    wet, c = h > 0.0, np.sqrt(2.0 * coarse.beta * h)
    moves = np.abs(u) > STILL * np.abs(u).max() if u.any() else np.zeros(u.shape, bool)
    filled = wet.any(axis=1)
    low, high = np.where(wet, u - c, np.inf).min(axis=1), np.where(wet, u + c, -np.inf).max(axis=1)
    seen = Advice(
        (), t, np.where(filled, low, np.nan), np.where(filled, high, np.nan),
        moves.mean(axis=1), (wet & ~moves).mean(axis=1), (~wet).mean(axis=1), smeared,
    )  # fmt: skip
    return Advice(_parts(scene, seen, _costs(under_way(scene), options)), *list(vars(seen).values())[1:])


def _both_orders(scene: Scene, end: float, options: dict[str, Any]) -> tuple[xarray.Dataset, float]:
    """Runs of first and of second order, and how far they end apart: L1(h) over the mass."""
    method, mass = Macroscopic(4), mass_of(scene, end)
    pace = steady(scene, method, NUMBER, end)
    every = max(1, pace.steps // ROWS)
    orders = {"method": [method, Macroscopic(4, order=2)]}
    both = study(scene, method, pace, orders, fields=("h", "u"), save_every=every, **options)
    check_ended(both, "advise: the coarse run", "take a scene that comes to its end")
    return both, float(np.abs(np.diff(both["h"].to_numpy(), axis=0)).sum()) * scene.cells.dx / mass


def _costs(scene: Scene, options: dict[str, Any]) -> dict[str, float]:
    """Seconds per step of each way, the least of short runs that take turns."""
    ways: dict[str, Any] = {
        "scheme 1": Macroscopic(1), "scheme 3": Macroscopic(3), "scheme 4": Macroscopic(4),
        "second order": Macroscopic(4, order=2), "fitted": Kinetic(velocity=Fitted(FEW)),
        "grid": Kinetic(velocity=Uniform(MANY)),
    }  # fmt: skip
    over = {
        "method": [*ways.values(), ways["scheme 4"]],
        "friction": [*[scene.friction] * len(ways), Frictionless()],
    }
    clock = short_clock(scene, NUMBER)
    found = study(scene, ways["scheme 4"], clock, over, paired=True, repeats=ROUNDS, **options)
    each = (found["wall_time"] / found["steps"]).min("repeat").to_numpy().tolist()
    return dict(zip([*ways, "frictionless"], each, strict=True))


def _parts(scene: Scene, seen: Advice, cost: dict[str, float]) -> tuple[Part, ...]:
    def times(way: str, of: str) -> str:
        return f"{cost[way] / cost[of]:.2g} times a step of {of}"

    printed, alone = np.isfinite(cost["scheme 1"]), "in scheme 4, which alone can run the scene"
    pull, hold = float(np.max(np.abs(scene.pull))), float(np.max(scene.resistance))
    holding = float(np.mean(scene.resistance >= np.abs(scene.pull))) if hold > 0.0 else 0.0
    does = {0.0: "slows but cannot hold mass", 1.0: "holds mass"}.get(
        holding, f"holds mass on {_percent(holding)} of x"
    )
    rests = f"R = {hold:.3g} and a pull of up to {pull:.3g}: it {does}" if hold > 0.0 else "there is none"
    friction = f"{cost['scheme 4'] / cost['frictionless']:.2g} times a step without" if hold > 0.0 else "nothing"
    resting, moving = seen.resting[1:], seen.moving[1:]
    reach = np.maximum(np.abs(seen.low), np.abs(seen.high))
    reach = reach[np.isfinite(reach)]
    mixed = (moving > 0) & (resting > 0) & (hold > 0.0)
    settles = float(seen.moving[-1]) == 0.0
    return (
        Part("pull of the chute", pull > 0.0, f"|sin zeta| = {pull:.3g}", "nothing of note"),
        Part("friction", hold > 0.0, rests, friction),
        Part("static friction (scheme 4)", holding > 0.0 and bool(resting.any()),
             f"up to {_percent(resting.max())} of the cells hold mass at rest after the start",
             times("scheme 4", "scheme 1") if printed else alone),
        Part("coupling of slow and fast", bool(mixed.any()),
             f"with friction, both meet in {_percent(mixed.mean())} of the states",
             f"in scheme 4; scheme 3: {times('scheme 3', 'scheme 1')}" if printed else alone),
        Part("dry ground (scheme 4)", bool(seen.dry.any()),
             f"{_percent(seen.dry[0])} of the cells are empty at the start, {_percent(seen.dry[-1])} at the end",
             "in scheme 4"),
        Part("nodes that follow (fitted, window)", bool(reach.max() > 2.0 * reach.min()),
             f"velocities reach {reach[0]:.2g} at the start, {reach.max():.2g} at most, {reach[-1]:.2g} at the end",
             f"{MANY} on a grid: {times('grid', 'scheme 4')}; {FEW} fitted: {times('fitted', 'scheme 4')}"),
        Part("every cell in every step", float(np.median(moving)) > 0.5,
             f"{_percent(np.median(moving))} of the cells move half of the time, {_percent(moving[-1])} at the end",
             "cells at rest are free" + ("; stop_at_rest ends earlier" if settles else "")),
        Part("second order", seen.smeared > SMEARED,
             f"the first puts about {100.0 * seen.smeared:.2g} percent of the mass elsewhere",
             times("second order", "scheme 4")),
    )  # fmt: skip


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} percent"
