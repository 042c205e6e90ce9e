"""The ground under the mass."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from ..value import Number, kind, value


@value
class ConstantSlope:
    """A plane inclined by `zeta` radians against the horizontal, downhill to +x for zeta > 0."""

    zeta: Annotated[Number, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0
    kind: Literal["constant"] = kind("constant")

    @property
    def sin(self) -> float:
        """sin zeta, the pull of gravity along the chute (dimensionless)."""
        return math.sin(self.zeta)

    @property
    def cos(self) -> float:
        """cos zeta, the pull of gravity onto the chute (dimensionless)."""
        return math.cos(self.zeta)


Chute = ConstantSlope
