"""The two methods: how a scene is computed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WrapSerializer
from pydantic.json_schema import SkipJsonSchema

from .kinetic.velocity import Fitted, Uniform, Velocity, Window
from .value import described_outside, kind, value

NoFlag = BeforeValidator(lambda given: str(given) if isinstance(given, bool) else given)
"""True is 1 to Python, and no scheme."""

SchemeNumber = Annotated[Literal[1, 2, 3, 4], NoFlag]
Order = Annotated[Literal[1, 2], NoFlag]

Statics = Literal["hold", "reflect"]

Coupling = Literal["cell", "face"]

Limiter = Literal["minmod", "between", "mc"]

LIMITERS: dict[Limiter, float] = {"minmod": 1.0, "between": 1.2, "mc": 2.0}
"""How many times the smaller one of two differences a slope may be."""

EquilibriumName = Literal["cell-average", "sampled", "matched", "entropic"]

NODES: dict[EquilibriumName, int] = {"cell-average": 2, "sampled": 2, "matched": 4, "entropic": 4}
"""Velocity cells that each equilibrium needs at least."""

ForceName = Literal["shift-linear", "shift-exact", "shift-pfc", "derivative-upwind", "derivative-centred"]

ProjectionName = Literal["flux-difference", "re-summed"]


def _flux(given: Any) -> Any:
    if given is not None and not callable(given):
        raise ValueError(
            f"flux = {given!r} is no function; give flux(h_left, u_left, h_right, u_right, beta) -> (F1, F2)"
        )
    return given


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
        flux: A numerical flux of one's own, flux(h_left, u_left, h_right, u_right, beta) -> (F1, F2), in place of (24).
    """

    scheme: SchemeNumber = 4
    coupling: Coupling = "cell"
    order: Order = 1
    limiter: Limiter = "between"
    statics: Statics = "hold"
    flux: SkipJsonSchema[Annotated[Any, BeforeValidator(_flux), WrapSerializer(described_outside)]] = None
    kind: Literal["macroscopic"] = kind("macroscopic")
    velocity_cells: ClassVar[None] = None
    stores_density: ClassVar[bool] = False
    keeps_positive: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _check_scheme(self)
        if self.flux is not None and self.statics == "reflect":
            raise ValueError("flux of one's own with statics 'reflect': it has no half-range moments; take 'hold'")


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
        plain = ("cell-average", "shift-linear", "flux-difference")
        if isinstance(self.velocity, Fitted):
            if (self.equilibrium, self.force, self.projection) != plain:
                raise ValueError(
                    "fitted nodes carry M itself; leave equilibrium, force and projection at their defaults"
                )
        elif isinstance(self.velocity, Uniform):
            least = NODES[self.equilibrium]
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
    def velocity_cells(self) -> Uniform | Window | None:
        """The velocity cells that are summed over; None with fitted nodes."""
        return None if isinstance(self.velocity, Fitted) else self.velocity

    @property
    def stores_density(self) -> bool:
        """Whether the next state comes out of f."""
        return self.projection == "re-summed" and self.velocity_cells is not None

    @property
    def keeps_positive(self) -> bool:
        """Whether f >= 0 is proved under (28): one flux at a face of what stands there, and a force that moves f."""
        return self.scheme in (1, 4) and self.force.startswith("shift")

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
