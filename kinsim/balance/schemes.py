"""Schemes 1, 2 and 3 of section 3: which flux a cell takes at its walls, and which impulse it is given."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np

from ..kernel import kernel
from ..model.boundary import extend_flag
from ..scene import Scene
from .impulse import find_slow, sliding, stopping
from .interface import Array, balanced
from .stages import Flags, Stages

Coupling = Literal["cell", "face"]


class Scheme(Protocol):
    """A scheme reads fluxes from the stages and writes flags and impulse into them."""

    uses_balanced: bool
    """Whether the balanced face states (25) and their flux are needed."""

    def choose(self, scene: Scene, now: Stages, dt: float) -> None:
        """Write `at_left` and `at_right`: where cells take the balanced flux."""

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        """Write `J`; `pulled`, shape (nx,), is the height that the force acts on."""


class Scheme1:
    """Upwind faces (19) and sliding friction; never rests."""

    uses_balanced = False

    def choose(self, scene: Scene, now: Stages, dt: float) -> None:
        now.at_left[:] = now.at_right[:] = False

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        sliding(now.h, now.u, pulled, scene.chute.sin, scene.resistance, scene.beta, scene.cells.dx, dt, now.J)


class Scheme2:
    """Balanced faces (25) everywhere; slow cells stop and start, (21), (22)."""

    uses_balanced = True

    def choose(self, scene: Scene, now: Stages, dt: float) -> None:
        _judge(scene, now, dt)
        now.at_left[:] = now.at_right[:] = True

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        s, R = scene.chute.sin, scene.resistance
        inner = now.slow[1:-1]
        stopping(now.h, now.q, pulled, now.h1_candidate, inner, s, R, scene.beta, scene.cells.dx, dt, now.J)


class Scheme3Cell(Scheme2):
    """Scheme 3 by cell, the paper's: slow cells take balanced fluxes, the others upwind ones; not conservative."""

    def choose(self, scene: Scene, now: Stages, dt: float) -> None:
        _judge(scene, now, dt)
        now.at_left[:] = now.at_right[:] = now.slow[1:-1]


class Scheme3Face(Scheme2):
    """Scheme 3 by face: one flux per face, balanced where both its cells are slow; conservative."""

    def choose(self, scene: Scene, now: Stages, dt: float) -> None:
        _judge(scene, now, dt)
        np.logical_and(now.slow[:-2], now.slow[1:-1], out=now.at_left)
        np.logical_and(now.slow[1:-1], now.slow[2:], out=now.at_right)


def make_scheme(scheme: int, coupling: Coupling, scene: Scene) -> Scheme:
    """The scheme by its number; without any force no cell is slow, so that scheme 3 is scheme 1."""
    if scheme == 1 or (scheme == 3 and not scene.forced):
        return Scheme1()
    if scheme == 2:
        return Scheme2()
    return Scheme3Cell() if coupling == "cell" else Scheme3Face()


def balanced_faces(now: Stages) -> None:
    """Write the face states (25)."""
    to = now.balanced
    balanced(now.h, now.u, to.h_left, to.u_left, to.h_right, to.u_right)


def _judge(scene: Scene, now: Stages, dt: float) -> None:
    """Write the candidate h^{n+1} of the balanced flux, and who is slow by it."""
    candidate(now.h, now.B1, dt / scene.cells.dx, now.h1_candidate)
    find_slow(now.q, now.h1_candidate, scene.chute.sin, scene.resistance, dt, now.slow[1:-1])
    extend_flag(scene.boundary, now.slow)


@kernel
def candidate(h: Array, B1: Array, lam: float, h1: Array) -> None:
    """h^{n+1} as the balanced flux gives it; h is ghosted."""
    for i in range(h1.size):
        h1[i] = h[i + 1] - lam * (B1[i + 1] - B1[i])


__all__ = ["Coupling", "Flags", "Scheme", "balanced_faces", "make_scheme"]
