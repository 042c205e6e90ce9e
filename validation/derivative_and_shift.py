"""The force as a derivative, (18), and as a shift, (23): where they differ.

(18) pushes M^n by -(J/h) dM^n/dxi, (23) shifts f after transport by J/h^{n+1}. Four things follow, each measured here:

- the impulse: dt g h^n in (18), dt g h^{n+1} in (23). Their difference is dt g (h^n - h^{n+1}) in cells that slide, of
  second order in dt per step, of first order in a run, and nothing in slow cells, whose impulse is set by what stops
  them;
- positivity: with upwind differences the density of (18) stays above 0 while lam |xi| + dt g/dxi <= 1 on occupied
  nodes, and not a step longer; with centred ones it never does; a shift always does;
- stability, if (18) is repeated without a projection: upwind up to dt g/dxi = 1, centred never;
- the second moment and the entropy: a rigid shift by a gives 2 a q + a^2 h to the second moment. The linear remap gives
  theta (1 - theta) dxi^2 h more, theta the fraction of a velocity cell; (18) upwind a (dxi - a) h more, which is the
  same up to one cell and a loss beyond; (18) centred a^2 h less. The limiter of PFC costs some of the impulse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.densities import force, is_derivative
from laboratory.measures import distance, order
from laboratory.pictures import COLOURS, MARKS
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import (
    Cells,
    ConstantSlope,
    Fixed,
    Frictionless,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    load_scene,
    simulate,
    step,
)
from kinsim.diagnostics.causes import quantities
from kinsim.kinetic.equilibrium import fill
from kinsim.kinetic.force import FORCES
from kinsim.kinetic.velocity import Grid

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
BETA = 0.4
FINE = 0.0125
"""Velocity cell where positivity is at stake: so small that the force, not transport, sets the limit."""


def main(chapter: Chapter) -> None:
    """The four differences, one after the other."""
    impulse_of_a_step(chapter)
    impulse_in_runs(chapter)
    limits = positivity(chapter)
    growth = stability(chapter, 256 if chapter.full else 128)
    chapter.figure(draw_limits(limits, growth), "limits", "How far the derivative form can go.")
    pushed = moments(chapter)
    chapter.figure(draw_moments(pushed), "moments", "What each force does to second moment, entropy and momentum.")


# ---- the impulse -----------------------------------------------------------------------------------------------------


def impulse_of_a_step(chapter: Chapter) -> None:
    """h^n against h^{n+1} in one step, from a state on its way."""
    rows = []
    for name, scheme in (("sine", 1), ("silo", 3)):
        scene, _, _ = load_scene(name)
        at = simulate(scene, Macroscopic(scheme), Fixed(1e-3, 500), 500)
        h, q = at.h[-1], at.q[-1]
        largest, rest = [], 0.0
        dts = [4e-3, 2e-3, 1e-3, 5e-4]
        for dt in dts:
            one, other = (
                step(scene, Kinetic(scheme, Uniform(64, 4.0), force=f), h, q, dt)
                for f in ("derivative-upwind", "shift-linear")
            )
            slides = ~one.slow & (q != 0.0)
            s, R = scene.chute.sin, scene.resistance
            foreseen = dt * np.where(q > 0, s - R, s + R) * (h - other.h1)
            off = one.impulse - other.impulse
            rest = max(rest, float(np.abs(off - np.where(slides, foreseen, off * ~one.slow)).max() / dt))
            largest.append(float(np.abs(off[slides]).max()))
            rows.append([name, scheme, dt, largest[-1], largest[-1] / float(np.abs(other.impulse).max()),
                         int(slides.sum()), int(one.slow.sum())])  # fmt: skip
        chapter.claim(f"{name}, scheme {scheme}: impulse of (18) less that of (23) is dt g (h^n - h^n+1) where mass "
                      "slides, 0 where it is slow; what is left, over dt", rest, high=64 * EPS)  # fmt: skip
        chapter.claim(f"{name}, scheme {scheme}: order in dt of their difference in one step", -order(dts, largest),
                      low=1.95, high=2.05)  # fmt: skip
    chapter.table("Impulse in one step from the state at t = 0.5, (18) less (23)",
                  ("scene", "scheme", "dt", "largest |difference|", "over largest |J|", "sliding", "slow"),
                  rows)  # fmt: skip


def impulse_in_runs(chapter: Chapter) -> None:
    """The same in whole runs: of first order in dt, whatever the grid."""
    scene, _, _ = load_scene("sine")
    scene = replace(scene, cells=replace(scene.cells, count=140))
    dts, offs, rows = [8e-3, 4e-3, 2e-3], [], []
    for dt in dts:
        clock = Fixed(dt, round(1.6 / dt))
        one, other = (
            simulate(scene, Kinetic(1, Uniform(64, 3.0), force=f), clock, clock.steps)
            for f in ("derivative-upwind", "shift-linear")
        )
        offs.append(distance(one, other))
        rows.append([dt, clock.steps, offs[-1]])
    chapter.claim("sine, scheme 1, t = 1.6: order in dt of (18) against (23)", -order(dts, offs), low=0.9, high=1.1)
    chapter.table("Runs with (18) against runs with (23), sine, 140 cells, scheme 1, 64 nodes, t = 1.6",
                  ("dt", "steps", "L1(h)"), rows)  # fmt: skip


# ---- positivity and stability ----------------------------------------------------------------------------------------


def block() -> tuple[Scene, Array, Array]:
    """A block in the void that slides: no neighbour fills up what it sends away."""
    h = np.zeros(24)
    h[8:16] = 1.0
    scene = Scene(Cells(0, 12, 24), Profile(h), ConstantSlope(0.5), Frictionless(), epsilon=BETA)
    speed = np.sqrt(2.0 * scene.beta)
    u = np.where(h > 0, speed - 40 * FINE, 0.0)  # the support begins at an edge of a velocity cell
    return scene, h, h * u


def positivity(chapter: Chapter) -> dict[str, tuple[Array, Array]]:
    """Least f of one step over lam |xi| + dt g/dxi at the rim of the support, for every force."""
    scene, h, q = block()
    method = Kinetic(1, Uniform(256, 128 * FINE))
    start = step(scene, method, h, q, 1e-9)
    M, xi = start.M[15], start.xi
    rim, dxi = int(np.flatnonzero(M)[0]), xi[1] - xi[0]
    per_dt = abs(xi[rim]) / scene.cells.dx + scene.chute.sin / dxi
    sums = np.arange(0.1, 2.0001, 0.1)
    found = {}
    for name in FORCES:
        least = [step(scene, replace(method, force=name), h, q, s / per_dt).f_force.min() / M[rim] for s in sums]
        found[name] = (sums, np.array(least))
        if not is_derivative(name):
            chapter.claim(f"{name}: least f, transport up to Courant {_courant(sums, per_dt, xi, M, scene):.2f}",
                          min(least), low=0.0, high=np.inf)  # fmt: skip
    upwind, centred = found["derivative-upwind"][1], found["derivative-centred"][1]
    inside = sums <= 1.0 - 1e-9
    chapter.claim("(18) upwind: least f while lam |xi| + dt g/dxi < 1", upwind[inside].min(), low=0.0)
    beyond = sums > 1.05
    chapter.claim("(18) upwind: beyond 1, least f over M at the rim less 1 - (lam |xi| + dt g/dxi)",
                  np.abs(upwind - (1.0 - sums))[beyond].max(), high=1e-9)  # fmt: skip
    nu = sums / per_dt * scene.chute.sin / dxi
    chapter.claim("(18) centred: least f over M at the rim is at most -(dt g/dxi)/2, at any step",
                  (centred + 0.5 * nu).max(), high=1e-12)  # fmt: skip
    chapter.table("Least f after one step over M at the rim of the support",
                  ("lam |xi| + dt g/dxi", *FORCES),
                  [[float(s), *(float(found[name][1][k]) for name in FORCES)] for k, s in enumerate(sums)
                   if k % 3 == 0])  # fmt: skip
    return found


def _courant(sums: Array, per_dt: float, xi: Array, M: Array, scene: Scene) -> float:
    return float(sums[-1] / per_dt * np.abs(xi[M > 0]).max() / scene.cells.dx)


GROWTH: dict[str, Callable[[float], float]] = {
    "derivative-upwind": lambda nu: max(1.0, abs(1.0 - 2.0 * nu)),
    "derivative-centred": lambda nu: float(np.sqrt(1.0 + nu * nu)),
}
"""Largest factor per step of a wave in xi, by von Neumann, nu = dt g/dxi."""


def stability(chapter: Chapter, n: int) -> dict[str, tuple[Array, Array]]:
    """Growth per step of noise in xi when (18) acts on its own result again and again."""
    nus = np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.1, 1.2, 1.4, 1.6])
    found = {}
    for name, factor in GROWTH.items():
        grown = np.array([_growth(name, nu, n) for nu in nus])
        found[name] = (nus, grown)
        foreseen = np.array([factor(nu) for nu in nus])
        chapter.claim(f"{name} repeated: growth per step over what von Neumann allows, at most",
                      (grown / foreseen).max(), high=1.0 + 1e-6)  # fmt: skip
        unstable = foreseen > 1.05
        chapter.claim(f"{name} repeated: growth per step over what von Neumann allows, at least, where it grows",
                      (grown / foreseen)[unstable].min(), low=0.97)  # fmt: skip
    return found


def _growth(name: str, nu: float, n: int) -> float:
    """Growth per step of a packet of random waves, long before it leaves a wide window."""
    steps, wide = 60, 8 * n
    rng = np.random.default_rng(5)
    f = np.zeros((1, wide))
    f[0, wide // 2 - n : wide // 2 + n] = rng.normal(size=2 * n)
    one, sizes = np.ones(1), []
    for _ in range(steps):
        f, _ = force(name, f, np.array([nu]), one, 1.0)
        sizes.append(float(np.sqrt((f * f).sum())))
    return float((sizes[-1] / sizes[steps // 2 - 1]) ** (2.0 / steps))


def draw_limits(limits: dict[str, tuple[Array, Array]], growth: dict[str, tuple[Array, Array]]) -> Figure:
    """Left the least density of one step, right the growth of repeated steps."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    figure.suptitle("How far the derivative form (18) can go; a shift (23) has no limit")
    left, right = figure.subplots(1, 2)
    left.axhline(0, color="0.7", linewidth=1)
    left.axvline(1, color="0.7", linewidth=1)
    shift = next(name for name in limits if not is_derivative(name))
    for name, label, at, side in (
        (shift, "all shifts: never negative", 14, (0, 7)),
        ("derivative-centred", "derivative-centred", 6, (-9, -9)),
        ("derivative-upwind", "derivative-upwind", 13, (9, 0)),
    ):
        sums, least = limits[name]
        style = _style(name)
        left.plot(sums, least, markersize=4.5, **style)
        _label(left, label, (sums[at], least[at]), side, style["color"])
    left.set_title("one step on a block in the void: least f over M at the rim", loc="left", fontsize=10)
    left.set_xlabel("lam |xi| + dt g/dxi at the rim of the support")
    right.axhline(1, color="0.7", linewidth=1)
    for name, at, side in (("derivative-upwind", 6, (9, -6)), ("derivative-centred", 3, (-9, 5))):
        (nus, grown), style = growth[name], _style(name)
        fine = np.linspace(nus[0], nus[-1], 200)
        right.plot(fine, [GROWTH[name](nu) for nu in fine], color=style["color"], linewidth=1.4)
        right.plot(nus, grown, linestyle="none", **style)
        _label(right, name, (nus[at], grown[at]), side, style["color"])
    right.set_title("repeated without projection: growth per step (lines: von Neumann)", loc="left", fontsize=10)
    right.set_xlabel("nu = dt g/dxi")
    for axes in (left, right):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _style(name: str) -> dict[str, str]:
    number = list(FORCES).index(name)
    return {"color": COLOURS[number % len(COLOURS)], "marker": MARKS[number % len(MARKS)]}


def _label(axes: Axes, label: str, at: tuple[float, float], side: tuple[int, int], colour: str) -> None:
    where = "right" if side[0] < 0 else "left" if side[0] > 0 else "center"
    axes.annotate(label, at, xytext=side, textcoords="offset points", ha=where, color=colour, fontsize=9)


# ---- second moment, entropy, limiter ---------------------------------------------------------------------------------

THETAS = np.linspace(0.0, 2.5, 51)

FORESEEN: dict[str, Callable[[Array], Array]] = {
    "shift-linear": lambda t: (t % 1.0) * (1.0 - t % 1.0),
    "shift-exact": lambda t: 0.0 * t,
    "derivative-upwind": lambda t: t * (1.0 - t),
    "derivative-centred": lambda t: -t * t,
}
"""Second moment beyond that of a rigid shift by t cells, over h dxi^2."""


def moments(chapter: Chapter) -> dict[str, Array]:
    """Mass, momentum, second moment and entropy that each force adds beyond a rigid shift by the same J/h."""
    found = {name: pushed(name, 64) for name in FORCES}
    for name, off in found.items():
        chapter.claim(f"{name}: mass", np.abs(off[:, 0]).max(), high=64 * EPS)
        if name in FORESEEN:
            chapter.claim(f"{name}: momentum less J, over h dxi", np.abs(off[:, 1]).max(), high=1e-12)
            wrong = np.abs(off[:, 2] - FORESEEN[name](THETAS)).max()
            chapter.claim(f"{name}: second moment less what the algebra says, over h dxi^2", wrong, high=1e-11)
    coarse, fine = (np.abs(pushed("shift-pfc", n)[1:, 1] / THETAS[1:]).max() for n in (64, 256))
    chapter.claim("shift-pfc: momentum that the limiter takes, over J, 64 nodes", coarse, low=1e-6, high=0.02)
    chapter.claim(
        "shift-pfc: momentum that the limiter takes with 256 nodes, over that with 64", fine / coarse, high=0.5
    )
    chapter.claim("shift-pfc: second moment over h dxi^2 is below a fifth of the linear remap's largest, 1/4",
                  np.abs(found["shift-pfc"][:, 2]).max(), high=0.25 / 5)  # fmt: skip
    picked = [k for k in range(len(THETAS)) if k % 10 == 5]
    for k, word in ((1, "momentum, over h dxi"), (2, "second moment, over h dxi^2"), (3, "entropy, over h dxi^2")):
        chapter.table(f"Beyond a rigid shift by theta cells, 64 nodes: {word}", ("theta", *found),
                      [[float(THETAS[i]), *(float(found[name][i, k]) for name in found)] for i in picked])  # fmt: skip
    return found


def pushed(name: str, n: int) -> Array:
    """What the force `name` adds beyond a rigid shift by theta cells, (thetas, 4): over h (1, dxi, dxi^2, dxi^2)."""
    h, u, grid = 1.0, 0.2, Grid(n, 4.0 / n)
    M = fill("cell-average", *(np.array([v]) for v in (h, u, h, u)), BETA, grid)
    rows = []
    for theta in THETAS:
        J = np.array([theta * grid.dxi * h])
        out, offset = force(name, M, J, np.array([h]), grid.dxi)
        rigid = quantities(M, grid.xi, J / h, BETA, 0)
        rows.append(grid.dxi * (np.array(quantities(out, grid.xi, offset, BETA, 0)) - rigid))
    return np.array(rows) / (h * np.array([1.0, grid.dxi, grid.dxi**2, grid.dxi**2]))


def draw_moments(found: dict[str, Array]) -> Figure:
    """Three panels over the shift in velocity cells."""
    figure = Figure(figsize=(13.5, 4.8), layout="constrained")
    figure.suptitle("What each force adds beyond a rigid shift (64 nodes, cell averages)")
    panels = figure.subplots(1, 3)
    titles = ("second moment / (h dxi^2)", "kinetic entropy / (h dxi^2)", "momentum / (h dxi)")
    for axes, k, title, (low, high) in zip(
        panels, (2, 3, 1), titles, ((-1.05, 0.45), (-0.1, 0.045), (-5e-4, 2e-4)), strict=True
    ):
        axes.axhline(0, color="0.7", linewidth=1)
        for name, off in found.items():
            style = _style(name) | {"marker": "", "linestyle": "--" if name == "shift-exact" else "-"}
            axes.plot(THETAS, off[:, k], linewidth=1.7, **style)
        axes.set(ylim=(low, high), xlim=(0, THETAS[-1]))
        axes.set_title(title, loc="left", fontsize=10)
        axes.set_xlabel("shift in velocity cells, theta = J/(h dxi)")
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    written = {
        "shift-linear": [(0, 1.5, 0.25, (0, 5)), (1, 1.5, 0.018, (0, 5))],
        "shift-pfc": [(0, 1.5, 0.035, (0, 4)), (1, 1.5, 0.0105, (0, -11)), (2, 1.3, -0.00031, (0, -13))],
        "shift-exact": [(0, 2.2, 0.0, (0, -11)), (1, 2.2, 0.0, (0, -11))],
        "derivative-upwind": [(0, 1.5, -0.7, (8, 0)), (1, 1.5, -0.054, (8, 0))],
        "derivative-centred": [(0, 0.05, -0.8, (1, 0)), (1, 0.05, -0.077, (1, 0))],
    }
    for name, places in written.items():
        for panel, x, y, side in places:
            _label(panels[panel], name.replace("e-c", "e-\nc"), (x, y), side, _style(name)["color"])
    _label(panels[2], "all others: 0 to rounding", (1.25, 0.0), (0, 20), "0.3")
    for panel, y in ((0, 0.25), (1, 0.018)):
        _label(
            panels[panel], "derivative-upwind,\nshift-linear", (0.5, y), (0, 5), _style("derivative-upwind")["color"]
        )
    return figure


if __name__ == "__main__":
    run(main, __doc__)
