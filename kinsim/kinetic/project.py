"""The projection (20), read in two ways: where U^{n+1} comes from."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np

from ..balance.stages import Array, Stages
from .wing import Density


class Projection(Protocol):
    """Where the moments come from, after transport and after the force."""

    def after_transport(self, now: Stages, density: Density | None) -> float:
        """Settle `h1` and `qhat`, which hold U^n - lam (F_{i+1/2} - F_{i-1/2}); returns the mass this makes, per dx."""

    def after_force(self, now: Stages, density: Density | None) -> float:
        """Write `q1`, and settle `h1`; returns the mass this makes, per dx."""


class FluxDifference:
    """U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J), (24), with the half-range sums F of the grid."""

    def after_transport(self, now: Stages, density: Density | None) -> float:
        return 0.0

    def after_force(self, now: Stages, density: Density | None) -> float:
        np.add(now.qhat, now.J, out=now.q1)
        return 0.0


class Resummed:
    """Sums of f taken anew, the letter of (20); repeats the sampling defect in every step."""

    def after_transport(self, now: Stages, density: Density | None) -> float:
        return self._sum(density, "transported", now.h1, now.qhat)

    def after_force(self, now: Stages, density: Density | None) -> float:
        made = self._sum(density, "f", now.h1, now.q1)
        if density is not None:
            density.add_moved(now.h1, now.q1)
        return made

    def _sum(self, density: Density | None, stage: str, h: Array, q: Array) -> float:
        if density is None:
            return 0.0
        return density.sums(getattr(density, stage), h, q)


ProjectionName = Literal["flux-difference", "re-summed"]

PROJECTIONS: dict[ProjectionName, Projection] = {"flux-difference": FluxDifference(), "re-summed": Resummed()}
