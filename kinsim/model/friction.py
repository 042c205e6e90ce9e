"""Laws of friction: which deceleration the ground brings to bear on a moving layer, and the most it holds at rest.

A law is its numbers and one formula, resistance(law, h, v, n): r for the height h, the speed v >= 0 and the normal
acceleration n = cos zeta + eta kappa u^2; r at v = 0 is the most that it holds. A law of one's own is a NamedTuple or a
dataclass with that formula, which may use `math`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, ValidatorFunctionWrapHandler, WrapSerializer, WrapValidator

from ..value import Number, described_outside, kind, value


class DryFriction(NamedTuple):
    """r = mu n."""

    mu: float

    def resistance(law, h, v, n):
        return law.mu * n

    def holds(law, h, w, n):
        return law.mu * n

    def brought(law, h, w, dt, n):
        return law.mu * n

    def brought_midway(law, h, u, h1, w, dt, acts, n):
        return law.mu * n


@value
class Frictionless:
    """Ground that holds nothing back: R = 0."""

    kind: Literal["frictionless"] = kind("frictionless")

    @property
    def law(self) -> DryFriction:
        """What kernels take."""
        return DryFriction(0.0)


@value
class Coulomb:
    """Coulomb friction with angle `delta` in radians, static as well as dynamic: R = cos zeta tan delta."""

    delta: Annotated[Number, Field(ge=0, lt=math.pi / 2)]
    kind: Literal["coulomb"] = kind("coulomb")

    @property
    def law(self) -> DryFriction:
        """What kernels take."""
        return DryFriction(math.tan(self.delta))


def formula_of(friction: Any) -> Callable[[float, float, float], float]:
    """r(h, v, n) of a law."""
    law = friction if hasattr(friction, "resistance") else friction.law
    return law.resistance  # type: ignore[no-any-return]


def held_by(friction: Any, n: float) -> float:
    """R of Definition 1: the most that a law holds of a layer of height 1 at rest under the normal acceleration n."""
    return float(formula_of(friction)(1.0, 0.0, n))


def _from_outside(given: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """A law of the package is checked, one from outside taken as it is if it has a formula."""
    outside = not isinstance(given, dict) and type(given) not in (Frictionless, Coulomb)
    return given if outside and (hasattr(given, "resistance") or hasattr(given, "law")) else check(given)


Friction = Annotated[
    Annotated[Frictionless | Coulomb, Field(discriminator="kind")],
    WrapValidator(_from_outside),
    WrapSerializer(described_outside),
]
