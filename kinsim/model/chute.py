"""The ground under the mass."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ..value import Number, kind, value
from .slope import Slope


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


@value
class SmoothChute:
    """A chute whose slope zeta(x) varies smoothly, (13), with x along it; at most 80 degrees steep.

    Attributes:
        zeta: The angle against the horizontal in radians.
        eta: The characteristic curvature, length of the mass over the radius of curvature; 0 leaves out the friction of
            centrifugal forces.
        lifting: Where the mass would leave the ground, cos zeta + eta kappa u^2 < 0, friction is off; "warn" reports
            these cells, "stop" ends the run.
    """

    zeta: Slope
    eta: Annotated[Number, Field(ge=0)] = 0.0
    lifting: Literal["warn", "stop"] = "warn"
    kind: Literal["smooth"] = kind("smooth")


def _constant_unless_named(given: Any) -> Any:
    return {"kind": "constant", **given} if isinstance(given, dict) else given


Chute = Annotated[ConstantSlope | SmoothChute, BeforeValidator(_constant_unless_named), Field(discriminator="kind")]
