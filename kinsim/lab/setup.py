"""What the knobs say: the keys of a scene file, no more and no less."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from ..clock import Fixed, first_courant
from ..errors import InputError, line_of
from ..method import Kinetic, unread
from ..model.friction import Frictionless
from ..model.heap import Blocks, Table
from ..read import SceneFile, check, parse_keys, read_keys, take_method
from ..solver.march import ROUNDING
from ..solver.model import scheme_of

COURANT = 0.45
"""Of built-in scenes in the lab; the paper's steps take minutes to watch."""

NODES = 128
"""Of methods that have none."""


@dataclass(frozen=True, eq=False)
class Setup:
    """A scene file that is being written by turning knobs.

    Attributes:
        keys: As in the file.
        name: Of the scene or the file.
        notes: What was changed when it came into the lab, in sentences.
    """

    keys: Mapping[str, Any]
    name: str
    notes: tuple[str, ...] = field(default=())

    @classmethod
    def of_scene(cls, name: str) -> Setup:
        """A built-in scene, or a scene file, by name.

        Raises:
            InputError: There is none, or it is not as it should be.
        """
        return cls._brought(read_keys(name), name)

    @classmethod
    def of_content(cls, content: bytes, name: str) -> Setup:
        """The content of a scene file.

        Raises:
            InputError: It is not as it should be.
        """
        return cls._brought(parse_keys(content, name), name)

    @classmethod
    def _brought(cls, keys: dict[str, Any], name: str) -> Setup:
        file, notes = check(keys, name), []
        if not isinstance(file.method, Kinetic):
            take_method(keys, "kinetic")
            notes.append(f"The file takes the macroscopic wing; the lab carries a density, on {NODES} nodes.")
        elif file.method.velocity.kind != "uniform":
            keys["method"].pop("velocity")
            notes.append(f"The file takes {file.method.velocity.words}; the lab takes {NODES} fixed ones.")
        name = Path(name).name
        setup = cls(keys, name)
        if file.figure and isinstance(file.clock, Fixed):  # the paper's steps
            setup = setup.turned("clock.number", COURANT)
        return cls(setup.keys, name, tuple(notes))

    def turned(self, key: str, given: Any) -> Setup:
        """The same with another value at a dotted key; keys that the method then does not read are left out."""
        keys = copy.deepcopy(dict(self.keys))
        keys.pop("figure", None)
        _prepare(keys, key, self)
        *tables, last = key.split(".")
        place: Any = keys
        for part in tables:
            place = place[int(part)] if isinstance(place, list) else place.setdefault(part, {})
        place[int(last) if isinstance(place, list) else last] = given
        if isinstance(keys.get("method"), dict):
            _drop_unread(keys["method"])
        return Setup(keys, self.name)

    @cached_property
    def file(self) -> SceneFile:
        """The values.

        Raises:
            InputError: They do not go together; the message says which, and the remedy.
        """
        return check(dict(self.keys), "this setting")

    @cached_property
    def refusal(self) -> str:
        """Why it cannot be run, in a sentence, or nothing."""
        try:
            file = self.file
            scheme_of(file.method, file.scene)
        except (InputError, MemoryError) as error:
            return line_of(error)
        courant = first_courant(file.scene, file.clock)
        if courant <= 1.0 + ROUNDING:
            return ""
        return f"Courant number {courant:.3g} is above 1, the CFL bound (28); take at most 1"

    def given(self, key: str) -> Any:
        """What stands at a dotted key, filled in where the file leaves it out.

        Raises:
            InputError: The values do not go together.
        """
        file = self.file
        if key == "clock.number":
            return first_courant(file.scene, file.clock)
        if key == "clock.end":
            return file.clock.end
        if key == "friction.delta" and isinstance(file.friction, Frictionless):
            return 0.0
        if key.startswith("heap.velocities.") and isinstance(file.heap, Blocks):
            return file.heap.speeds[int(key.rpartition(".")[2])]
        place: Any = TypeAdapter(SceneFile).dump_python(file, mode="json")
        for part in key.split("."):
            place = place[int(part)] if isinstance(place, list) else place[part]
        return place

    def toml(self) -> str:
        """The scene file; needs the extra `lab`."""
        import tomli_w

        keys = copy.deepcopy(dict(self.keys))
        if isinstance(self.file.heap, Table):
            keys["heap"]["path"] = str(self.file.heap.path.resolve())
        plain = {key: value for key, value in keys.items() if not isinstance(value, dict)}
        tables = {key: value for key, value in keys.items() if isinstance(value, dict)}
        return f"# Saved by kinsim lab; kinsim run FILE runs it.\n{tomli_w.dumps(plain | tables)}"


def _prepare(keys: dict[str, Any], key: str, before: Setup) -> None:
    """Make room for a key whose table is missing, or of another kind so far."""
    clock, heap = keys["clock"], keys["heap"]
    if key in ("clock.number", "clock.end") and not {"number", "end"} <= clock.keys():
        kept = {name: clock[name] for name in ("stop_at_rest",) if name in clock}
        keys["clock"] = {"number": before.given("clock.number"), "end": before.given("clock.end"), **kept}
    if key == "chute.zeta":
        keys.setdefault("chute", {"kind": "constant"})
    if key == "friction.delta" and keys.get("friction", {}).get("kind") != "coulomb":
        keys["friction"] = {"kind": "coulomb"}
    if key.startswith("heap.velocities.") and heap.get("velocities") is None:
        heap["velocities"] = [0.0] * len(heap["heights"])


def _drop_unread(method: dict[str, Any]) -> None:
    """Leave out what belongs to other schemes."""
    for key in unread(method.get("scheme", 4), method.get("order", 1)):
        method.pop(key, None)
