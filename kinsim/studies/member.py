"""A member of a study: what is to be run, and the name that its result is kept under."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path

from ..clock import AnyClock
from ..method import Kinetic, Macroscopic
from ..run import describe
from ..scene import Scene

ONCE = 2**62
"""As `save_every`: no rows but the first and the last."""


@dataclass(frozen=True)
class Request:
    """What is asked of every member.

    Attributes:
        fields: Names of histories to keep: "h", "q", "u", or columns of the ledger.
        save_every: Steps from one row of a history to the next.
        force: Run although the CFL bound (28) is broken.
        traced: Measure the memory that a run takes at most, which makes it slower.
    """

    fields: tuple[str, ...] = ()
    save_every: int = ONCE
    force: bool = False
    traced: bool = False


@dataclass(frozen=True)
class Member:
    """One run; `repeat` tells apart runs of the same that are timed."""

    scene: Scene
    method: Kinetic | Macroscopic
    clock: AnyClock
    request: Request = Request()
    repeat: int = 0

    @cached_property
    def key(self) -> str:
        """A hash of scene, initial state, method, clock, request and the code that runs."""
        h, q = self.scene.initial()
        parts = (describe(Scene, self.scene), describe(type(self.method), self.method))
        clock = describe(type(self.clock), self.clock)
        rest = json.dumps([clock, *vars(self.request).items(), self.repeat, code_stamp()])
        return hashlib.sha256("\n".join([*parts, rest]).encode() + h.tobytes() + q.tobytes()).hexdigest()[:32]


@dataclass(frozen=True)
class Refused:
    """Values that do not go together; a row that says why."""

    message: str


@cache
def code_stamp() -> str:
    """The version, and a hash of every source file but of pictures: what other code computed is not taken for this."""
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for path in sorted(set(package.rglob("*.py")) - set((package / "plot").iterdir())):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{version('kinsim')} {digest.hexdigest()}"
