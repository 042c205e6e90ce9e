"""Every variant of the kinetic wing, taken from the registries: a new one appears by being listed there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from kinsim import Fitted, Kinetic, Uniform
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.kinetic.velocity import Window
from kinsim.rooms import PROJECTIONS

FITTED = range(2, 9)
"""Nodes of `Fitted` that are looked at."""

Make = Callable[[int, int, float], Kinetic]
"""Scheme, nodes and bound to a method."""


@dataclass(frozen=True)
class Variant:
    """One variant; `make(scheme, n, bound)` is its method with n nodes on [-bound, bound]."""

    family: str
    name: str
    make: Make = field(repr=False)

    @property
    def fitted(self) -> bool:
        """Whether it has no grid."""
        return self.family == "fitted"


def variants() -> Iterator[Variant]:
    """Every equilibrium at the default force, every other force, projection and velocity space at the defaults."""
    default = Kinetic(1)
    for name in EQUILIBRIA:
        yield Variant("equilibrium", name, lambda s, n, b, name=name: Kinetic(s, Uniform(n, b), name))
    for name in FORCES:
        if name != default.force:
            yield Variant("force", name, lambda s, n, b, name=name: Kinetic(s, Uniform(n, b), force=name))
    for name in PROJECTIONS:
        if name != default.projection:
            yield Variant("projection", name, lambda s, n, b, name=name: Kinetic(s, Uniform(n, b), projection=name))
    yield Variant("window", "window", lambda s, n, b: Kinetic(s, Window(2.0 * b / n)))
    yield Variant("fitted", "fitted", lambda s, n, b: Kinetic(s, Fitted(n)))
