"""Runs that start from an exact solution and are judged by it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinsim import Cells, ConstantSlope, Coulomb, Courant, Fixed, Profile, Scene
from kinsim.clock import AnyClock
from kinsim.exact import (
    AcceleratedRiemann,
    ParabolicCap,
    Riemann,
    SlidingWedge,
    StaticPile,
    TravellingShock,
    UniformSlide,
)
from kinsim.mean import mean_velocity
from kinsim.studies.record import Record

from .family import Method, family

BETA = 0.4
EPS = float(np.finfo(float).eps)
DOWN, UP = {"pull": 0.4, "resistance": 0.3}, {"pull": 0.3, "resistance": 0.4}
STEEP, HELD = {"pull": 0.6, "resistance": 0.1}, {"pull": 0.1, "resistance": 0.4}
MIDDLE, EVERYWHERE = (-1.0, 3.5), (-3.0, 7.0)

SMOOTH = (0.95, 1.05)
"""Order in dx of a first-order upwind scheme on a straight line, at a fixed dt/dx."""

ROUGH = (0.4, 1.1)
"""The same at jumps, corners and dry fronts: dx^(1/2) at worst, dx at best, and a tenth for finite widths."""


@dataclass(frozen=True)
class Case:
    """An exact solution on cells of [-5, 9], and how a run is judged by it.

    Attributes:
        exact: The solution.
        end: When the run ends.
        inner: Between these places it is judged; no open end has reached them.
        orders: Lowest and highest order in dx that theory lets expect.
        wet: Whether there is no dry ground, which schemes 2 and 3 do not know.
        rests: Whether it rests at the end, which scheme 1 does not know.
    """

    exact: Any
    end: float
    inner: tuple[float, float] = EVERYWHERE
    orders: tuple[float, float] = ROUGH
    wet: bool = True
    rests: bool = False

    def settled(self, scheme: int, number: float | None) -> bool:
        """Whether it does not rest, or rests under a scheme that knows rest, at a Courant number that keeps it."""
        return not self.rests or (scheme > 1 and (number is None or number < UNSTABLE))

    def scene(self, count: int) -> Scene:
        """The start, on `count` cells."""
        return scene_of(self.exact, self.cells(count), BETA)

    def cells(self, count: int) -> Cells:
        """`count` of them."""
        return Cells(-5, 9, count)

    def runs(
        self, methods: Method | Sequence[Method], clocks: AnyClock | Sequence[AnyClock], counts: Sequence[int]
    ) -> list[Record]:
        """Runs from the exact start, one for each number of cells, with its own method and clock or one for all."""
        return family([self.scene(count) for count in counts], methods, clocks)

    def errors(
        self, methods: Method | Sequence[Method], clocks: AnyClock | Sequence[AnyClock], counts: Sequence[int]
    ) -> list[float]:
        """L1(h) between the end of each such run and the solution."""
        return [self.error(run) for run in self.runs(methods, clocks, counts)]

    def error(self, run: Record) -> float:
        """L1(h) between the end of a run and the solution, where no open end has reached."""
        x, cells = run.arrays["x"], self.cells(run.arrays["x"].size)
        keep = (x > self.inner[0]) & (x < self.inner[1])
        h, _ = self.exact.averages(cells, run.figures["t"])
        return float(np.abs(run.arrays["h"] - h)[keep].sum() * cells.dx)

    def miss(self, run: Record) -> float:
        """Largest error of h and q at the end, over eps and the number of steps."""
        h, q = self.exact.averages(self.cells(run.arrays["x"].size), run.figures["t"])
        off = max(np.abs(run.arrays["h"] - h).max(), np.abs(run.arrays["history_q"][-1] - q).max())
        return float(off / (EPS * run.figures["steps"]))

    def clock(self, number: float | None, count: int) -> Courant | Fixed:
        """A Courant number; or, for None, the paper's dt = 0.02 dx."""
        if number is not None:
            return Courant(number, self.end)
        steps = round(self.end / (0.02 * 14 / count))
        return Fixed(self.end / steps, steps)


CASES = {
    "wedge": Case(SlidingWedge(2.0, 0.1, 0.5, BETA, **DOWN), 1.0, MIDDLE, SMOOTH),
    "steep wedge": Case(SlidingWedge(1.0, 0.1, 1.0, BETA, **STEEP), 1.0, MIDDLE, SMOOTH),
    "wedge that stops": Case(SlidingWedge(2.0, 0.1, 0.3, BETA, **HELD), 1.5, MIDDLE, SMOOTH, rests=True),
    "wedge with a dry toe": Case(SlidingWedge(0.8, -0.2, 0.5, BETA, **DOWN), 1.0, (-2.0, 8.0), SMOOTH, wet=False),
    "pile": Case(StaticPile(0.6, -0.6, BETA, **HELD, h0=2.0, x0=2.0, floor=0.5), 1.5, rests=True),
    "cap": Case(ParabolicCap(1, 1, BETA, **DOWN, u0=1.5), 1.5, wet=False),
    "fan and shock": Case(AcceleratedRiemann(Riemann(1, 1.2, 0.4, 1.0, BETA), **DOWN), 2.0),
    "shock": Case(TravellingShock(1, 1.2, 0.5, BETA, **UP), 2.0),
    "dam on a wet bed": Case(AcceleratedRiemann(Riemann(1, 0, 0.4, 0, BETA), **DOWN), 2.0),
    "dam on dry ground": Case(AcceleratedRiemann(Riemann(1, 0, 0, 0, BETA), **DOWN), 2.0, wet=False),
    "dam without friction": Case(Riemann(1, 0, 0.5, 0, BETA), 2.0),
}
"""Every exact solution that has an error to converge; on the uniform slides below no scheme makes one."""

SLIDES = {
    "slide": Case(UniformSlide(1.0, **DOWN), 1.5),
    "slide that stops": Case(UniformSlide(0.3, **HELD), 1.5, rests=True),
}

CLOCKS = {"Courant 0.3": 0.3, "Courant 0.6": 0.6, "Courant 0.9": 0.9, "paper's dt": None}
"""Courant numbers, and None for the paper's dt, 0.02 dx."""

UNLIKE = ("wedge that stops", "pile", "dam on a wet bed")
"""Where some cell is slow in some step; elsewhere scheme 3 is scheme 1, bit by bit."""

UNSTABLE = 3.0 * math.pi / 16.0
"""The Courant number of rest, dt/dx sqrt(2 beta h), beyond which slow cells amplify the odd-even mode."""


def cases_of(scheme: int) -> dict[str, Case]:
    """Those that a scheme can be asked about."""
    return {name: case for name, case in CASES.items() if case.wet or scheme == 1}


def scene_of(exact: Any, cells: Cells, beta: float) -> Scene:
    """The exact solution at t = 0 as cell averages, on its own ground."""
    h, q = exact.averages(cells, 0.0)
    zeta = math.asin(getattr(exact, "pull", 0.0))
    friction = Coulomb(math.atan(getattr(exact, "resistance", 0.0) / math.cos(zeta)))
    heap = Profile(h, mean_velocity(q, h))
    return Scene(cells=cells, heap=heap, chute=ConstantSlope(zeta), friction=friction, epsilon=beta / math.cos(zeta))
