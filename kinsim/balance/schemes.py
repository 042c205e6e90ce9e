"""Schemes 1, 2 and 3 of section 3: which flux a cell takes at its walls, and which impulse it is given."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np

from ..kernel import kernel
from ..model.boundary import extend_flag
from ..model.ground import Flat
from ..scene import Scene
from .impulse import find_slow, keep_dry, sliding, stopping
from .interface import Array, balanced
from .stages import Flags, Stages
from .update import Walls
from .wing import Wing

Coupling = Literal["cell", "face"]


class Scheme(Protocol):
    """A scheme reads and writes the stages, in this order."""

    uses_balanced: bool
    """Whether the balanced face states (25) and their flux are needed."""
    has_faces: bool
    """Whether densities stand at faces that are not those of the cells."""
    sloped: bool
    """Whether cells show other states at their walls than their own: second order."""

    def prepare(self, now: Stages, fastest: float) -> None:
        """Write what cells show to their walls; slopes that make particles faster than `fastest` are left out."""

    def fluxes(self, now: Stages, wing: Wing, dt: float) -> Walls:
        """The fluxes that each cell takes at its walls."""

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        """Write `J`; `pulled`, shape (nx,), is the height that the force acts on; returns what this mends, per dx."""


class Scheme1:
    """Upwind faces (19) and sliding friction; never rests."""

    uses_balanced = has_faces = sloped = False

    def __init__(self, scene: Scene) -> None:
        self._boundary = scene.boundary
        self._ground = flat(scene).numbers

    def prepare(self, now: Stages, fastest: float) -> None:
        pass

    def fluxes(self, now: Stages, wing: Wing, dt: float) -> Walls:
        wing.upwind_flux(now)
        return Walls.of(now.F1, now.F2)

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        keep_dry(now.h, now.h1, now.qhat)
        sliding(now.h, now.u, pulled, *self._ground, dt, now.J)
        return 0.0


class Scheme2(Scheme1):
    """Balanced faces (25) everywhere; slow cells stop and start, (21), (22)."""

    uses_balanced = has_faces = True

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._taken = Walls(*np.zeros((4, scene.cells.count)))

    def fluxes(self, now: Stages, wing: Wing, dt: float) -> Walls:
        s, R, _, dx = self._ground
        to = now.balanced
        balanced(now.h, now.u, to.h_left, to.u_left, to.h_right, to.u_right)
        wing.upwind_flux(now)
        wing.balanced_flux(now)
        candidate(now.h, now.B1, dt / dx, now.h1_candidate)
        find_slow(now.q, now.h1_candidate, s, R, dt, now.slow[1:-1])
        extend_flag(self._boundary, now.slow)
        self.choose(now)
        choose_flux(now.at_left, now.at_right, now.F1, now.F2, now.B1, now.B2, *self._taken)
        return self._taken

    def choose(self, now: Stages) -> None:
        """Write `at_left` and `at_right`: where cells take the balanced flux."""
        now.at_left[:] = now.at_right[:] = True

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        stopping(now.h, now.q, pulled, now.h1_candidate, now.slow[1:-1], *self._ground, dt, now.J)
        return 0.0


class Scheme3Cell(Scheme2):
    """Scheme 3 by cell, the paper's: slow cells take balanced fluxes, the others upwind ones; not conservative."""

    def choose(self, now: Stages) -> None:
        now.at_left[:] = now.at_right[:] = now.slow[1:-1]


class Scheme3Face(Scheme2):
    """Scheme 3 by face: one flux per face, balanced where both its cells are slow; conservative."""

    def choose(self, now: Stages) -> None:
        np.logical_and(now.slow[:-2], now.slow[1:-1], out=now.at_left)
        np.logical_and(now.slow[1:-1], now.slow[2:], out=now.at_right)


def flat(scene: Scene) -> Flat:
    """The ground of schemes that are made for a constant slope."""
    assert isinstance(scene.ground, Flat)
    return scene.ground


@kernel
def choose_flux(
    at_left: Flags, at_right: Flags, F1: Array, F2: Array, B1: Array, B2: Array,
    left1: Array, left2: Array, right1: Array, right2: Array,
) -> None:  # fmt: skip
    """The fluxes of each cell at its walls: B where the flags say so, else F, each of shape (nx + 1,)."""
    for i in range(left1.size):
        left1[i], left2[i] = (B1[i], B2[i]) if at_left[i] else (F1[i], F2[i])
        right1[i], right2[i] = (B1[i + 1], B2[i + 1]) if at_right[i] else (F1[i + 1], F2[i + 1])


@kernel
def candidate(h: Array, B1: Array, lam: float, h1: Array) -> None:
    """h^{n+1} as the balanced flux gives it; h is ghosted."""
    for i in range(h1.size):
        h1[i] = h[i + 1] - lam * (B1[i + 1] - B1[i])


__all__ = ["Coupling", "Flags", "Scheme"]
