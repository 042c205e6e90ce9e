"""A scene and a method made ready: `march` takes a block of steps, `stages` one with all that is made on its way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..clock import AnyClock, Fixed
from ..kinetic.rows import Carrier
from ..kinetic.velocity import Grid
from ..memory import require
from ..method import Kinetic, Macroscopic
from ..scene import Scene
from ..schemes.bed import Curve, Plane
from ..schemes.tile import SIZE, TILE, Model
from . import ahead
from .asked import asked_of
from .march import (
    BEFORE,
    BEYOND,
    COUNTED,
    F_MIN,
    H_MIN,
    LEFT_OVER,
    LIFT_FROM,
    LIFT_LEAST,
    LIFT_SINCE,
    LIFT_TO,
    LOST_ALL,
    NOT_FINITE,
    OUTSIDE,
    SEEN,
    TICKS,
    TIGHT,
    Asked,
    T,
    count_velocity,
    march,
    speed_of,
)  # fmt: skip
from .model import model_of, parts_of, shape_of
from .stages import Stages
from .sweep import FASTEST, KEPT
from .watch import NOBODY, watch_of


@dataclass
class Block:
    """Some steps, and where they led.

    Attributes:
        reason: Why they ended; see `kinsim.solver.march`.
        dts: Their lengths.
        step: Number of the last step.
        t: Time after it.
        h, q: State after it, each of shape (nx,); views that are good until the next block.
        last: Whether the clock has ended.
    """

    reason: int
    dts: Array
    step: int
    t: float
    h: Array
    q: Array
    last: bool
    solver: Solver

    @classmethod
    def now(cls, solver: Solver) -> Block:
        """No step more."""
        return cls(COUNTED, np.empty(0), solver.step, solver.t, solver.h, solver.q, False, solver)

    @property
    def stages(self) -> Stages:
        """The last step once more, with every stage."""
        return self.solver.last_stages


class Solver:
    """Advances a state.

    Attributes:
        scene, method: What is computed.
        model: The same as kernels see it.
        grid: Velocity cells, or None.
        step: Steps so far.
        seen: What is seen of the run; the names of its entries are in `kinsim.solver.march`.
        limit: The largest Courant number, (28).
    """

    limit = 1.0

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic, force: bool = False) -> None:
        self.scene, self.method, self.force = scene, method, force
        nx = scene.cells.count
        self._nx, self._tiles, self.step = nx, -(-nx // TILE), 0
        self._states = [(np.zeros(nx + 4), np.zeros(nx + 4)) for _ in range(3)]
        self._room, self._kept = np.zeros((1, SIZE)), np.zeros((self._tiles, KEPT))
        self._fresh, self._dt = True, 0.0
        self._stages: Stages | None = None
        self.attempted, self.seen = 0.0, fresh_seen()
        h, q = scene.initial()
        self.first_mass = float(np.sum(h)) * scene.cells.dx
        ahead.begin()
        self._make(scene.fastest)
        self.put(h, q)

    def _make(self, reach: float) -> None:
        """The model, with velocity cells for velocities up to `reach`."""
        velocity = self.method.velocity_cells
        self.grid = velocity.grid(2.0 * reach) if velocity else None
        if self.grid is not None:
            entries, densities = f"{self._nx} x {self.grid.count} entries", 3 if self.method.stores_density else 1
            require(8.0 * densities * self._nx * self.grid.count, f"{densities} densities of {entries}")
        self._take(model_of(self.scene, self.method, self.grid))

    def _take(self, model: Model) -> None:
        self.model, self._parts, self._shape = model, parts_of(model), shape_of(model)
        self._rows = np.array([part.row for part in self._parts], dtype=np.int64)
        if self.grid is not None:
            self.carrier = Carrier(model, self._nx, self.grid.side)
        self._watching, self._watch = watch_of(model, self.method, self.grid, self.force)
        self._lifting = lifting_of(model.ground.bed)

    def put(self, h: Array, q: Array) -> None:
        """Stand at the state (h, q), each of shape (nx,)."""
        now_h, now_q = self._states[0]
        now_h[2:-2], now_q[2:-2] = h, np.where(np.asarray(h) == 0.0, 0.0, q)
        self._fresh, self._stages = True, None

    @property
    def t(self) -> float:
        """The time."""
        return float(self.seen[T])

    @property
    def h(self) -> Array:
        """Heights, shape (nx,), to read."""
        return read_only(self._states[0][0][2:-2])

    @property
    def q(self) -> Array:
        """Momenta, shape (nx,), to read."""
        return read_only(self._states[0][1][2:-2])

    @property
    def fastest(self) -> float:
        """The fastest particle |u| + c of the state."""
        return float(self._kept[:, FASTEST].max())

    @property
    def before(self) -> tuple[Array, Array]:
        """(h, q) before the last step."""
        h, q = self._states[1]
        return h[2:-2], q[2:-2]

    @property
    def counted(self) -> float:
        """The outermost velocity that (28) counts."""
        shape = self._shape
        streams = speed_of(shape.left, shape.beta_left), speed_of(shape.right, shape.beta_right)
        return float(count_velocity(shape, max(self.fastest, *streams)))

    def march(self, clock: AnyClock, most: int, until: float = math.inf, past: float = math.inf) -> Block:
        """At most `most` steps, to land on the time `until`, and no further than the first one at or after `past`."""
        planned, until = clock.planned, min(until, clock.until)
        most = int(min(most, clock.ticks - self.seen[TICKS]))  # what is left over of a step is one of these
        asked = asked_of(self, clock, until, past)
        dts, done, reason = np.empty(most), 0, COUNTED
        while done < most and reason == COUNTED:
            steps, reason = self._go(asked, planned, most - done, self._room, dts[done:])
            done += steps
            if reason == TIGHT:
                steps, reason = self._go_tight(asked, planned, dts[done:])
                done += steps
            if reason == OUTSIDE and self._follow(float(self.seen[BEYOND])):
                asked, reason = asked_of(self, clock, until, past), COUNTED
        return Block(reason, dts[:done].copy(), self.step, self.t, self.h, self.q, ended(clock, self), self)

    def _go(
        self, asked: Asked, planned: Array, most: int, rooms: Array, dts: Array, whole: bool = False
    ) -> tuple[int, int]:
        ahead.wait()
        steps, reason = march(
            self._shape, self._rows, self._lifting, asked, planned, most, tuple(self._states), rooms, self._watch,
            self._kept, dts, self.seen, self._fresh, whole,
        )  # fmt: skip
        if steps < most:
            self.attempted = float(dts[steps])
        if steps:
            turn = steps % 3
            now, before, spare = self._states
            self._states = [[now, before, spare], [spare, now, before], [before, spare, now]][turn]
            self._dt, self._fresh, self._stages = float(dts[steps - 1]), False, None
            self.step += steps
        self._fresh |= reason in (TIGHT, OUTSIDE, NOT_FINITE)  # what was kept of tiles is of the step that was refused
        return steps, reason

    def _go_tight(self, asked: Asked, planned: Array, dts: Array) -> tuple[int, int]:
        """One step in which the density may lose mass over the edge of its window: look at it, and book the loss."""
        steps, reason = self._go(asked, planned, 1, np.zeros((self._tiles, SIZE)), dts, whole=True)
        if steps:
            density = self.last_stages.density
            self.seen[LOST_ALL] += self.scene.cells.dx * (density.lost + density.cut)
        return steps, reason

    def _follow(self, reach: float) -> bool:
        """Make a window that follows for velocities up to `reach`; False if the velocity cells are fixed."""
        if not (self.method.velocity_cells and self.method.velocity_cells.follows):
            return False
        self.seen[BEYOND] = 0.0
        report = self.model.flux.report
        self._make(reach)
        self.model.flux.report[:] = report
        self._fresh = True
        return True

    def warm_up(self) -> None:
        """Compile what this run needs, so that it does not count as running."""
        self._go(asked_of(self, Fixed(1.0, 1)), np.empty(0), 0, self._room, np.empty(1))
        if self.grid is not None:
            density = self.stages(self.h, self.q, 1e-3 * self.scene.cells.dx).density
            density.equilibrium(self.h, 0.0 * density.f[:, 0])

    def stages(self, h: Array, q: Array, dt: float, t: float = 0.0, force: bool = True) -> Stages:
        """One step from (h, q) at time t, every stage kept: a march of one step whose tiles have a room each."""
        other = self._aside(force)
        other.put(h, q)
        report = self.model.flux.report.copy() if self.grid is not None else np.empty(0)
        rooms = np.zeros((self._tiles, SIZE))
        asked = asked_of(other, Fixed(dt, 1))._replace(bound=math.inf, room=math.inf)
        other._go(asked, np.empty(0), 1, rooms, np.empty(1), whole=True)
        if self.grid is not None:
            self.model.flux.report[:] = report
        return Stages(other, rooms, dt, t)

    def _aside(self, force: bool) -> Solver:
        """A solver with the same model, and a state of its own."""
        other = Solver.__new__(Solver)
        other.__dict__ |= self.__dict__
        other._states = [(np.zeros(self._nx + 4), np.zeros(self._nx + 4)) for _ in range(3)]
        other._kept, other.seen, other.force = np.zeros((self._tiles, KEPT)), fresh_seen(), force
        if self.method.stores_density:
            other._take(model_of(self.scene, self.method, self.grid))
        other._watch = NOBODY
        return other

    @property
    def last_stages(self) -> Stages:
        """The last step once more, with every stage."""
        if self._stages is None:
            self._stages = self.stages(*self.before, self._dt, float(self.seen[BEFORE]))
        return self._stages

    def kept(self) -> dict[str, NDArray[Any]]:
        """All that the next step depends on."""
        state, before = np.array([self.h, self.q]), np.array(self.before)
        kept = {"step": np.array([self.step, self._dt]), "seen": self.seen.copy(), "state": state, "before": before}
        of_grid = {"report": self.model.flux.report.copy(), "cells": np.array(self.grid.count)} if self.grid else {}
        return kept | of_grid

    def restore(self, kept: dict[str, NDArray[Any]]) -> None:
        """Stand where `kept` was told."""
        step, self._dt = kept["step"].tolist()
        if kept["seen"].shape != self.seen.shape or kept["state"].shape != (2, self._nx):
            raise ValueError("of another run")
        self.step, self.seen = int(step), kept["seen"].copy()
        for (h, q), values in zip(self._states, (kept["state"], kept["before"]), strict=False):
            h[2:-2], q[2:-2] = values
        if self.grid is not None:
            if self.grid.count != int(kept["cells"]):
                self.grid = Grid(int(kept["cells"]), self.grid.dxi)
                self._take(model_of(self.scene, self.method, self.grid))
            self.model.flux.report[:] = kept["report"]
        self._fresh, self._stages = True, None


def ended(clock: AnyClock, solver: Solver) -> bool:
    """Whether the clock has no step left."""
    whole = solver.seen[TICKS] >= clock.ticks and solver.seen[LEFT_OVER] == 0.0
    return bool(whole or solver.t >= clock.until)


def read_only(view: Array) -> Array:
    """A view that nobody can write to."""
    view.flags.writeable = False
    return view


def lifting_of(bed: Plane | Curve) -> Array:
    """n and its bend in each cell, shape (2, nx + 4), by which cells leave the ground."""
    return np.array([bed.n, bed.bend]) if isinstance(bed, Curve) else np.zeros((2, 1))


def fresh_seen() -> Array:
    """Nothing seen yet."""
    seen = np.zeros(SEEN)
    seen[[H_MIN, F_MIN, LIFT_FROM, LIFT_SINCE, LIFT_LEAST]] = math.inf
    seen[LIFT_TO] = -math.inf
    return seen
