"""The two methods: how a scene is computed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from .balance.schemes import Coupling
from .kinetic.equilibrium import EQUILIBRIA, EquilibriumName
from .kinetic.force import ForceName
from .kinetic.project import ProjectionName
from .kinetic.velocity import Fitted, Uniform, Velocity
from .value import kind, value

SchemeNumber = Literal[1, 2, 3]


@value
class Macroscopic:
    """Schemes 1, 2 and 3 of the paper with closed-form fluxes.

    Attributes:
        scheme: 1 upwind and sliding, 2 balanced and stopping, 3 coupled.
        coupling: Of scheme 3: "cell", the paper's, each cell has its fluxes; "face", one flux per face, conservative.
    """

    scheme: SchemeNumber = 3
    coupling: Coupling = "cell"
    kind: Literal["macroscopic"] = kind("macroscopic")


@value
class Kinetic:
    """The same schemes carried by a density f(x, xi) on a velocity grid, (18) to (25).

    Attributes:
        scheme: 1 upwind and sliding, 2 balanced and stopping, 3 coupled.
        velocity: Where the density lives: `Uniform`, `Window` or `Fitted`.
        equilibrium: How M stands on the grid: "cell-average", "sampled", "matched" or "entropic".
        force: How the impulse moves f: "shift-linear", "shift-exact", "shift-pfc" of (23), "derivative-upwind" or
            "derivative-centred" of (18).
        projection: How U comes out of f: "flux-difference" or "re-summed".
        coupling: Of scheme 3: "cell", the paper's, each cell has its fluxes; "face", one flux per face, conservative.
    """

    scheme: SchemeNumber = 3
    velocity: Velocity = Uniform()
    equilibrium: EquilibriumName = "cell-average"
    force: ForceName = "shift-linear"
    projection: ProjectionName = "flux-difference"
    coupling: Coupling = "cell"
    kind: Literal["kinetic"] = kind("kinetic")

    def __post_init__(self) -> None:
        plain = ("cell-average", "shift-linear", "flux-difference")
        if isinstance(self.velocity, Fitted):
            if (self.equilibrium, self.force, self.projection) != plain:
                raise ValueError(
                    "fitted nodes carry M itself; leave equilibrium, force and projection at their defaults"
                )
        elif isinstance(self.velocity, Uniform):
            least = EQUILIBRIA[self.equilibrium].least
            if self.velocity.count < least:
                raise ValueError(
                    f"equilibrium {self.equilibrium!r} needs at least {least} velocity cells, got {self.velocity.count}"
                )
            if self.velocity.beyond == "warn" and self.equilibrium in ("matched", "entropic"):
                raise ValueError(
                    f"equilibrium {self.equilibrium!r} puts all of M into the window, so that nothing beyond it can be "
                    "left out; take beyond='stop', or cell averages"
                )

    @property
    def twin(self) -> Macroscopic:
        """The same scheme in closed form."""
        return Macroscopic(scheme=self.scheme, coupling=self.coupling)

    def within(self, bound: float) -> Kinetic:
        """The same method with the velocity window [-bound, bound], if it has none yet."""
        if not isinstance(self.velocity, Uniform) or self.velocity.bound is not None:
            return self
        return replace(self, velocity=replace(self.velocity, bound=bound))

    @property
    def unbounded(self) -> bool:
        """Whether the velocity grid still needs a bound."""
        return self.within(1.0) is not self


Method = Annotated[Kinetic | Macroscopic, Field(discriminator="kind")]
