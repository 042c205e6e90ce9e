"""Why (17) itself is not discretised: the mass it loses on a bend, and the twin that does not close.

(17) carries the density of rho = beta h. Transport moves rho without sources, the force gives gamma m back; no two
discrete steps cancel as the two terms do, and the sum of h dx drifts by a dx - b dt: each part is measured alone, with
its order. The density of h with the beta of each cell has nothing to give back; its mass stays to rounding, a wall on
the bend included, if the wall's ghost has the beta of the inner cell and not that of its own place.

The force of (17) grows with xi^2, so that what it does to mass and momentum depends on all of f. What leaves transport
is no equilibrium; a formula in (rho, m) alone, the image of the equilibrium under Riccati's map, is another scheme,
from which the one on velocity nodes keeps a distance of order dt however fine they are. A projection between transport
and force closes the twin, and does nothing for the mass. Affine forces take the moments of any density by formula: the
affine relative of (17) closes as it is, and still drifts. Pushing particles of h by F_c conserves mass for every c, and
closes for c = 0 alone, which is the rigid shift, (23).

A cap slides from 35 degrees through a quintic bend onto flat ground, under friction of 25 degrees; five forms differ in
nothing but the force and the density (`laboratory/forms.py`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.bend import Bend, cap
from laboratory.forms import CLOSED, FORMS, Closed, OnNodes, Pushed, Track, march
from laboratory.orders import halvings, order
from laboratory.pictures import COLOURS, MARKS
from matplotlib.figure import Figure

from kinsim.kinetic.velocity import Grid
from kinsim.method import EquilibriumName
from kinsim.smooth.forces import residual_of_17, residual_of_family

END, REACH = 4.0, 3.6
"""When the cap has left the bend, and the outer edge of the velocities: 1.3 times the fastest particle."""

FIRST, SECOND, NONE = (0.9, 1.1), (1.75, 2.6), (-0.2, 0.4)
"""What orders 1, 2 and 0 are when observed; the rim of M, with dxi^(5/2), raises the second."""

Gaps = dict[tuple[str, bool], list[float]]
"""Relative L1(h) between velocity nodes and closed form, by form and whether f is projected before the force."""


def main(chapter: Chapter) -> None:
    """What the drift is made of, every form on the bend, walls, the twin, and all in one table."""
    parts_of_the_drift(chapter)
    tracks = mass_on_the_bend(chapter, halvings(30, 6 if chapter.full else 3))
    mass_between_walls(chapter)
    count, nodes = (120, halvings(32, 7)) if chapter.full else (48, halvings(32, 5))
    gaps = twins(chapter, count, nodes)
    summary(chapter, tracks, gaps, nodes)
    chapter.figure(draw(tracks["(17)"], tracks["rigid shift"], gaps, nodes), "lesson",
                   "The mass on the bend, and the distance between velocity nodes and closed form.")  # fmt: skip


def slide(form: str, count: int, steps: int, wing: Closed | OnNodes = CLOSED) -> Track:
    """The cap through the bend in `steps` steps."""
    bend = Bend(count=count)
    return march(FORMS[form], wing, bend, *cap(bend), END / steps, steps)


def steps_for(count: int) -> int:
    """So that dt = dx / 5, a Courant number of 0.55."""
    return 5 * count // 3


def parts_of_the_drift(chapter: Chapter) -> None:
    """a dx - b dt: dt alone is halved, and the limits dt to 0 are compared over dx."""
    counts, steps = halvings(30, 3), halvings(150, 3)
    dx, dt = [Bend(count=count).dx for count in counts], [END / n for n in steps]
    found = np.array([[slide("(17)", count, n).drift[-1] for n in steps] for count in counts])
    limits = 2.0 * found[:, -1] - found[:, -2]
    chapter.table(
        "Drift of the mass of (17) at the end, in millionths of the mass",
        ("cells", "dx", *(f"dt = {each:.3g}" for each in dt), "dt to 0"),
        [
            [n, d, *(round(1e6 * each) for each in (*row, end))]
            for n, d, row, end in zip(counts, dx, found, limits, strict=True)
        ],
    )
    chapter.claim("(17): order in dx of the drift at dt to 0", order(dx, limits), low=FIRST[0], high=FIRST[1])
    for count, row in zip(counts, np.diff(found), strict=True):
        chapter.claim(f"(17), {count} cells: order in dt of the rest of the drift", order(dt[:-1], row),
                      low=FIRST[0], high=FIRST[1])  # fmt: skip


def mass_on_the_bend(chapter: Chapter, counts: list[int]) -> dict[str, dict[int, Track]]:
    """All forms in closed form at dt = dx / 5; by form and number of cells."""
    tracks = {name: {count: slide(name, count, steps_for(count)) for count in counts} for name in FORMS}
    for name, by_count in tracks.items():
        last = [track.drift[-1] for track in by_count.values()]
        if FORMS[name].scaled:
            widths = [Bend(count=count).dx for count in counts]
            chapter.claim(f"{name}: drift over the mass, {counts[0]} cells", last[0], low=1e-3, high=4e-3)
            chapter.claim(
                f"{name}: order of the drift at dt = dx / 5", order(widths, last), low=FIRST[0], high=FIRST[1]
            )
        else:
            worst = max(np.abs(track.drift).max() for track in by_count.values())
            chapter.claim(f"{name}: largest drift over the mass", worst, high=1e-14)
    errors = {name: _error(by_count) for name, by_count in tracks.items()}
    chapter.claim("(17): error of h over that of the rigid shift, each to its own finest run",
                  errors["(17)"] / errors["rigid shift"], low=0.95, high=1.2)  # fmt: skip
    return tracks


def _error(by_count: Mapping[int, Track]) -> float:
    coarse, fine = min(by_count), max(by_count)
    return float(np.abs(by_count[coarse].h - by_count[fine].h.reshape(coarse, -1).mean(axis=1)).sum())


def mass_between_walls(chapter: Chapter) -> None:
    """A thousand steps of a layer that sloshes without friction between walls, both on the bend."""
    inner = Bend(left=18.0, right=21.0, count=48, delta=0.0)
    place = replace(inner, wall="place")
    rows = [(name, "the inner cell", inner) for name in ("(17)", "affine force", "rigid shift")]
    rows.append(("rigid shift", "its own place", place))
    found = {row[:2]: _sloshed(*row) for row in rows}
    chapter.table("Largest drift over the mass in 1000 steps between walls on the bend",
                  ("form", "a ghost has the beta of", "drift"),
                  [[*row, drift] for row, drift in found.items()])  # fmt: skip
    for (name, ghosts), drift in found.items():
        what = f"{name}, ghosts with the beta of {ghosts}, 1000 steps between walls: drift over the mass"
        if FORMS[name].scaled:
            chapter.claim(what, drift, low=3e-3, high=3e-2)
        elif ghosts == "the inner cell":
            chapter.claim(what, drift, high=1e-14)
        else:
            chapter.claim(what, drift, low=1e-5, high=1e-4)


def _sloshed(name: str, ghosts: str, bend: Bend) -> float:
    still = np.zeros(bend.count)
    return float(np.abs(march(FORMS[name], CLOSED, bend, still + 0.5, still, 0.4 * bend.dx, 1000).drift).max())


def twins(chapter: Chapter, count: int, nodes: list[int]) -> Gaps:
    """How far velocity nodes are from closed form as they get finer, at one dx and dt."""
    steps, dxi = steps_for(count), [2 * REACH / n for n in nodes]
    gaps: Gaps = {}
    for name in FORMS:
        twin = slide(name, count, steps)
        for projected in (False, True):
            runs = [slide(name, count, steps, on_nodes(n, projected)) for n in nodes]
            gaps[name, projected] = [gap(track, twin) for track in runs]
            closes = projected or name in ("affine force", "rigid shift")
            low, high = SECOND if closes else NONE
            how = "projected before the force" if projected else "f as it is"
            chapter.claim(f"{name}, {how}: order in dxi of the distance to the twin, last halvings",
                          order(dxi[-3:] if closes else dxi[-2:], gaps[name, projected][-3 if closes else -2 :]),
                          low=low, high=high)  # fmt: skip
            if name == "(17)":
                share = runs[-1].drift[-1] / twin.drift[-1]
                chapter.claim(f"(17), {how}: drift on nodes over that in closed form", share, low=0.95, high=1.05)
    n, left = nodes[-1], gaps["(17)", False][-1]
    half = gap(slide("(17)", count, 2 * steps, on_nodes(n, False)), slide("(17)", count, 2 * steps))
    chapter.claim(
        "(17), f as it is: order in dt of the distance that is left", order([2, 1], [left, half]), low=0.7, high=1.2
    )
    plain = slide("rigid shift", count, steps, on_nodes(n, False, "sampled"))
    chapter.claim("rigid shift: distance with weights xi_j^2 over that with xi_j^2 - dxi^2/12",
                  gap(plain, slide("rigid shift", count, steps)) / gaps["rigid shift", False][-1], low=10)  # fmt: skip
    heads = ("form", "before the force", *(f"{n} nodes" for n in nodes))
    rows = [[name, "projected" if projected else "f as it is", *row] for (name, projected), row in gaps.items()]
    chapter.table(
        f"L1(h) between velocity nodes and closed form over the mass, {count} cells, {steps} steps", heads, rows
    )
    return gaps


def on_nodes(count: int, projected: bool, weights: EquilibriumName = "cell-average") -> OnNodes:
    """A wing of `count` velocity nodes."""
    return OnNodes(Grid(count, 2 * REACH / count), projected, weights)


def gap(track: Track, twin: Track) -> float:
    """L1(h) over the mass."""
    return float(np.abs(track.h - twin.h).sum() / twin.h.sum())


def summary(chapter: Chapter, tracks: Mapping[str, Mapping[int, Track]], gaps: Gaps, nodes: list[int]) -> None:
    """Mass, twin and rest of every form."""
    angle = (np.arange(1000) + 0.5) * np.pi / 1000 - 0.5 * np.pi
    xi, width = np.sqrt(2.0) * np.sin(angle), np.sqrt(2.0) * np.cos(angle) * np.pi / 1000
    of_17 = residual_of_17(xi, 1.0, 1.0)
    left = {"(17)": of_17, "affine force": 0.0 * xi} | {
        name: residual_of_family(xi, 1.0, 1.0, 1.0, form.c) for name, form in FORMS.items() if isinstance(form, Pushed)
    }
    count = sorted(tracks["(17)"])[1]
    rows = [
        [name, "rho" if form.scaled else "h", float(np.abs(tracks[name][count].drift).max()), gaps[name, False][-1],
         gaps[name, True][-1], float((np.abs(left[name]) * width).sum())]
        for name, form in FORMS.items()
    ]  # fmt: skip
    heads = ("form", "density of", f"drift over the mass, {count} cells", f"distance to the twin, {nodes[-1]} nodes",
             "the same, projected before the force", "int |Q| dxi at rest, rho = beta = gamma = 1")  # fmt: skip
    chapter.table("Five kinetic forms of (13)", heads, rows)
    worst = {row[0]: row[-1] for row in rows}
    chapter.claim(
        "affine force and c = 1/3: int |Q| dxi at rest", worst["affine force"] + worst["F_c, c = 1/3"], high=1e-14
    )
    chapter.claim("(17): int |Q| dxi at rest for rho = gamma = 1", worst["(17)"], low=0.1, high=1.0)


def draw(tracks: Mapping[int, Track], kept: Mapping[int, Track], gaps: Gaps, nodes: list[int]) -> Figure:
    """Left the mass over time, right the distance to the twin over the velocity nodes."""
    figure = Figure(figsize=(11.5, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for number, (count, track) in enumerate(list(tracks.items())[:3]):
        colour = COLOURS[number]
        left.plot(track.t, 1e3 * track.drift, color=colour, linewidth=1.8)
        left.annotate(f"(17), {count} cells", (END, 1e3 * track.drift[-1]), xytext=(-4, 5), textcoords="offset points",
                      color=colour, fontsize=9, ha="right")  # fmt: skip
    track = kept[min(kept)]
    left.plot(track.t, 1e3 * track.drift, color="black", linewidth=1.8, linestyle="--")
    left.annotate(
        "rigid shift, any cells", (END, 0.0), xytext=(-4, -12), textcoords="offset points", fontsize=9, ha="right"
    )
    left.set_title("change of the mass on the bend, dt = dx / 5", loc="left", fontsize=10)
    left.set(xlabel="t (dimensionless)", ylabel="change of the mass (thousandths)")
    dxi = [2 * REACH / n for n in nodes]
    for number, (key, label) in enumerate(SHOWN.items()):
        style = {"color": COLOURS[number], "marker": MARKS[number], "linestyle": "--" if key[1] else "-"}
        right.loglog(dxi, gaps[key], markersize=5, linewidth=1.6, label=label, **style)
    ends, low = np.array([dxi[-1], dxi[0]]), 0.4 * gaps["rigid shift", False][-1]
    right.loglog(ends, low * (ends / ends[0]) ** 2, color="0.6", linewidth=1, label="order 2")
    right.set_xticks(dxi, [f"{each:.2g}" for each in dxi])
    right.minorticks_off()
    right.set_title("distance between velocity nodes and closed form", loc="left", fontsize=10)
    right.set(xlabel="width dxi of a velocity cell (dimensionless)", ylabel="L1(h) over the mass (dimensionless)")
    right.legend(frameon=False, fontsize=9)
    for axes in (left, right):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


SHOWN = {
    ("(17)", False): "(17), f as it is",
    ("F_c, c = 1/3", False): "F_c, c = 1/3, f as it is",
    ("(17)", True): "(17), projected before the force",
    ("affine force", False): "affine force, f as it is",
    ("rigid shift", False): "rigid shift, f as it is",
}


if __name__ == "__main__":
    run(main, __doc__)
