"""What is measured of a variant, on a scene or on a pile."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Fixed, Kinetic, Macroscopic, Profile, Run, Scene, load_scene, simulate
from kinsim.kinetic.equilibrium import fill, weights
from kinsim.kinetic.gauss_jacobi import gauss_jacobi
from kinsim.kinetic.velocity import Fitted
from kinsim.mean import mean_velocity
from kinsim.simulate import find_bound

from .variants import Make

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A scene of the paper, its cells and its clock as they are used here, and the run of the closed form."""

    name: str
    scene: Scene
    clock: Fixed
    bound: float
    twin: Run
    floor: float
    """L1(h) between the twin and itself with each height moved by at most one ulp."""


def make_case(name: str, coarser: int, steps: int, scheme: int = 3) -> Case:
    """`name` with cells and steps of time `coarser` times the paper's, `steps` of them."""
    scene, _, clock = load_scene(name)
    scene = replace(scene, cells=replace(scene.cells, count=scene.cells.count // coarser))
    clock = Fixed(clock.dt * coarser, steps)
    bound = find_bound(scene, Kinetic(scheme), clock)
    twin = simulate(scene, Macroscopic(scheme), clock, steps)
    again = simulate(disturbed(scene, 2.3e-16), Macroscopic(scheme), clock, steps)
    return Case(name, scene, clock, bound, twin, distance(again, twin))


def disturbed(scene: Scene, size: float, seed: int = 1) -> Scene:
    """Each height moved by a relative -size, 0 or size."""
    h, q = scene.initial()
    dice = np.random.default_rng(seed).choice([-1, 0, 1], h.size)
    return replace(scene, heap=Profile(h * (1.0 + size * dice), mean_velocity(q, h)))


def distance(run: Run, other: Run) -> float:
    """L1(h) at the end."""
    return float(np.abs(run.h[-1] - other.h[-1]).sum() * run.scene.cells.dx)


def made_drift(run: Run) -> float:
    """Relative change of mass that neither inflow nor mixed faces account for: what sums taken anew make."""
    mixed = run.entries["coupling_drift"][-1] / run.entries["mass"][0]
    return float(abs(run.mass_drift - mixed))


def unbooked_drift(run: Run) -> float:
    """Relative change of mass that the ledger does not account for.

    It books inflow, what mixed faces make and, where U is summed anew from f, what that makes.
    """
    at_end = {name: column[-1] for name, column in run.entries.items()}
    booked = at_end["inflow_left"] + at_end["inflow_right"] + at_end["coupling_drift"] + at_end["mended"]
    first = run.entries["mass"][0]
    return float(abs(at_end["mass"] - first - booked) / first)


def fallen_back(run: Run) -> float:
    """How often the equilibrium fell back to few nodes, per cell and step."""
    if "fallbacks" not in run.entries:
        return 0.0
    return float(run.entries["fallbacks"][-1] / (run.steps * run.scene.cells.count))


def moment_defects(run: Run) -> tuple[float, float, float]:
    """Largest defects of the moments 0, 1, 2 over the saved states, over the flux scale h (|u| + c)^k.

    On a grid: of the sums over all nodes, with the weights that the fluxes use. On fitted nodes, where the total is
    exact by construction: of the side of xi = 0 that holds less.
    """
    beta = run.scene.beta
    worst = np.zeros(3)
    for h, u in zip(run.h, run.u, strict=True):
        c = np.sqrt(2.0 * beta * h)
        found = _fitted_defects(run, h, u, c) if isinstance(run.method.velocity, Fitted) else _sums_off(run, h, u, c)
        scale = h * (np.abs(u) + c) ** np.arange(3)[:, None]
        worst = np.maximum(worst, (np.abs(found) / scale).max(axis=1))
    return tuple(map(float, worst))


def _sums_off(run: Run, h: Array, u: Array, c: Array) -> Array:
    beta, name = run.scene.beta, run.method.equilibrium
    grid = run.method.velocity.grid(float((np.abs(u) + c).max()))
    rows = fill(name, h, u, h, u, beta, grid)
    w1, w2 = weights(name, grid)
    up, down = rows[:, grid.half :], rows[:, grid.half - 1 :: -1]
    sums = grid.dxi * rows.sum(axis=1), (up - down) @ w1, (up + down) @ w2
    return np.array(sums) - [h, h * u, h * u * u + 0.5 * beta * h * h]


def _fitted_defects(run: Run, h: Array, u: Array, c: Array) -> Array:
    a = np.minimum(np.abs(u) / c, 1.0)
    mass = h * (0.5 - (a * np.sqrt(1.0 - a * a) + np.arcsin(a)) / math.pi)
    few, many = (_smaller_side(n, h, c, 1.0 - a) for n in (run.method.velocity.count, 40))
    return np.array([few[0] - mass, few[1] - many[1], few[2] - many[2]])


def _smaller_side(count: int, h: Array, c: Array, b: Array) -> list[Array]:
    s, W = map(np.array, gauss_jacobi(count))
    b = b[:, None]
    nodes = c[:, None] * b * (1.0 - s)
    masses = 2.0 / math.pi * h[:, None] * b**1.5 * W * np.sqrt(2.0 - b * s) / (1.0 - s)
    return [(masses * nodes**k).sum(axis=1) for k in range(3)]


def pile() -> Scene:
    """An admissible pile on an incline: its slope lies within what friction can hold, up to nine tenths of it."""
    cells = Cells(-2, 2, 64)
    scene = Scene(cells=cells, heap=Profile(np.ones(64)), chute=ConstantSlope(0.1), friction=Coulomb(0.4), epsilon=0.4)
    s, R = scene.chute.sin, scene.resistance
    slopes = np.random.default_rng(7).uniform(s - 0.9 * R, s + 0.9 * R, 64)
    rise = np.cumsum(slopes) * cells.dx / scene.beta
    return replace(scene, heap=Profile(rise - rise.min() + 0.5))


def rest_residual(make: Make, n: int, steps: int) -> float:
    """Largest |q| of the pile in `steps` steps of scheme 3."""
    scene, clock = pile(), Fixed(1e-3, steps)
    bound = find_bound(scene, Kinetic(3), Fixed(1e-3, 1))
    return float(np.abs(simulate(scene, make(3, n, bound), clock, max(steps // 50, 1)).q).max())


def entropy_defect(case: Case, method: Kinetic, steps: int) -> float:
    """Largest increase of the discrete entropy in a step, over the entropy, by transport or by projection; scheme 1.

    Transport takes M^n to f; projection takes f, after the force, to M^{n+1}. What crosses the two ends and what the
    force does is left out. 0 if there is no increase.
    """
    run = simulate(case.scene, method, replace(case.clock, steps=steps), 1, causes=True)
    change = run.causes["step"].sel(quantity="entropy").isel(t=slice(1, None))
    transport = change.sel(stage="transport").values
    projection = change.sel(stage="projection").values[:-1] + change.sel(stage="sampling").values[1:]
    h, q, dx = run.h, run.q, run.scene.cells.dx
    size = (dx * (0.5 * q * q / h + 0.5 * run.scene.beta * h * h)).sum(axis=1).min()
    return max(0.0, float(transport.max() / size), float(projection.max() / size))


def cost(scene: Scene, method: Kinetic, dt: float, steps: int) -> float:
    """ns per step, cell and node: the median of three runs."""
    runs = [simulate(scene, method, Fixed(dt, steps), steps) for _ in range(3)]
    return 1e9 * statistics.median(run.wall_time for run in runs) / (steps * scene.cells.count * nodes(runs[0]))


def nodes(run: Run) -> int:
    """Velocity nodes at the end of a run."""
    velocity = run.method.velocity
    reach = float((np.abs(run.u[-1]) + np.sqrt(2.0 * run.scene.beta * run.h[-1])).max())
    return velocity.count if isinstance(velocity, Fitted) else int(velocity.grid(reach).count)


def order(nodes: list[int], errors: list[float]) -> float:
    """Slope of log error over log n, its sign turned."""
    return float(-np.polyfit(np.log(nodes), np.log(np.maximum(errors, 1e-300)), 1)[0])
