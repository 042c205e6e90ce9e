"""Stability at the extremes: what becomes of each method where numbers, slopes and steps are as extreme as can be.

Each point of the maps is a run of about 200 steps of a hump on a layer between walls, thrown at one of them with half
its wave speed; one thing is made extreme at a time, or two in a plane. A second run starts with noise of 1e-9 and takes
the same steps. *Stable* is measured: energy, that of place included, must not rise, the noise must not grow beyond
1e-4 of the highest mass, h must not zigzag, heights must not fall below 0, and no mass may go unbooked. *Repaired* is
stable with something in the books: a window of few nodes that cut, mass made at mixed faces. On the axis of the
Courant number the bound (28) is broken on demand.

The schemes of the paper are mapped beside: scheme 1 cannot stop a thin layer, scheme 2 blows up, scheme 3 makes mass.
The last table follows a wave on a ring for a million steps.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from claims import Chapter, run

from kinsim import Cells, Fitted, Fixed, Frictionless, Kinetic, Macroscopic, Profile, Scene, atlas, simulate
from kinsim.plot.atlas import draw_atlas
from kinsim.stability.axes import USUAL
from kinsim.stability.judge import CLASSES

ROBUST = {
    "scheme-4": Macroscopic(4),
    "scheme-4-second-order": Macroscopic(4, order=2),
    "scheme-4-on-a-grid": Kinetic(4),
    "scheme-4-fitted": Kinetic(4, Fitted(6)),
    "scheme-4-reflecting": Macroscopic(4, statics="reflect"),
}
PRINTED = {
    "scheme-1": Macroscopic(1),
    "scheme-2": Macroscopic(2),
    "scheme-3": Macroscopic(3),
    "scheme-1-on-a-grid": Kinetic(1),
}
COARSEST = 3
"""Points at which a grid is too coarse: two nodes make h zigzag, and on ground of +-89.99 degrees, where c is less than
a velocity cell, energy rises by a percent."""


def main(chapter: Chapter) -> None:
    """A map for each method, the limits on the Courant number, a million steps."""
    some = ("scheme-4", "scheme-4-on-a-grid", "scheme-1")
    methods = {name: method for name, method in (ROBUST | PRINTED).items() if chapter.full or name in some}
    rows, limits = [], []
    for name, method in methods.items():
        planes = [("courant", "zeta")] if chapter.full and name in ("scheme-1", "scheme-4") else []
        long = ["steps"] if chapter.full and name in ("scheme-1", "scheme-4", "scheme-4-second-order") else []
        found = atlas(method, (*USUAL, *long, *planes), steps=200 if chapter.full else 30)
        axis, word = found["axis"].to_numpy(), found["class"].to_numpy()
        line = found["across"].to_numpy() == ""
        inside = line & (axis != "courant")
        rows.append([name, int(line.sum()), *(int((word[line] == one).sum()) for one in CLASSES)])
        bad = int(np.isin(word[inside], ("oscillating", "non-finite")).sum())
        if name in ROBUST:
            grid = "grid" in name
            chapter.claim(f"{name}: points that oscillate or are no number, Courant numbers aside", bad,
                          high=COARSEST if grid else 0)  # fmt: skip
        else:
            chapter.claim(f"{name}: points that oscillate or are no number, Courant numbers aside", bad, low=1)
        limits.append([name, *measured_limit(chapter, name, found)])
        chapter.figure(draw_atlas(found), name, f"{name}: what became of each point.")
    chapter.table("Points by what became of them", ("method", "points", *CLASSES), rows)
    chapter.table("The Courant number: the limit of theory, the largest stable number tried, the next one tried",
                  ("method", "theory", "stable at", "not at"), limits)  # fmt: skip
    million(chapter)


def measured_limit(chapter: Chapter, name: str, found: Any) -> tuple[float, float, str]:
    """Theory beside measurement."""
    at = found["axis"].to_numpy() == "courant"
    at &= found["across"].to_numpy() == ""
    numbers = np.array([float(value) for value in found["value"].to_numpy()[at]])
    good = np.isin(found["class"].to_numpy()[at], ("exact", "stable", "repaired"))
    first_bad = next((number for number, fine in zip(numbers, good, strict=True) if not fine), math.inf)
    limit = 1.0  # (28)
    if name in ROBUST:
        chapter.claim(
            f"{name}: the first Courant number that is not stable, over the limit", first_bad / limit, low=1.001
        )
    stable = numbers[numbers < first_bad]
    return limit, float(stable.max(initial=0.0)), f"{first_bad:g}" if math.isfinite(first_bad) else "none tried"


def million(chapter: Chapter) -> None:
    """Mass of a wave on a ring. Cells are summed exactly (math.fsum), fluxes leave one cell and enter the next."""
    steps = 1_000_000 if chapter.full else 5_000
    y = 2 * np.pi * (np.arange(16) + 0.5) / 16
    scene = Scene(Cells(0.0, 1.0, 16), Profile(1 + 0.3 * np.sin(y), 0.2 * np.cos(y)), friction=Frictionless(),
                  boundary="periodic", epsilon=0.4)  # fmt: skip
    rows = []
    for name, method, dt in (("scheme 1", Macroscopic(1), 0.05), ("scheme 4", Macroscopic(4), 0.05),
                             ("scheme 4, second order", Macroscopic(4, order=2), 0.02)):  # fmt: skip
        one = simulate(scene, method, Fixed(dt, steps), steps)
        start, end = one.h[0], one.h[-1]
        exact = abs(math.fsum([*end, *(-start)])) / math.fsum(start)
        naive = abs(float(sum(end)) - float(sum(start))) / float(sum(start))
        rows.append([name, steps, exact, naive])
        chapter.claim(f"{name}: drift of mass after many steps on a ring", exact, high=1e-12)
    chapter.table("Relative drift of mass, cells summed exactly and from left to right",
                  ("scheme", "steps", "exactly", "left to right"), rows)  # fmt: skip


if __name__ == "__main__":
    run(main, __doc__)
