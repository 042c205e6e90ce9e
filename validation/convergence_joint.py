"""Convergence in dx, dt and dxi together: the density carried, against every exact solution, at four time steps.

All three widths are halved at once, with dt at a Courant number of 0.3, 0.6, 0.9 or at the paper's dt = 0.02 dx, and
24 velocity nodes at dx = 0.25. The velocity error falls like dxi^2, those of dx and dt like dx on straight lines and
between its square root and dx at jumps, corners and dry fronts, so that it is the order of dx that must come out;
where dxi leads on the coarsest grids, up to two.

That goes for scheme 1, and for scheme 3 where it is not scheme 1. On the pile at rest scheme 3 has no error but that of
dxi. What M lacks in its second moment falls like dxi^(5/2), see the chapter on dxi, and differs from face to face; the
differences, over dx, drive the pile, so that 3/2 orders are left when dx is refined as well. This needs a Courant
number below 3 pi/16, where rest is stable; beyond it the table shows what happens. Scheme 1 does not rest, and the sign
of its error on the wedge that stops is up to chance. Uniform slides are met to rounding.
"""

from __future__ import annotations

import numpy as np
from claims import Chapter, run
from laboratory.judged import CASES, CLOCKS, EPS, SLIDES, UNLIKE, Case, cases_of
from laboratory.orders import Panel, falls, halvings, order, picture

from kinsim import Kinetic, Uniform
from kinsim.studies.record import Record

CELLS, NODES = 56, 24


def main(chapter: Chapter) -> None:
    """Both schemes at four time steps."""
    levels = halvings(1, 4 if chapter.full else 3)
    rows = [[orders(chapter, scheme, clock, levels) for clock in CLOCKS] for scheme in (1, 3)]
    chapter.figure(picture(rows, "dx, which dt and dxi follow", "L1(h)", (0.5, 1.0, 2.0)), "errors",
                   "Kinetic wing against exact solutions; dx, dt and dxi are halved together.")  # fmt: skip
    slides(chapter, levels[:2])


def orders(chapter: Chapter, scheme: int, clock: str, levels: list[int]) -> Panel:
    """All exact solutions that a scheme can be asked about."""
    widths, found, rows = [14 / (CELLS * level) for level in levels], {}, []
    for name, case in cases_of(scheme).items():
        if scheme == 3 and name not in UNLIKE:
            continue
        errors = found[name] = [case.error(run) for run in refined(case, scheme, CLOCKS[clock], levels)]
        rows.append([name, *errors, *falls(widths, errors)])
        bounds = expected(scheme, name, clock)
        if bounds is not None:
            what = f"order in dx, dt and dxi together, scheme {scheme}, {name}, {clock}"
            chapter.claim(what, order(widths[-3:], errors[-3:]), low=bounds[0], high=bounds[1])
    heads = ["exact solution", *(f"dx = {width:.4g}" for width in widths), *["order"] * (len(levels) - 1)]
    chapter.table(f"L1(h), kinetic, scheme {scheme}, {clock}", heads, rows)
    return Panel(f"scheme {scheme}, {clock}", widths, found)


def refined(case: Case, scheme: int, number: float | None, levels: list[int]) -> list[Record]:
    """Runs with all three widths halved from level to level."""
    counts = [CELLS * level for level in levels]
    methods = [Kinetic(scheme, Uniform(NODES * level)) for level in levels]
    return case.runs(methods, [case.clock(number, count) for count in counts], counts)


def expected(scheme: int, name: str, clock: str) -> tuple[float, float] | None:
    """Bounds of the order; None where rest is unstable, and where the sign of the error is up to chance."""
    case = CASES[name]
    if name == "pile" and scheme == 1:
        return 0.7, 1.3
    if not case.settled(scheme, CLOCKS[clock]):
        return None
    if name == "pile":
        return 1.1, 1.9
    low, high = case.orders
    return low - 0.1, 2.1 if "wedge" in name else high


def slides(chapter: Chapter, levels: list[int]) -> None:
    """Largest error of h and u at the end, over eps and steps."""
    for name, case in SLIDES.items():
        for scheme in (3,) if case.rests else (1, 3):
            runs = [one for number in CLOCKS.values() for one in refined(case, scheme, number, levels)]
            worst = max(off(case, one) / (EPS * one.figures["steps"]) for one in runs)
            chapter.claim(f"{name}, scheme {scheme}: largest error of h and u, all grids, over eps and steps", worst,
                          high=8.0)  # fmt: skip


def off(case: Case, run: Record) -> float:
    """Largest error of h and u at the end."""
    h, u = case.exact(run.arrays["x"], run.figures["t"])
    return float(max(np.abs(run.arrays["h"] - h).max(), np.abs(run.arrays["u"] - u).max()))


if __name__ == "__main__":
    run(main, __doc__)
