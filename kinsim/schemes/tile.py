"""A tile: some cells with two neighbours on each side, and all stages of a step of them in rows of one array.

In one array the compiler knows that nothing overlaps, so that each loop over a row runs in vector registers. Its own
cells are 0 to n - 1; cell k stands between the faces k - 1 and k.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..arrays import Array
from ..compiled import routine

TILE = 256
"""Cells of a tile."""

WIDTH = TILE + 8
"""Places of a row."""

CELLS = (
    "h", "u", "q", "h_plus", "u_plus", "h_minus", "u_minus", "low", "high", "share", "candidate", "slow",
    "h1", "qhat", "friction", "pull_low", "pull_high", "J", "q1", "speed", "moved",
)  # fmt: skip
"""Stages that belong to cells; see `kinsim.solver.step.Step` for the most of them."""

FACES = (
    "e", "theta", "still", "leftover", "static", "h_left", "h_right", "P1", "P2", "N1", "N2", "h_mean",
    "W1", "W2", "B1", "B2", "F1", "F2", "G1", "G2",
)  # fmt: skip
"""Stages that belong to faces: P and N are the moments over xi > 0 of what stands left of a face, over xi < 0 of what
stands right of it; W and B the upwind and the balanced flux; F the flux that the
cell left of a face takes at it, G the one that the cell right of it takes."""

NAMES = CELLS + FACES

(
    H, U, Q, HP, UP, HM, UM, LOW, HIGH, SHARE, CANDIDATE, SLOW,
    H1, QHAT, FRICTION, PULL_LOW, PULL_HIGH, J, Q1, SPEED, MOVED,
    E, THETA, STILL, LEFTOVER, STATIC, HL, HR, P1, P2, N1, N2, HB,
    W1, W2, B1, B2, F1, F2, G1, G2,
) = (WIDTH * row + 4 for row in range(len(NAMES)))  # fmt: skip

SIZE = WIDTH * len(NAMES)
"""Entries of a work array."""


class Place(NamedTuple):
    """Where a tile stands: its first cell (in arrays with two ghosts at each end), their number, at which end it is."""

    begin: int
    n: int
    first: bool
    last: bool


OPEN, WALL, RING, STREAM = 0.0, 1.0, 2.0, 3.0
"""Kinds of ends."""


class End(NamedTuple):
    """An end of the domain: its kind, and height and velocity of a stream that comes in."""

    kind: float
    h: float
    u: float


class Ground(NamedTuple):
    """What a scene is to a scheme: a law of friction, a bed, two ends, and the length of a cell."""

    law: Any
    bed: Any
    left: End
    right: End
    dx: float


class Model(NamedTuple):
    """A scene and a method as kernels see them; the class of each part chooses its formulas."""

    scheme: Any
    order: Any
    flux: Any
    force: Any
    projection: Any
    ground: Ground


@routine()
def load(h: Array, q: Array, place: Place, room: Array) -> None:
    """U^n of a tile and of two cells on each side, and u = q/h."""
    for k in range(-2, place.n + 2):
        room[H + k] = h[place.begin + k]
        room[Q + k] = q[place.begin + k]
    for k in range(place.n + 4):
        room[U - 2 + k] = room[Q - 2 + k] / room[H - 2 + k] if room[H - 2 + k] > 0.0 else 0.0


@routine()
def all_dry(n: int, room: Array) -> bool:
    """Whether a tile and its margin hold nothing."""
    dry = 0
    for k in range(-2, n + 2):
        dry += 1 if room[H + k] == 0.0 else 0
    return dry == n + 4
