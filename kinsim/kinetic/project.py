"""The projection (20), read in two ways: where U^{n+1} comes from."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np

from ..balance.stages import Stages
from .wing import Density


class Projection(Protocol):
    """Where the moments come from, after transport and after the force."""

    def after_transport(self, now: Stages, density: Density | None) -> None:
        """Settle `h1` and `qhat`, which hold U^n - lam (F_{i+1/2} - F_{i-1/2})."""

    def after_force(self, now: Stages, density: Density | None) -> None:
        """Write `q1`, and settle `h1`."""


class FluxDifference:
    """U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J), (24), with the half-range sums F of the grid."""

    def after_transport(self, now: Stages, density: Density | None) -> None:
        pass

    def after_force(self, now: Stages, density: Density | None) -> None:
        np.add(now.qhat, now.J, out=now.q1)


class Resummed:
    """Sums of f taken anew, the letter of (20); repeats the sampling defect in every step."""

    def after_transport(self, now: Stages, density: Density | None) -> None:
        if density is not None:
            density.sums(density.transported, now.h1, now.qhat)

    def after_force(self, now: Stages, density: Density | None) -> None:
        if density is not None:
            density.sums(density.f, now.h1, now.q1)
            np.add(now.q1, density.offset * now.h1, out=now.q1)


ProjectionName = Literal["flux-difference", "re-summed"]

PROJECTIONS: dict[ProjectionName, Projection] = {"flux-difference": FluxDifference(), "re-summed": Resummed()}
