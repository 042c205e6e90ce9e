"""Sleeping cells: what did not change in a step does not change in the next one of the same length.

A new state of a cell depends on its old state and on those of `REACH` neighbours to each side. So where all of these
came out of a step bitwise as they went in, the next step with the same dt changes nothing either, and is not computed.
The cells between the first and the last that are awake are stepped as a scene of their own with `REACH` sleeping cells
on each side; what its cut ends do to those is thrown away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .balance.stages import Array
from .checkpoint import Kept
from .kernel import kernel
from .kinetic.velocity import Uniform, Window
from .method import Kinetic, Macroscopic
from .model.boundary import Boundary, ends
from .model.ground import Ground
from .scene import Scene
from .stepper import Books, Stepper, make_stepper

REACH = 6
"""Neighbours that a step may ask: two stages, each of a cell, its slope, its neighbour's slope and the face beyond."""

BLOCK = 32
"""Parts begin and end at multiples of so many cells, so that few are made."""


@dataclass(frozen=True)
class Stretch:
    """Cells of a part of a scene: their number, and the very same length."""

    count: int
    dx: float


@dataclass(frozen=True)
class Part:
    """What a stepper asks of a scene, of some of its cells."""

    cells: Stretch
    boundary: Boundary
    ground: Ground
    forced: bool

    @classmethod
    def of(cls, scene: Scene, low: int, high: int) -> Part:
        """The cells from `low` to below `high`; a cut end is open."""
        left, right = ends(scene.boundary)
        boundary = (left if low == 0 else "open", right if high == scene.cells.count else "open")
        cells = Stretch(high - low, scene.cells.dx)
        return cls(cells, boundary, scene.ground.part(low, high), scene.forced)  # type: ignore[arg-type]


class Awake:
    """Steps a scene, and leaves out what sleeps.

    Attributes:
        h1, q1: The state after the last step.
        at: The stepper that takes the step: of the whole scene, of its awake part, or None if all sleep.
        cell_steps: How many cells were stepped so far.
    """

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic, whole: Stepper) -> None:
        self.h1, self.q1 = whole.now.h1, whole.now.q1
        self.at: Stepper | None = whole
        self.cell_steps = 0
        self.sleeps = _may_sleep(method)
        self._whole, self._scene, self._method = whole, scene, method
        self._cells = self._awake = (0, scene.cells.count)
        self._made: tuple[int, int] | None = None
        self._part: Stepper | None = None
        self._dt = 0.0
        self._entering = [0.0, 0.0]

    def begin(self, h: Array, q: Array, dt: float | None) -> float:
        """Stand at (h, q); `dt` is the length of the coming step if cells may sleep through it, else None.

        Returns:
            The fastest occupied velocity of the cells that are awake.
        """
        self.at = self._choose() if dt is not None and dt == self._dt else self._whole
        if self.at is None:
            return 0.0
        if self.at is self._whole:
            return self._whole.begin(h, q)
        low, high = self._padded()
        return self.at.begin(h[low:high], q[low:high])

    def advance(self, h: Array, q: Array, dt: float) -> Books:
        """From (h, q), where `begin` stood, to (h1, q1)."""
        self._dt = dt
        if self.at is not self._whole:
            self.h1[:], self.q1[:] = h, q
        books = Books(0.0, 0.0, 0.0, 0.0, 0.0) if self.at is None else self._step(self.at, h, q, dt)
        return Books(dt * self._entering[0], dt * self._entering[1], *books[2:])

    def kept(self) -> Kept:
        """What the next step depends on."""
        return {"awake": np.array([*self._awake, self.cell_steps]), "numbers": np.array([self._dt, *self._entering])}

    def restore(self, kept: Kept) -> None:
        """Go on from there."""
        low, high, self.cell_steps = kept["awake"].tolist()
        self._awake = (low, high)
        self._dt, *self._entering = kept["numbers"].tolist()
        self.at = None

    def _step(self, at: Stepper, h: Array, q: Array, dt: float) -> Books:
        """Step the cells that are awake, and see which of them are so after it."""
        nx = h.size
        books = at.advance(dt)
        self.cell_steps += at.now.q.size
        low, high = left, right = 0, nx
        if at is not self._whole:
            (low, high), (left, right) = self._cells, self._padded()
            inner = slice(low - left, high - left)
            self.h1[low:high], self.q1[low:high] = at.now.h1[inner], at.now.q1[inner]
        first, last = changed(h, q, self.h1, self.q1, low, high)
        self._awake = (max(first - REACH, 0), min(last + REACH, nx)) if first < last else (0, 0)
        if books.window_loss:
            self._awake = (0, nx)
        if left == 0:
            self._entering[0] = books.inflow_left / dt
        if right == nx:
            self._entering[1] = books.inflow_right / dt
        return books

    def _choose(self) -> Stepper | None:
        """Who takes the step: nobody, a part, or the whole where the part would be nearly that or would wrap round."""
        nx = self.h1.size
        low, high = self._awake
        if low >= high:
            return None
        if (low, high) == (0, nx):
            return self._whole
        self._cells = low // BLOCK * BLOCK, min(-(-high // BLOCK) * BLOCK, nx)
        left, right = self._padded()
        wraps = self._scene.boundary == "periodic" and (left == 0 or right == nx)
        if wraps or right - left > 0.9 * nx:
            return self._whole
        if self._made != (left, right):
            self._made = (left, right)
            self._part = make_stepper(Part.of(self._scene, left, right), self._method)  # type: ignore[arg-type]
        return self._part

    def _padded(self) -> tuple[int, int]:
        return max(self._cells[0] - REACH, 0), min(self._cells[1] + REACH, self._scene.cells.count)


def _may_sleep(method: Kinetic | Macroscopic) -> bool:
    """Whether nothing but the state goes from step to step: no fluxes that make mass, no reports, no moving window."""
    if method.scheme in (2, 3):
        return False
    if isinstance(method, Macroscopic) or not isinstance(method.velocity, Uniform | Window):
        return True
    plain = method.equilibrium in ("cell-average", "sampled") and method.projection == "flux-difference"
    return plain and isinstance(method.velocity, Uniform) and method.velocity.beyond == "stop"


@kernel
def changed(h: Array, q: Array, h1: Array, q1: Array, low: int, high: int) -> tuple[int, int]:
    """The first cell from `low` to below `high` that changed, and one past the last; first = last if none did."""
    first, last = low, high
    while first < high and h1[first] == h[first] and q1[first] == q[first]:
        first += 1
    while last > first and h1[last - 1] == h[last - 1] and q1[last - 1] == q[last - 1]:
        last -= 1
    return first, last
