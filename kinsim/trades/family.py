"""The methods that are measured against each other, line by line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

from ..errors import InputError
from ..kinetic.velocity import Fitted, Uniform
from ..method import ForceName, Kinetic, Macroscopic
from ..read import SHARED
from .pace import twin_of

COUNTS = (8, 16, 32, 64, 128, 256)
"""Velocity cells of the lines over n."""

FITTED = (1, 2, 3, 4, 6)
CELLS = (0.25, 0.5, 2.0)
"""Cells of the lines over dx, over those of the scene."""

NUMBER = 0.8
"""Courant number."""


@dataclass(frozen=True)
class Choice:
    """A method on `cells` times the cells of the scene, with steps of the Courant number `number`."""

    line: str
    method: Kinetic | Macroscopic
    cells: float = 1.0
    number: float = NUMBER

    @property
    def nodes(self) -> int:
        """Velocity nodes, 0 for the closed form."""
        velocity = getattr(self.method, "velocity", None)
        return velocity.count if isinstance(velocity, (Uniform, Fitted)) else 0


def lines(method: Kinetic | Macroscopic) -> dict[str, list[Choice]]:
    """The lines that there are for the scheme of `method`, each with its choices."""
    twin = twin_of(method)
    shared: dict[str, Any] = {key: getattr(twin, key) for key in SHARED}

    def kinetic(velocity: Uniform | Fitted, **keys: Any) -> Kinetic:
        return Kinetic(velocity=velocity, **{**shared, **keys})

    fitted = kinetic(Fitted(4))
    found = {
        "closed form": [Choice("closed form", twin)],
        "cell average": [Choice("cell average", kinetic(Uniform(n))) for n in COUNTS],
        "sampled": [Choice("sampled", kinetic(Uniform(n), equilibrium="sampled")) for n in COUNTS],
        "fitted": [Choice("fitted", kinetic(Fitted(n))) for n in FITTED],
        "force": [
            Choice("force", made)
            for name in get_args(ForceName)
            if (made := _made(lambda name=name: kinetic(Uniform(64), force=name))) and name != "shift-linear"
        ],
        "dx": [Choice("dx", one, cells) for cells in CELLS for one in (twin, fitted)],
        "courant": [Choice("courant", twin, number=NUMBER * part) for part in (0.5, 0.25)],
    }
    if twin.scheme == 4 and twin.order == 1:
        second = replace(twin, order=2, statics="hold")
        four = Kinetic(velocity=Fitted(4), order=2)
        found["order"] = [Choice("order", one, cells) for cells in (1.0, *CELLS) for one in (second, four)]
    return {name: choices for name, choices in found.items() if choices}


def _made(make: Any) -> Kinetic | None:
    try:
        return make()  # type: ignore[no-any-return]
    except InputError:
        return None


def chosen(method: Kinetic | Macroscopic, names: Sequence[str] | None) -> list[Choice]:
    """The choices of the lines called `names`, of all lines without.

    Raises:
        InputError: There is no such line, or nothing is left.
    """
    known = lines(method)
    for name in names or ():
        if name not in known:
            raise InputError(f"trade: no line {name!r}; choose from {', '.join(known)}")
    family = [choice for name in (known if names is None else dict.fromkeys(names)) for choice in known[name]]
    if not family:
        raise InputError(f"trade: the family is empty; name at least one line of {', '.join(known)}")
    return family
