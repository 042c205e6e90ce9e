"""Every family and its variants, each with the first line of its own description."""

from __future__ import annotations

import inspect
from typing import Any, NamedTuple, get_args

from .clock import Courant, Fixed
from .kinetic.equilibrium import EQUILIBRIA
from .kinetic.force import FORCES
from .kinetic.rows import FluxDifference, Resummed
from .kinetic.velocity import Velocity
from .method import Kinetic, Macroscopic
from .model.boundary import EXPLAINED
from .model.chute import ConstantSlope, SmoothChute
from .model.friction import Friction
from .model.heap import Heap
from .model.slope import Slope
from .schemes.order import Second
from .schemes.reflecting import Reflecting
from .schemes.scheme1 import Upwind
from .schemes.scheme4 import Held
from .schemes.scheme23 import Balanced, CoupledByCell, CoupledByFace

PROJECTIONS = {"flux-difference": FluxDifference, "re-summed": Resummed}


class Room(NamedTuple):
    """A variant: the key in a scene file, the word that chooses it, and what it is."""

    key: str
    name: str
    line: str


def rooms() -> list[Room]:
    """All variants, family by family."""
    schemes: dict[str, type] = {
        "1": Upwind, "2": Balanced, "3, coupling cell": CoupledByCell, "3, coupling face": CoupledByFace,
        "4": Held, "4, order 2": Second, "4, statics reflect": Reflecting,
    }  # fmt: skip
    return [
        *_by_kind("chute.kind", ConstantSlope, SmoothChute),
        *_by_kind("chute.zeta.kind", *_variants(Slope)),
        *_by_kind("friction.kind", *_variants(Friction)),
        *_by_kind("heap.kind", *_variants(Heap)),
        *(Room("boundary", name, line) for name, line in EXPLAINED.items()),
        *_by_kind("clock", Fixed, Courant),
        *_by_kind("method.kind", Kinetic, Macroscopic),
        *(Room("method.scheme", name, _first_line(kind)) for name, kind in schemes.items()),
        *_by_kind("method.velocity.kind", *_variants(Velocity)),
        *(Room("method.equilibrium", name, _first_line(type(room))) for name, room in EQUILIBRIA.items()),
        *(Room("method.force", name, _first_line(type(room))) for name, room in FORCES.items()),
        *(Room("method.projection", name, _first_line(room)) for name, room in PROJECTIONS.items()),
    ]


def _variants(family: Any) -> tuple[Any, ...]:
    """The members of an annotated union."""
    inner = get_args(family)[0]
    return get_args(get_args(inner)[0]) if get_args(get_args(inner)[0]) else get_args(inner)


def _by_kind(key: str, *kinds: Any) -> list[Room]:
    return [Room(key, kind.__dataclass_fields__["kind"].default.default, _first_line(kind)) for kind in kinds]


def _first_line(thing: type) -> str:
    return (inspect.getdoc(thing) or "").split("\n")[0]
