"""The transport and the force rooms alone, against free particles.

Without projection a density obeys f_t + xi f_x + g f_xi = 0, whose solution is known for any start: each particle
flies its parabola. So the rooms of the kinetic wing can be judged one by one.

- Transport alone (g = 0): upwind, of first order in dx at any Courant number, which is that of the outermost
  velocity. What dt does to it at a fixed dx is |xi|^2 dt/2 in numerical diffusion, so that E(dt) - E(dt/2) falls like
  dt. Velocity cells carry their average at the speed of their centre, an error of dxi^2; it is alone where f is
  linear in x, which upwind transport carries exactly.
- Force alone (nothing depends on x): steps of 0.4 of a velocity cell. The linear shift is of first order in dxi, and
  the one of third order comes between second and third, as its limiter acts at the top and in the tails; moving the
  nodes makes no error at all. Derivatives as in (18) are of first order, the centred one because of its explicit
  steps.
- Transport and the linear shift in turn, all widths halved: first order, splitting included.
"""

from __future__ import annotations

import math

import numpy as np
from claims import Chapter, run
from laboratory.densities import force, transport
from laboratory.judged import CLOCKS
from laboratory.orders import Panel, falls, halvings, order, picture
from numpy.typing import NDArray

from kinsim import Cells
from kinsim.exact import FreeTransport
from kinsim.exact.transport import Density
from kinsim.method import ForceName

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
END, G, FASTEST = 0.5, 0.7, 3.0
ORDERS: dict[ForceName, tuple[float, float]] = {
    "shift-linear": (0.9, 1.1), "shift-pfc": (2.0, 3.2), "derivative-upwind": (0.9, 1.1),
    "derivative-centred": (0.9, 1.1),
}  # fmt: skip


def cloud(x: Array, xi: Array) -> Array:
    """A smooth start that has all but vanished at the ends."""
    return np.exp(-2.0 * (x - 0.3) ** 2 - 6.0 * (xi + 0.2) ** 2)


def main(chapter: Chapter) -> None:
    """Transport in dx, dt and dxi, the forces in dxi, both together."""
    levels = halvings(1, 5 if chapter.full else 4)
    panels = [
        in_dx(chapter, levels),
        in_dt(chapter),
        in_dxi(chapter),
        forces(chapter, levels),
        jointly(chapter, levels),
    ]
    chapter.figure(picture([panels], "width over its largest value", "L1(f)", (1.0, 2.0, 3.0)), "rooms",
                   "Rooms of the kinetic wing against free particles.")  # fmt: skip


def slope(x: Array, xi: Array) -> Array:
    """A start that is linear in x, which upwind transport carries without error, but for the ends."""
    return (1.0 + 0.1 * x) * np.exp(-6.0 * (xi + 0.2) ** 2)


def fly(count: int, half: int, dt: float, g: float = 0.0, start: Density = cloud) -> float:
    """L1(f) after transport and linear shift in turn, `count` cells and 2 `half` velocity cells, for |x| < 2."""
    cells, edges = Cells(-4, 4, count), np.linspace(-FASTEST, FASTEST, 2 * half + 1)
    dxi, middle = edges[1] - edges[0], 0.5 * (edges[1:] + edges[:-1])
    steps = math.ceil(END / dt * (1 - 1e-12))
    dt = END / steps
    free = FreeTransport(start, g, points=4)
    f = free.averages(cells, edges, 0.0)
    for _ in range(steps):
        moved = transport(f, middle, dt / cells.dx)
        f, _ = force("shift-linear", moved, np.full(count, g * dt), np.ones(count), dxi)
    inner = np.abs(cells.x) < 2.0
    return float(np.abs(f - free.averages(cells, edges, END))[inner].sum() * cells.dx * dxi)


def step(number: float | None, dx: float) -> float:
    """dt at a Courant number of the outermost velocity, or the paper's."""
    return 0.02 * dx if number is None else number * dx / FASTEST


def in_dx(chapter: Chapter, levels: list[int]) -> Panel:
    """Transport alone, dx halved."""
    widths, found = [1 / level for level in levels], {}
    for clock, number in CLOCKS.items():
        found[clock] = [fly(40 * level, 40, step(number, 0.2 / level)) for level in levels]
        rate = order(widths[-3:], found[clock][-3:])
        chapter.claim(f"transport alone, {clock}: order in dx of L1(f)", rate, low=0.85, high=1.05)
    _table(chapter, "Transport alone, L1(f), dx from 0.2", widths, found)
    return Panel("transport, dx", widths, found)


def in_dt(chapter: Chapter) -> Panel:
    """Transport alone, dt halved at dx = 0.1."""
    steps = halvings(16, 6)
    errors = [fly(80, 20, END / n) for n in steps]
    differences = np.diff(errors)
    widths = [steps[0] / n for n in steps[:-1]]
    chapter.claim(
        "transport alone: order in dt of E(dt) - E(dt/2)", order(widths[-3:], differences[-3:]), low=0.9, high=1.1
    )
    _table(chapter, "Transport alone, E(dt/2) - E(dt), dt from 1/32", widths, {"differences": differences.tolist()})
    return Panel("transport, dt", widths, {"E(dt/2) - E(dt)": differences.tolist()})


def in_dxi(chapter: Chapter) -> Panel:
    """Transport alone, dxi halved at dx = 0.1."""
    halves = halvings(8, 5)
    errors = [fly(80, half, END / 16, start=slope) for half in halves]
    widths = [halves[0] / half for half in halves]
    chapter.claim("transport alone, linear in x: order in dxi of L1(f)", order(widths, errors), low=1.8, high=2.2)
    _table(chapter, "Transport alone, linear in x, L1(f), dxi from 3/8", widths, {"linear in x": errors})
    return Panel("transport, dxi", widths, {"linear in x": errors})


def forces(chapter: Chapter, levels: list[int]) -> Panel:
    """Force alone, dxi and dt halved at 0.4 of a velocity cell per step."""
    widths, found = [1 / level for level in levels], {}
    for name, (low, high) in ORDERS.items():
        found[name] = [push(name, 32 * level) for level in levels]
        chapter.claim(
            f"force alone, {name}: order in dxi of L1(f)", order(widths[-3:], found[name][-3:]), low=low, high=high
        )
    exact = [push("shift-exact", 32 * level) for level in levels]
    chapter.claim("force alone, shift-exact: largest L1(f), over eps and steps", max(
        each / (EPS * 14 * level) for each, level in zip(exact, levels, strict=True)), high=8.0)  # fmt: skip
    _table(chapter, "Force alone, L1(f), dxi from 3/32", widths, found | {"shift-exact": exact})
    return Panel("force, dxi", widths, found)


def push(name: ForceName, half: int) -> float:
    """L1(f) of cells in x that are alike, whose particles all gain g dt per step."""
    edges = np.linspace(-FASTEST, FASTEST, 2 * half + 1)
    dxi = float(edges[1] - edges[0])
    steps = round(END * G / (0.4 * dxi))
    dt = END / steps
    free, cell = FreeTransport(lambda x, xi: cloud(0.3 + 0 * x, xi), G), Cells(0, 1, 2)
    f, travelled = free.averages(cell, edges, 0.0), 0.0
    for _ in range(steps):
        f, offset = force(name, f, np.full(2, G * dt), np.ones(2), dxi)
        travelled += float(offset[0])
    return float(np.abs(f - free.averages(cell, edges + travelled, END)).mean(axis=0).sum() * dxi)


def jointly(chapter: Chapter, levels: list[int]) -> Panel:
    """Transport and linear shift, dx, dt and dxi halved together."""
    widths, found = [1 / level for level in levels], {}
    for clock, number in CLOCKS.items():
        found[clock] = [fly(40 * level, 15 * level, step(number, 0.2 / level), G) for level in levels]
        rate = order(widths[-3:], found[clock][-3:])
        chapter.claim(f"transport and shift, {clock}: order in dx, dt and dxi together", rate, low=0.8, high=1.05)
    _table(chapter, "Transport and linear shift, L1(f), dx = dxi from 0.2", widths, found)
    return Panel("together", widths, found)


def _table(chapter: Chapter, caption: str, widths: list[float], found: dict[str, list[float]]) -> None:
    heads = ["", *(f"{width:g}" for width in widths), *["order"] * (len(widths) - 1)]
    chapter.table(caption, heads, [[name, *map(abs, each), *falls(widths, each)] for name, each in found.items()])


if __name__ == "__main__":
    run(main, __doc__)
