"""Which density a method gets: one that is stored, or one that is made when somebody asks for it."""

from __future__ import annotations

from ..balance.scheme4 import Held
from ..balance.schemes import Scheme, Scheme1
from ..method import Kinetic
from ..model.ground import Flat
from ..scene import Scene
from .equilibrium import EQUILIBRIA
from .force import FORCES
from .lean import OnDemand
from .velocity import Fitted
from .wing import Density


def make_density(scene: Scene, method: Kinetic, scheme: Scheme) -> Density:
    """The density of a method on a velocity grid, stored only where it has to be."""
    assert not isinstance(method.velocity, Fitted)
    kind = OnDemand if may_forget(method, scheme) and isinstance(scene.ground, Flat) else Density
    return kind(scene, method.velocity, EQUILIBRIA[method.equilibrium], FORCES[method.force], scheme)


def may_forget(method: Kinetic, scheme: Scheme) -> bool:
    """Whether a step needs sums of M only: f >= 0 is proved under (28), and U does not come out of f."""
    plain = method.equilibrium in ("cell-average", "sampled") and method.force == "shift-linear"
    return plain and method.projection == "flux-difference" and type(scheme) in (Scheme1, Held)
