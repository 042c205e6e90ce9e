"""The macroscopic wing: fluxes from closed-form half-range moments, and no density at all."""

from __future__ import annotations

import numpy as np

from ..balance.interface import Faces
from ..balance.stages import Array, Stages, fastest
from ..scene import Scene
from .half_moments import flux_closed, half_moments_closed


class ClosedForm:
    """What a step asks of a wing, answered in closed form."""

    def __init__(self, scene: Scene) -> None:
        self._beta = scene.beta

    def equilibrium(self, now: Stages) -> float:
        """M of (12) is known without being formed; its fastest particle is |u| + c."""
        return fastest(now.h, now.u, self._beta, False)

    def half_moments(self, now: Stages) -> Array:
        """I1, I3 and I2, I4 of each ghosted cell, shape (4, nx + 2)."""
        pairs = zip(now.h, now.u, strict=True)
        return np.array([half_moments_closed(h, u, self._beta) for h, u in pairs]).T

    def upwind_flux(self, now: Stages) -> None:
        """F of (24)."""
        self._flux(now.upwind, now.F1, now.F2)

    def balanced_flux(self, now: Stages) -> None:
        """F~ of section 3.2."""
        self._flux(now.balanced, now.B1, now.B2)

    def transport(self, now: Stages, lam: float) -> None:
        """There is no density to transport."""

    def pulled(self, now: Stages) -> Array:
        """h^{n+1}, (24)."""
        return now.h1

    def force(self, now: Stages) -> float:
        """There is no density to shift, and none is lost."""
        return 0.0

    def _flux(self, at: Faces, F1: Array, F2: Array) -> None:
        flux_closed(at.h_left, at.u_left, at.h_right, at.u_right, self._beta, F1, F2)
