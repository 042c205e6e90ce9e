"""Every variant of the kinetic wing against the closed form, on two scenes of the paper.

A velocity grid replaces the half-range integrals of (3) and (14) by sums. What that costs is measured here for every
equilibrium, force, projection and velocity space that kinsim has, over the number n of velocity nodes:

- moments 0, 1, 2: largest defect of the discrete M over the states of the run, on the flux scale h (|u| + c)^k
  (on fitted nodes, where totals are exact, of the side of xi = 0 that holds less);
- L1(h): difference in height to the closed-form twin at the end, scheme 3 as in the scene;
- drift: relative change of mass that the ledger does not book;
- rest: largest |q| of an admissible pile on an incline;
- entropy: largest increase of the discrete kinetic entropy in a step by transport or by projection, over the entropy,
  scheme 1 with upwind faces;
- ns: wall time per step, cell and node, at the paper's number of cells, a median of three;
- few: how often the equilibrium fell back to few nodes, per cell and step.

A new room appears in the tables by being listed in its registry. Small: every fourth cell of the paper, steps of time
four times as long, 500 of them, n to 128. Full: the paper's cells and step of time and n to 512, but 2000 steps and
not all of the paper's 10000 (silo) and 4000 (sine). Both end at t = 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from claims import Chapter, run
from laboratory.densities import is_derivative
from laboratory.measures import (
    Case,
    cost,
    distance,
    disturbed,
    entropy_defect,
    fallen_back,
    make_case,
    moment_defects,
    order,
    rest_residual,
    unbooked_drift,
)
from laboratory.pictures import Lines
from laboratory.variants import FITTED, Variant, variants
from matplotlib.figure import Figure

from kinsim import Macroscopic, Run, load_scene, simulate
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES

EPS = float(np.finfo(float).eps)
SCENES = ("silo", "sine")

PROMISED = {
    "sampled": (1.5, 1.5, 1.5),
    "cell-average": (math.inf, 2.5, 2.0),
    "matched": (math.inf, math.inf, math.inf),
    "entropic": (math.inf, math.inf, 1.5),
}
"""Orders in n of the moments 0, 1, 2; infinite where they hold to rounding."""


@dataclass(frozen=True)
class Size:
    """How much is computed: cells and steps of time `coarser` times the paper's."""

    coarser: int
    steps: int
    nodes: tuple[int, ...]
    rest_steps: int
    entropy_steps: int
    timed_steps: int


SMALL = Size(4, 500, (16, 32, 64, 128), 200, 50, 8)
FULL = Size(1, 2000, (16, 32, 64, 128, 256, 512), 1000, 50, 8)


@dataclass(frozen=True)
class Row:
    """What was measured of one variant with n nodes on one scene."""

    case: Case
    variant: Variant
    n: int
    run: Run
    moments: tuple[float, float, float]
    off: float
    drift: float
    rest: float
    entropy: float | None
    ns: float
    few: float

    def cells(self) -> list[Any]:
        """The row of a table."""
        entropy = "n/a" if self.entropy is None else self.entropy
        return [
            self.variant.name, self.n, *self.moments, self.off, self.drift, self.rest, entropy, self.ns, self.few
        ]  # fmt: skip


HEADS = ("variant", "n", "mom. 0", "mom. 1", "mom. 2", "L1(h)", "drift", "rest", "entropy", "ns", "few")


def main(chapter: Chapter) -> None:
    """Measure, tabulate, draw, judge."""
    size = FULL if chapter.full else SMALL
    rest = {(v.name, n): rest_residual(v.make, n, size.rest_steps) for v in variants() for n in nodes_of(v, size)}
    rows = []
    for name in SCENES:
        case = make_case(name, size.coarser, size.steps)
        rows += [look(case, v, n, size, rest[v.name, n]) for v in variants() for n in nodes_of(v, size)]
        mine = [row.cells() for row in rows if row.case is case]
        chapter.table(
            f"{name}: {case.scene.cells.count} cells, dt = {case.clock.dt:g}, {size.steps} steps; "
            f"pile: {size.rest_steps} steps; L1(h) between the twin and itself after one ulp: {case.floor:.1e}",
            HEADS, mine,
        )  # fmt: skip
    chapter.figure(draw_equilibria(rows), "equilibria", "Moments of M, and whole runs, against the closed form.")
    chapter.figure(draw_forces(rows), "forces", "Force steps and projections in whole runs, against the closed form.")
    judge_equilibria(chapter, rows)
    judge_others(chapter, rows, size)
    judge_floors(chapter)


def nodes_of(variant: Variant, size: Size) -> tuple[int, ...]:
    """Which n a variant is measured at."""
    return tuple(FITTED) if variant.fitted else size.nodes


def look(case: Case, variant: Variant, n: int, size: Size, rest: float) -> Row:
    """Measure one variant."""
    method = variant.make(3, n, case.bound)
    run = simulate(case.scene, method, case.clock, case.clock.steps // 20)
    paper, _, clock = load_scene(case.name)
    entropy = None if variant.fitted else entropy_defect(case, variant.make(1, n, 1.1 * case.bound), size.entropy_steps)
    return Row(
        case, variant, n, run, moment_defects(run), distance(run, case.twin), unbooked_drift(run), rest, entropy,
        cost(paper, variant.make(3, n, 1.2 * case.bound), clock.dt, size.timed_steps), fallen_back(run),
    )  # fmt: skip


# ---- pictures --------------------------------------------------------------------------------------------------------


def draw_equilibria(rows: list[Row]) -> Figure:
    """Whole runs above, moments below; one line per equilibrium, and the fitted nodes."""
    figure = Figure(figsize=(11, 8.4), layout="constrained")
    figure.suptitle("How fast each discrete equilibrium approaches the closed form", fontsize=12)
    (silo, sine), (mass, second) = figure.subplots(2, 2)
    ticks = sorted({row.n for row in rows if row.n & (row.n - 1) == 0})
    for axes, name in ((silo, "silo"), (sine, "sine")):
        case = next(row.case for row in rows if row.case.name == name)
        lines = Lines(
            axes,
            f"{name}, scheme 3, t = {case.twin.t[-1]:g}: difference in height to the closed form, L1",
            1e-14,
            ticks,
        )
        _each_equilibrium(lines, [row for row in rows if row.case is case], lambda row: row.off)
        lines.level(case.floor, "the closed form against itself after one ulp")
        lines.finish(room=2.8)
    for axes, k, word in ((mass, 0, "mass"), (second, 2, "second moment")):
        lines = Lines(axes, f"{word} of M, largest defect in both runs, flux scale", 1e-16, ticks)
        _each_equilibrium(lines, rows, lambda row, k=k: row.moments[k], orders=True, fitted=k > 0)
        lines.finish(room=2.8)
    return figure


def _each_equilibrium(lines: Lines, rows: list[Row], value: Any, orders: bool = False, fitted: bool = True) -> None:
    for number, name in enumerate(EQUILIBRIA):
        _line(lines, rows, name, value, number, orders=orders)
    if fitted:
        _line(lines, rows, "fitted", value, len(EQUILIBRIA))


def _line(
    lines: Lines, rows: list[Row], name: str, value: Any, number: int, label: str = "", orders: bool = False
) -> None:
    found: dict[int, float] = {}
    for row in rows:
        if row.variant.name == name:
            found[row.n] = max(found.get(row.n, 0.0), value(row))
    label = label or name
    if orders and name != "fitted":
        label += (
            "\nto rounding" if max(found.values()) < 1e-12 else f"\nn^-{order(list(found), list(found.values())):.1f}"
        )
    lines.line(list(found), list(found.values()), label, number)


def draw_forces(rows: list[Row]) -> Figure:
    """Whole runs with each force and projection."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    figure.suptitle("Force steps and projections, cell averages: the shifts of (23) are one, (18) keeps its distance")
    for axes, name in zip(figure.subplots(1, 2), SCENES, strict=True):
        mine = [row for row in rows if row.case.name == name]
        ticks = sorted({row.n for row in mine if not row.variant.fitted})
        lines = Lines(
            axes,
            f"{name}, scheme 3, t = {mine[0].run.t[-1]:g}: difference in height to the closed form, L1",
            1e-8,
            ticks,
        )
        for number, (label, names) in enumerate(_alike(mine)):
            _line(lines, mine, names[0], lambda row: row.off, number, label)
        lines.finish(gap=0.055, room=3.2)
    return figure


def _alike(rows: list[Row]) -> list[tuple[str, list[str]]]:
    """Forces and projections with a label; those whose runs end alike share one."""
    groups: list[tuple[list[float], list[str]]] = []
    for name in dict.fromkeys(row.variant.name for row in rows if row.variant.family in ("force", "projection")):
        offs = [row.off for row in rows if row.variant.name == name]
        for known, names in groups:
            if np.allclose(known, offs, rtol=1e-6, atol=0.0):
                names.append(name)
                break
        else:
            groups.append((offs, [name]))
    default = [row.off for row in rows if row.variant.name == "cell-average"]
    labels = []
    for offs, names in groups:
        listed = (["shift-linear"] if np.allclose(offs, default, rtol=1e-6, atol=0.0) else []) + names
        labels.append((",\n".join(listed), names))
    return labels


# ---- claims ----------------------------------------------------------------------------------------------------------


def judge_equilibria(chapter: Chapter, rows: list[Row]) -> None:
    """Each moment as promised, rest, entropy, and whole runs."""
    for name, promises in PROMISED.items():
        mine = [row for row in rows if row.variant.name == name]
        nodes = sorted({row.n for row in mine})
        for k, promise in enumerate(promises):
            worst = [max(row.moments[k] for row in mine if row.n == n) for n in nodes]
            if math.isinf(promise):
                chapter.claim(f"{name}: moment {k} holds to rounding, but for n eps", max(worst), high=nodes[-1] * EPS)
            else:
                chapter.claim(f"{name}: moment {k} has the order {promise:g}", order(nodes, worst), low=promise - 0.2)
    for name in ("cell-average", "matched"):
        silo = [row for row in rows if row.variant.name == name and row.case.name == "silo"]
        found = order([row.n for row in silo], [row.off for row in silo])
        chapter.claim(f"silo, {name}: order of the whole run", found, low=1.8)
    rest = {name: [row.rest for row in rows if row.variant.name == name] for name in EQUILIBRIA}
    chapter.claim("matched: |q| of a pile at rest, any n", max(rest["matched"]), high=1e-14)
    for name in ("sampled", "cell-average", "entropic"):
        chapter.claim(f"{name}: |q| of a pile on the coarsest grid, which is not rest", max(rest[name]), low=1e-6)
    entropy = max(row.entropy or 0.0 for row in rows if row.variant.name == "entropic")
    chapter.claim("entropic: the entropy never rises by transport or projection", entropy, high=1e-14)


def judge_others(chapter: Chapter, rows: list[Row], size: Size) -> None:
    """Conservation, forces, windows, fitted nodes."""
    drift = max(row.drift for row in rows)
    chapter.claim("mass: no variant changes it beyond the ledger, but for steps * eps", drift, high=size.steps * EPS)
    shifts = [name for name in FORCES if not is_derivative(name) and name != "shift-linear"]
    apart = 0.0
    for row in rows:
        if row.variant.name in shifts:
            other = next(
                o for o in rows if o.variant.name == "cell-average" and (o.n, o.case.name) == (row.n, row.case.name)
            )
            apart = max(apart, float(np.abs(row.run.h - other.run.h).max()))
    chapter.claim("flux-difference form: all shifts of (23) give the same h, bit for bit", apart, low=0.0, high=0.0)
    for name in SCENES:
        mine = {(row.variant.name, row.n): row.off for row in rows if row.case.name == name}
        last = size.nodes[-1]
        ratio = mine["derivative-upwind", last] / mine["derivative-upwind", last // 2]
        chapter.claim(f"{name}: (18) does not approach (23) with n, last two grids alike", ratio, low=0.5, high=1.5)
        first = size.nodes[0]
        ratio = mine["re-summed", first] / mine["cell-average", first]
        chapter.claim(
            f"{name}: re-summed is farther from the twin than flux differences, {first} nodes", ratio, low=2.0
        )
        ratio = mine["window", last] / mine["cell-average", last]
        chapter.claim(f"{name}: a window of the same cells is as far from the twin", ratio, low=0.99, high=1.01)
    fitted = [row for row in rows if row.variant.fitted]
    for n, bound in ((3, 1e-6), (5, 1e-10), (6, 1e-12), (8, 2e-15)):
        worst = max(max(row.moments[1:]) for row in fitted if row.n == n)
        chapter.claim(f"fitted, {n} nodes: moments 1, 2 of the smaller side", worst, high=bound)
    silo = max(row.off for row in fitted if row.n == 8 and row.case.name == "silo")
    chapter.claim("fitted, 8 nodes: L1(h) to the twin in silo is rounding", silo, high=1e-12)
    chapter.claim("fitted, 8 nodes: |q| of a pile at rest", max(r.rest for r in fitted if r.n == 8), high=1e-14)


def judge_floors(chapter: Chapter) -> None:
    """How far the closed form is from itself when heights move by 1e-13: no comparison can be finer."""
    bounds = {(1, "silo"): (1e-5, 1e-1), (3, "silo"): (0.0, 1e-10), (3, "sine"): (1e-7, 3e-4)}
    rows = []
    for (scheme, name), (low, high) in bounds.items():
        scene, _, clock = load_scene(name)
        one, other = (
            simulate(s, Macroscopic(scheme), replace(clock), clock.steps) for s in (scene, disturbed(scene, 1e-13))
        )
        off = distance(one, other)
        rows.append([name, scheme, clock.steps, off])
        chapter.claim(f"{name}, scheme {scheme}: closed form against itself after 1e-13 in h", off, low=low, high=high)
    chapter.table("The closed form against itself, heights moved by 1e-13, the paper's size",
                  ("scene", "scheme", "steps", "L1(h)"), rows)  # fmt: skip


if __name__ == "__main__":
    run(main, __doc__)
