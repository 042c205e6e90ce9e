"""The two methods: how a scene is computed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from .balance.schemes import Coupling
from .kinetic.equilibrium import EQUILIBRIA, EquilibriumName
from .kinetic.velocity import Uniform
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

    def occupied(self, fastest: float) -> float:
        """The fastest particle itself, max(|u| + c): what (28) bounds."""
        return fastest

    def rest(self, h_max: float) -> float:
        """The largest |q| of a mass at rest: rounding."""
        return 1e-12


@value
class Kinetic:
    """The same schemes carried by a density f(x, xi) on a velocity grid, (18) to (25).

    Attributes:
        scheme: 1 upwind and sliding, 2 balanced and stopping, 3 coupled.
        velocity: The velocity grid.
        equilibrium: How M stands on the grid: "cell-average" or "sampled".
        coupling: Of scheme 3: "cell", the paper's, each cell has its fluxes; "face", one flux per face, conservative.
    """

    scheme: SchemeNumber = 3
    velocity: Uniform = Uniform()
    equilibrium: EquilibriumName = "cell-average"
    coupling: Coupling = "cell"
    kind: Literal["kinetic"] = kind("kinetic")

    @property
    def twin(self) -> Macroscopic:
        """The same scheme in closed form."""
        return Macroscopic(scheme=self.scheme, coupling=self.coupling)

    def within(self, bound: float) -> Kinetic:
        """The same method with the velocity window [-bound, bound]."""
        return replace(self, velocity=replace(self.velocity, bound=bound))

    def occupied(self, fastest: float) -> float:
        """The outermost node that particles up to the speed `fastest` occupy: what (28) bounds on a grid."""
        return EQUILIBRIA[self.equilibrium].outermost(fastest, self.velocity.grid())

    def rest(self, h_max: float) -> float:
        """The largest |q| of a mass at rest: a thousandth of a velocity cell."""
        return 1e-3 * self.velocity.grid().dxi * h_max


Method = Annotated[Kinetic | Macroscopic, Field(discriminator="kind")]
