"""Convergence in dx: schemes 1, 2 and 3 against every exact solution, at four time steps.

Judges are exact solutions that come from no scheme. A first-order upwind scheme converges like dx where the solution
is a straight line, and between the square root of dx and dx where it has jumps, corners or dry fronts. Schemes 2 and
3 need a wet bed; on moving ground no cell is slow and scheme 3 is scheme 1, so that what tells them apart is what
starts, stops or rests.

Uniform slides are met to rounding by all schemes, and so are piles at rest by schemes 2 and 3 as long as rest is
stable, see the chapter on limits. Scheme 1 has no rest: on the pile it errs like dx. Beyond
the limits, on shocks under scheme 2 at a Courant number of 0.9 and where a wedge has stopped at 0.6 and 0.9, no order
is claimed: the table shows what happens, and on fine cells that wedge wakes.

At fixed dt = 0.001, the paper's, the error of dt stays behind, and orders may be a tenth lower. On straight lines
there is little else: F~ of scheme 2 takes them without any error of dx, so that its wedges have the order 0. Wedges
in which the errors of dx and dt are alike and of different sign have no order at a fixed dt; they are in the table.
"""

from __future__ import annotations

import numpy as np
from claims import Chapter, run
from laboratory.judged import CASES, CLOCKS, SLIDES, UNLIKE, Case, cases_of
from laboratory.orders import Panel, falls, halvings, order, picture

from kinsim import Courant, Fixed, Macroscopic

FIXED = "dt = 0.001"
TIMES = {name: number for name, number in CLOCKS.items() if number is not None} | {FIXED: None}


def main(chapter: Chapter) -> None:
    """Orders of three schemes, and what is met to rounding."""
    counts = halvings(140, 5 if chapter.full else 3)
    coarser = halvings(70, len(counts))
    rows = [
        [orders(chapter, scheme, clock, coarser if clock == FIXED else counts) for clock in TIMES]
        for scheme in (1, 2, 3)
    ]
    chapter.figure(picture(rows, "dx (dimensionless)", "L1(h)", (0.5, 1.0)), "errors",
                   "Errors against exact solutions, by scheme and time step.")  # fmt: skip
    rounding(chapter, coarser[:2])
    alike = max(apart(case, clock) for name, case in cases_of(3).items() if name not in UNLIKE for clock in TIMES)
    chapter.claim(
        "scheme 3 is scheme 1 on moving ground: largest difference of h and q, all time steps", alike, high=0.0
    )


def apart(case: Case, clock: str) -> float:
    """Largest difference of schemes 1 and 3 in h and q at the end."""
    one, other = (run.arrays for run in case.runs([Macroscopic(1), Macroscopic(3)], timing(case, clock), (140, 140)))
    return float(max(np.abs(one[name] - other[name]).max() for name in ("h", "history_q")))


def orders(chapter: Chapter, scheme: int, clock: str, counts: list[int]) -> Panel:
    """Halve dx at a fixed Courant number, or at dt = 0.001."""
    widths, found, rows = [14 / count for count in counts], {}, []
    for name, case in cases_of(scheme).items():
        if scheme > 1 and name == "pile":
            continue
        errors = case.errors(Macroscopic(scheme), timing(case, clock), counts)
        rows.append([name, *errors, *falls(widths, errors)])
        found[name] = errors
        bounds = expected(scheme, name, clock)
        if bounds is not None:
            judged = slice(0, 3) if clock == FIXED else slice(-3, None)
            what = f"order in dx, scheme {scheme}, {name}, {clock}"
            chapter.claim(what, order(widths[judged], errors[judged]), low=bounds[0], high=bounds[1])
    heads = ["exact solution", *(f"dx = {width:.4g}" for width in widths), *["order"] * (len(counts) - 1)]
    chapter.table(f"L1(h), scheme {scheme}, {clock}", heads, rows)
    return Panel(f"scheme {scheme}, {clock}", widths, found)


def timing(case: Case, clock: str) -> Courant | Fixed:
    """A Courant number, or the paper's dt on all cells."""
    number = TIMES[clock]
    return Courant(number, case.end) if number is not None else Fixed(1e-3, round(case.end / 1e-3))


def expected(scheme: int, name: str, clock: str) -> tuple[float, float] | None:
    """Bounds of the order; None where theory lets expect none."""
    case = CASES[name]
    low, high = case.orders
    if scheme > 1 and not case.settled(scheme, TIMES[clock]):
        return None
    if scheme == 2 and clock == "Courant 0.9" and name in ("shock", "fan and shock"):
        return None
    if clock == FIXED and "wedge" in name:
        if scheme == 2:
            return -0.05, 0.05  # which cells are judged depends a little on dx
        return (low - 0.1, high) if name == "wedge" else None
    if scheme == 1 and case.rests:  # friction changes its sign from step to step: of first order, but no line
        return 0.7, 1.3
    return (low - 0.1, high) if clock == FIXED else (low, high)


def rounding(chapter: Chapter, counts: list[int]) -> None:
    """Slides under all schemes, a pile under schemes 2 and 3: largest error of h and q at the end, over eps and steps.

    A step rounds h and q, which are at most 2, a few times; eight eps per step are allowed.
    """
    rows = []
    for name, case in (SLIDES | {"pile": CASES["pile"]}).items():
        for scheme in (1, 2, 3):
            if case.rests and scheme == 1:
                continue  # it does not rest: see the chapter on dt for the slide, the orders above for the pile
            for clock, number in TIMES.items():
                if name == "pile" and not case.settled(scheme, number):
                    continue
                worst = max(map(case.miss, case.runs(Macroscopic(scheme), timing(case, clock), counts)))
                rows.append([name, scheme, clock, worst])
    heads = ("exact solution", "scheme", "time step", "error")
    chapter.table("Largest error of h and q at the end, all dx, over eps and number of steps", heads, rows)
    for name in dict.fromkeys(row[0] for row in rows):
        worst = max(row[-1] for row in rows if row[0] == name)
        chapter.claim(f"{name}: largest error of h and q at the end, over eps and steps", worst, high=8.0)


if __name__ == "__main__":
    run(main, __doc__)
