"""The macroscopic wing: fluxes from closed-form half-range moments, and no density at all."""

from __future__ import annotations

from ..balance.interface import Faces
from ..balance.stages import Array, Stages
from ..balance.wing import WithoutDensity
from .half_moments import flux_closed, flux_of_cells, half_moments_of_cells


class ClosedForm(WithoutDensity):
    """What a step asks of a wing, answered in closed form."""

    def half_moments(self, now: Stages) -> Array:
        """I1, I3 and I2, I4 of each ghosted cell, shape (4, nx + 2)."""
        half_moments_of_cells(now.h, now.u, self._beta.plus, self._half)
        return self._half

    def _flux_of_cells(self, h: Array, u: Array, F1: Array, F2: Array) -> None:
        flux_of_cells(h, u, self._beta.plus, self._room, F1, F2)

    def _flux(self, at: Faces, F1: Array, F2: Array) -> None:
        flux_closed(at.h_left, at.u_left, at.h_right, at.u_right, self._beta.faces, self._room, F1, F2)
