"""One place of the atlas: a mass between walls, of which everything can be made extreme."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from ..clock import Courant
from ..kinetic.velocity import Uniform
from ..method import Kinetic, Macroscopic
from ..model.cells import Cells
from ..model.chute import ConstantSlope
from ..model.friction import Coulomb, Frictionless
from ..model.ground import flat
from ..model.heap import Profile
from ..scene import Scene
from ..simulate import find_bound

Mass = Literal["hump", "one cell", "none"]

NUDGE = 1e-9
"""Relative noise of the disturbed twin of a run."""

EVERY = 10
"""Steps from one look at the state to the next, in a run that is not made longer."""

MOST = 20
"""So many times the steps asked for are taken at most."""


@dataclass(frozen=True)
class Setting:
    """A hump on a layer between walls, and a method. All lengths, times and velocities are dimensionless.

    Attributes:
        method: How it is computed.
        number: The Courant number; None takes 0.9.
        steps, times: About times x steps are taken.
        count, dx: The cells.
        scale: The height of the hump.
        ratio: The left half is so many times higher than the right one.
        froude: u/c everywhere, c = sqrt(2 beta h) of the highest cell.
        epsilon, zeta, delta: As in a scene; delta = 0 is no friction.
        mass: Whether there is a hump, one cell of it, or nothing.
        nodes: Velocity cells, in place of those of the method.
    """

    method: Kinetic | Macroscopic
    number: float | None = None
    steps: int = 200
    times: float = 1.0
    count: int = 40
    dx: float = 0.05
    scale: float = 1.0
    ratio: float = 1.0
    froude: float = 0.5
    epsilon: float = 0.4
    zeta: float = 0.1
    delta: float = 0.3
    mass: Mass = "hump"
    nodes: int | None = None

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        y = (np.arange(self.count) + 0.5) / self.count
        h = self.scale * (0.2 + np.exp(-64.0 * (y - 0.4) ** 2)) / 1.2
        if self.mass != "hump":
            h = np.where(np.arange(self.count) == self.count // 2, self.scale, 0.0) * (self.mass == "one cell")
        h = np.where(y < 0.5, h, h / self.ratio)
        plain = Scene(
            Cells(0.0, self.count * self.dx, self.count), Profile(h), ConstantSlope(self.zeta),
            Coulomb(self.delta) if self.delta else Frictionless(), "wall", self.epsilon,
        )  # fmt: skip
        ground = flat(plain.ground)
        u = self.froude * math.sqrt(2.0 * ground.beta * h.max()) * np.where(h > 0, 1.0, 0.0)
        return replace(plain, heap=Profile(h, u))

    @property
    def nudged(self) -> Profile:
        """The heap with noise."""
        h, u = self.scene.heap(self.scene.x)
        noise = np.random.default_rng(0).uniform(-1.0, 1.0, h.size)
        return Profile(h * (1.0 + NUDGE * noise), u)

    @cached_property
    def way(self) -> Kinetic | Macroscopic:
        """The method, with the nodes, in a window that the disturbed twin shares."""
        if not isinstance(self.method, Kinetic):
            return self.method
        method = self.method if self.nodes is None else replace(self.method, velocity=Uniform(self.nodes))
        return method.within(find_bound(self.scene, method, self.clock, force=True)) if method.unbounded else method

    @property
    def clock(self) -> Courant:
        """About `steps` steps, fewer where gravity accelerates the mass much."""
        scene, ground = self.scene, flat(self.scene.ground)
        number = 0.9 if self.number is None else self.number
        fastest = scene.fastest
        way = self.times * self.steps * number * scene.cells.dx
        ends = [math.sqrt(2.0 * way / pull) for pull in [abs(ground.pull) + ground.hold] if pull > 0.0]
        end = min([*ends, *([way / fastest] if fastest > 0.0 else [])], default=way)
        return Courant(number, end, most=math.ceil(MOST * max(self.times, 1.0) * self.steps))

    @property
    def every(self) -> int:
        """Steps from one look at the state to the next."""
        return math.ceil(EVERY * max(self.times, 1.0))
