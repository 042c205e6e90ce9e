"""What a step asks of a wing: how half-range moments come about."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np

from ..scene import Scene
from .interface import Faces
from .stages import Array, Stages, reach, support


class Wing(Protocol):
    """One way of getting half-range moments, and the density that carries them, if there is one."""

    def equilibrium(self, now: Stages) -> float:
        """M(h, xi - u), (12); returns the fastest velocity it occupies, which (28) bounds."""

    def support(self, now: Stages) -> None:
        """Write `low` and `high`, the slowest and the fastest particle of each cell."""

    def half_moments(self, now: Stages) -> Array:
        """First and second moment of M over xi > 0, then over xi < 0, of each ghosted cell, shape (4, nx + 2)."""

    def upwind_flux(self, now: Stages) -> None:
        """Write F1, F2 from the upwind face states."""

    def balanced_flux(self, now: Stages) -> None:
        """Write B1, B2 from the balanced face states."""

    def held_flux(self, now: Stages) -> None:
        """Write F1, F2 from the held face states, which differ from the upwind ones where `held` says so."""

    def transport(self, now: Stages, lam: float) -> None:
        """f after transport."""

    def pulled(self, now: Stages) -> Array:
        """The height that the force acts on, shape (nx,): h^{n+1} in (23), h^n in (18)."""

    def force(self, now: Stages) -> float:
        """f after the force; returns the mass that left the velocity window, per dx."""


class WithoutDensity(ABC):
    """A wing whose half-range moments are functions of (h, u): there is nothing to carry, and nothing to lose."""

    def __init__(self, scene: Scene, sloped: bool) -> None:
        self._beta = scene.ground.shown(sloped)
        self._room = np.empty((5, scene.cells.count + 2))
        self._half = np.empty((4, scene.cells.count + 2))

    def equilibrium(self, now: Stages) -> float:
        """M is known without being formed; its fastest particle is |u| + c."""
        return reach(now, self._beta, False)

    def support(self, now: Stages) -> None:
        """u -+ c of what the cells show."""
        support(*now.plus, self._beta.plus, now.low, now.high)
        if now.plus is not now.minus:
            low, high = self._half[:2]
            support(*now.minus, self._beta.minus, low, high)
            np.minimum(now.low, low, out=now.low)
            np.maximum(now.high, high, out=now.high)

    def upwind_flux(self, now: Stages) -> None:
        """F of (24): each cell is asked once."""
        self._flux_of_cells(now.h, now.u, now.F1, now.F2)

    def balanced_flux(self, now: Stages) -> None:
        """F~ of section 3.2."""
        self._flux(now.balanced, now.B1, now.B2)

    def held_flux(self, now: Stages) -> None:
        """The one flux of scheme 4."""
        self._flux(now.balanced, now.F1, now.F2)

    def transport(self, now: Stages, lam: float) -> None:  # noqa: B027, nothing to do is the answer
        """There is no density to transport."""

    def pulled(self, now: Stages) -> Array:
        """h^{n+1}, (24)."""
        return now.h1

    def force(self, now: Stages) -> float:
        """There is no density to shift, and none is lost."""
        return 0.0

    @abstractmethod
    def _flux_of_cells(self, h: Array, u: Array, F1: Array, F2: Array) -> None:
        """The flux at the faces between ghosted cells."""

    @abstractmethod
    def _flux(self, at: Faces, F1: Array, F2: Array) -> None:
        """The flux of faces with states of their own."""
