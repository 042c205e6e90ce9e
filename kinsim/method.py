"""The two methods: how a scene is computed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from .balance.scheme4 import Limiter
from .balance.schemes import Coupling
from .kinetic.equilibrium import EQUILIBRIA, EquilibriumName
from .kinetic.force import ForceName
from .kinetic.project import ProjectionName
from .kinetic.velocity import Fitted, Uniform, Velocity, Window
from .value import kind, value

NoFlag = BeforeValidator(lambda given: str(given) if isinstance(given, bool) else given)
"""True is 1 to Python, and no scheme."""

SchemeNumber = Annotated[Literal[1, 2, 3, 4], NoFlag]
Order = Annotated[Literal[1, 2], NoFlag]

Statics = Literal["hold", "reflect"]


@value
class Macroscopic:
    """Schemes 1 to 4 with closed-form fluxes.

    Attributes:
        scheme: 1 upwind and sliding, 2 balanced and stopping, 3 coupled: the paper's; 4, ours: conservative, positive,
            at rest and on dry ground.
        coupling: Of scheme 3: "cell", the paper's, each cell has its fluxes; "face", one flux per face, conservative.
        order: Of scheme 4: 1, or 2 in space and time.
        limiter: Of order 2: "minmod", "between", or "mc", the sharpest, which ripples at strong shocks.
        statics: Of order 1 of scheme 4: faces that friction can hold "hold" back density, or "reflect" particles.
    """

    scheme: SchemeNumber = 4
    coupling: Coupling = "cell"
    order: Order = 1
    limiter: Limiter = "between"
    statics: Statics = "hold"
    kind: Literal["macroscopic"] = kind("macroscopic")

    def __post_init__(self) -> None:
        _check_scheme(self)


@value
class Kinetic:
    """The same schemes carried by a density f(x, xi) on a velocity grid, (18) to (25).

    Attributes:
        scheme: 1 upwind and sliding, 2 balanced and stopping, 3 coupled: the paper's; 4, ours: conservative, positive,
            at rest and on dry ground.
        velocity: Where the density lives: `Uniform`, `Window` or `Fitted`.
        equilibrium: How M stands on the grid: "cell-average", "sampled", "matched" or "entropic".
        force: How the impulse moves f: "shift-linear", "shift-exact", "shift-pfc" of (23), "derivative-upwind" or
            "derivative-centred" of (18).
        projection: How U comes out of f: "flux-difference" or "re-summed".
        coupling: Of scheme 3: "cell", the paper's, each cell has its fluxes; "face", one flux per face, conservative.
        order: Of scheme 4: 1, or 2 in space and time.
        limiter: Of order 2: "minmod", "between", or "mc", the sharpest, which ripples at strong shocks.
        statics: Of order 1 of scheme 4: faces that friction can hold "hold" back density, or "reflect" particles.
    """

    scheme: SchemeNumber = 4
    velocity: Velocity = Uniform()
    equilibrium: EquilibriumName = "cell-average"
    force: ForceName = "shift-linear"
    projection: ProjectionName = "flux-difference"
    coupling: Coupling = "cell"
    order: Order = 1
    limiter: Limiter = "between"
    statics: Statics = "hold"
    kind: Literal["kinetic"] = kind("kinetic")

    def __post_init__(self) -> None:
        _check_scheme(self)
        if self.order == 2 and isinstance(self.velocity, Window):
            raise ValueError("order 2 takes its two stages on one grid; take uniform or fitted nodes, not a window")
        if self.order == 2 and (self.projection != "flux-difference" or self.force == "shift-exact"):
            raise ValueError(
                "order 2 averages densities on one grid; take projection 'flux-difference' and another force than "
                "'shift-exact', which moves the nodes"
            )
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
        return Macroscopic(self.scheme, self.coupling, self.order, self.limiter, self.statics)

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


def unread(scheme: int, order: int) -> dict[str, str]:
    """Keys that a scheme does not read, and to what they belong."""
    belongs = {
        "coupling": ("scheme 3", scheme == 3),
        "order": ("scheme 4", scheme == 4),
        "limiter": ("order 2 of scheme 4", scheme == 4 and order == 2),
        "statics": ("order 1 of scheme 4", scheme == 4 and order == 1),
    }
    return {name: to for name, (to, read) in belongs.items() if not read}


def _check_scheme(method: Kinetic | Macroscopic) -> None:
    """Refuse keys that the scheme does not read."""
    plain = Macroscopic.__dataclass_fields__
    for name, belongs in unread(method.scheme, method.order).items():
        asked = getattr(method, name)
        if asked != plain[name].default:
            raise ValueError(f"{name} = {asked!r} belongs to {belongs}; leave it out, or take that")
