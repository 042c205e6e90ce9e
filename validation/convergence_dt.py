"""Convergence in dt alone: dx stays, dt falls from the CFL bound to the paper's 0.02 dx, exact solutions judge.

What the time step does wrong is known where the rest is nearly exact. A wedge slides with a velocity that gains g per
time; explicit steps move it with the velocity at their beginning, so that it lags behind by dt (u(T) - u(0))/2, and
L1(h) is that times its slope and the length that is judged. This is measured, directly against the exact solution, as
first order in dt, for all three schemes; scheme 2, whose F~ makes no error of dx on straight lines, shows it on all
wedges.

Elsewhere the error of dx is larger, and of the other sign: upwind schemes smear less with larger steps. As dt falls,
the error E(dt) against the exact solution at a fixed dx tends to what dx alone does wrong, and its differences under
halving, E(dt) - E(dt/2), fall like dt. Left out is what a fixed dx does not let converge: scheme 1 at rest, scheme 2
with its undamped zigzags, and a front on dry ground, where an L1 error sums both signs.

A slide that stops comes to rest exactly, in whatever steps, under schemes 2 and 3. Scheme 1 goes on beyond: u changes
its sign for ever, within dt (R + |sin zeta|), the velocity that one step of friction can give.
"""

from __future__ import annotations

import numpy as np
from claims import Chapter, run
from laboratory.judged import CASES, SLIDES, cases_of
from laboratory.orders import Panel, falls, halvings, order, picture
from numpy.typing import NDArray

from kinsim import Fixed, Macroscopic

Array = NDArray[np.float64]
Errors = dict[str, list[float]]
LARGEST = 0.32
"""The largest dt/dx; a Courant number of 0.6 to 0.9. Four halvings lead to the paper's."""


def main(chapter: Chapter) -> None:
    """Where dt leads, where dx leads, and where friction stops."""
    levels = halvings(1, 7 if chapter.full else 5)
    count = 140
    ratios = [LARGEST / level for level in levels]
    direct, rest = [], []
    for scheme in (1, 2, 3):
        errors = {name: at_fixed_dx(scheme, name, levels, count) for name in cases_of(scheme)}
        leads = {name: errors[name] for name in (WEDGES if scheme == 2 else ("steep wedge",))}
        others = {name: each for name, each in errors.items() if name not in leads}
        differs = {name: -np.diff(each) for name, each in others.items() if (scheme, name) not in APART}
        where_dt_leads(chapter, scheme, leads, ratios, 14 / count)
        where_dx_leads(chapter, scheme, others, differs, ratios)
        direct.append(Panel(f"scheme {scheme}", ratios, leads))
        if differs:
            rest.append(Panel(f"scheme {scheme}", ratios[:-1], {name: each.tolist() for name, each in differs.items()}))
    chapter.figure(picture([direct], "dt/dx", "E(dt), L1(h)", (1.0,)), "leads",
                   "Errors against exact solutions at dx = 0.1, where dt leads.")  # fmt: skip
    chapter.figure(picture([rest], "dt/dx", "E(dt) - E(dt/2), L1(h)", (1.0,)), "differences",
                   "What halving dt changes in the error against exact solutions at dx = 0.1.")  # fmt: skip
    stopping(chapter)


WEDGES = ("wedge", "steep wedge", "wedge that stops")
APART = {
    *((1, name) for name in ("wedge that stops", "wedge with a dry toe", "pile", "dam on dry ground")),
    *((2, name) for name in ("pile", "fan and shock", "shock", "dam on a wet bed", "dam without friction")),
    *((3, name) for name in ("wedge that stops", "pile")),
}
"""Scheme and solution whose differences are not of one order, see the story; schemes 2 and 3 keep the pile."""


def at_fixed_dx(scheme: int, name: str, levels: list[int], count: int) -> list[float]:
    """L1(h) at the end, dt/dx = LARGEST/level."""
    case = CASES[name]
    steps = round(case.end / (LARGEST * 14 / count))
    clocks = [Fixed(case.end / (steps * level), steps * level) for level in levels]
    return case.errors(Macroscopic(scheme), clocks, [count] * len(levels))


def where_dt_leads(chapter: Chapter, scheme: int, leads: Errors, ratios: list[float], dx: float) -> None:
    """Order of E itself, and E against the lag of explicit steps."""
    rows = []
    for name, errors in leads.items():
        case = CASES[name]
        motion = case.exact.motion
        gain = abs(motion(case.end)[0] - motion(0.0)[0])
        lag = [0.5 * ratio * dx * gain * case.exact.b * (case.inner[1] - case.inner[0]) for ratio in ratios]
        rows.append([name, *errors, *falls(ratios, errors), lag[-1]])
        chapter.claim(f"scheme {scheme}, {name}: order in dt of L1(h)", order(ratios, errors), low=0.95, high=1.05)
        off = max(abs(error / foreseen - 1) for error, foreseen in zip(errors, lag, strict=True))
        chapter.claim(f"scheme {scheme}, {name}: L1(h) over that of the lag dt (u(T) - u(0))/2, less 1", off, high=0.02)
    heads = ["exact solution", *(f"dt/dx = {x:g}" for x in ratios), *["order"] * (len(ratios) - 1), "lag of the last"]
    chapter.table(f"L1(h) at dx = {dx:g}, scheme {scheme}, where dt leads", heads, rows)


def where_dx_leads(
    chapter: Chapter, scheme: int, errors: Errors, differs: dict[str, Array], ratios: list[float]
) -> None:
    """Order of the differences of E."""
    rows = []
    for name, each in errors.items():
        if name not in differs:
            rows.append([name, *each, *["-"] * (len(ratios) - 2)])
            continue
        rows.append([name, *each, *falls(ratios[:-1], differs[name].tolist())])
        found = order(ratios[-3:-1], differs[name][-2:])
        chapter.claim(f"scheme {scheme}, {name}: order in dt of E(dt) - E(dt/2)", found, low=0.9, high=1.1)
    heads = ["exact solution", *(f"dt/dx = {x:g}" for x in ratios), *["order"] * (len(ratios) - 2)]
    chapter.table(f"L1(h) = E at dx = 0.1, scheme {scheme}, and orders of E(dt) - E(dt/2)", heads, rows)


def stopping(chapter: Chapter) -> None:
    """A slide at rest since t = 1: u at t = 1.5, and over what one step of friction can give."""
    case, rows = SLIDES["slide that stops"], []
    kick = case.exact.resistance + abs(case.exact.pull)
    for scheme in (1, 2, 3):
        clocks = [Fixed(case.end / steps, steps) for steps in halvings(47, 5)]
        for clock, one in zip(clocks, case.runs(Macroscopic(scheme), clocks, [20] * 5), strict=True):
            u = float(np.abs(one.arrays["u"]).max())
            rows.append([scheme, clock.dt, u, u / (clock.dt * kick)])
    chapter.table(
        "Slide that stops: |u| half a time after its arrest", ("scheme", "dt", "|u|", "over dt (R + s)"), rows
    )
    chapter.claim("slide that stops, schemes 2 and 3: largest |u| after the arrest, all dt", max(
        row[2] for row in rows if row[0] > 1), high=0.0)  # fmt: skip
    chatter = [row[3] for row in rows if row[0] == 1]
    chapter.claim(
        "slide that stops, scheme 1: |u| after the arrest over dt (R + |sin zeta|), largest of all dt",
        max(chatter),
        low=0.1,
        high=1.0,
    )


if __name__ == "__main__":
    run(main, __doc__)
