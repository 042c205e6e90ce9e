"""Laws of friction: how hard the ground can hold a mass back."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Protocol

from pydantic import Field

from ..local import Local
from ..value import Number, kind, value


class Pressed(Protocol):
    """Ground onto which gravity pulls."""

    @property
    def cos(self) -> Local:
        """cos zeta, or the normal force where the chute bends (dimensionless)."""


class FrictionLaw(Protocol):
    """A law of friction."""

    def resistance(self, chute: Pressed) -> Local:
        """R of Definition 1 (dimensionless), in proportion to the normal force."""


@value
class Frictionless:
    """Ground that holds nothing back: R = 0."""

    kind: Literal["frictionless"] = kind("frictionless")

    def resistance(self, chute: Pressed) -> Local:
        """R of Definition 1 (dimensionless)."""
        return 0.0 * chute.cos


@value
class Coulomb:
    """Coulomb friction with angle `delta` in radians, static as well as dynamic: R = cos zeta tan delta."""

    delta: Annotated[Number, Field(ge=0, lt=math.pi / 2)]
    kind: Literal["coulomb"] = kind("coulomb")

    def resistance(self, chute: Pressed) -> Local:
        """R of Definition 1 (dimensionless)."""
        return chute.cos * math.tan(self.delta)


Friction = Annotated[Frictionless | Coulomb, Field(discriminator="kind")]
