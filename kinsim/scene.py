"""The scene: what happens, and nothing about how it is computed."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from .errors import InputError
from .mean import mean_velocity
from .model.boundary import Boundary, streams
from .model.cells import TINY, Cells
from .model.chute import Chute, ConstantSlope, SmoothChute
from .model.friction import Friction, Frictionless, held_by
from .model.ground import Flat, Ground, Smooth
from .model.heap import Heap, Profile, Table
from .model.slope_table import SlopeTable
from .value import Number, value


@value
class Scene:
    """A granular mass on a chute: equation (1) with its data.

    All quantities are dimensionless, scaled as by Savage and Hutter (1989).

    Attributes:
        cells: The cells of the x-axis.
        heap: Initial height and velocity; also a function of the cell centres x that gives (h, u).
        chute: The ground, a constant slope (1) or a smooth one (13); sin zeta pulls along it.
        friction: Holds the mass back by at most R.
        boundary: "open", "wall" or "periodic", or a pair (left, right) of "open", "wall" and `Inflow`.
        epsilon: Height over length of the mass, > 0.
        k: Earth pressure coefficient, > 0.
        title: A line for people.
    """

    cells: Cells
    heap: Heap
    chute: Chute = ConstantSlope()
    friction: Friction = Frictionless()
    boundary: Boundary = "open"
    epsilon: Annotated[Number, Field(gt=0)] = 1.0
    k: Annotated[Number, Field(gt=0)] = 1.0
    title: str = ""

    def __post_init__(self) -> None:
        least, most = float(np.min(self.beta)), float(np.max(self.beta))
        if not TINY <= least <= most < math.inf:
            raise InputError(f"beta = epsilon k cos zeta = {least:g} is out of range; change epsilon or k")
        self.initial()

    @property
    def x(self) -> NDArray[np.float64]:
        """Cell centres, shape (nx,)."""
        return self.cells.x

    @cached_property
    def ground(self) -> Ground:
        """What chute and friction are to a scheme."""
        scale, law, dx = self.epsilon * self.k, self.friction, self.cells.dx
        if isinstance(self.chute, ConstantSlope):
            cos = self.chute.cos
            return Flat(self.chute.sin, cos, held_by(law, cos), scale * cos, dx)
        return Smooth.of(self.chute, law, scale, self.cells, self.boundary)

    @property
    def beta(self) -> float | NDArray[np.float64]:
        """beta = epsilon k cos zeta of (1), (13); shape (nx,) on a smooth chute."""
        return self.ground.beta

    @property
    def pull(self) -> float | NDArray[np.float64]:
        """sin zeta; shape (nx,) on a smooth chute."""
        return self.ground.pull

    @property
    def resistance(self) -> float | NDArray[np.float64]:
        """R of Definition 1 of a mass at rest; the force of friction lies in [-R, R]; shape (nx,) on a smooth chute."""
        return self.ground.hold

    @property
    def forced(self) -> bool:
        """Whether anything pulls at the mass or holds it back."""
        return bool(np.any(self.pull) or np.any(self.resistance))

    @property
    def fastest(self) -> float:
        """The fastest particle at the start, max(|u| + c), c = sqrt(2 beta h), streams at the ends included."""
        h, q = self.initial()
        u = mean_velocity(q, h)
        own = float(np.max(np.abs(u) + np.sqrt(2.0 * self.beta * h)))
        widest = float(np.max(self.beta))
        coming = [abs(end.u) + math.sqrt(2.0 * widest * end.h) for end in streams(self.boundary) if end.h > 0.0]
        return max([own, *coming])

    @np.errstate(over="ignore", invalid="ignore")
    def initial(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Initial h and q = h u, the values at the cell centres, each of shape (nx,).

        A height below the smallest normal number, 2.2e-308, is dry.

        Raises:
            InputError: A height is negative, or a value or its momentum flux is not finite (the message names the
                place).
        """
        x = self.cells.x
        h, u = (np.broadcast_to(np.asarray(part, dtype=float), x.shape) for part in self.heap(x))
        for name, bad, remedy in (
            ("height", ~(np.isfinite(h) & (h >= 0)), "heights are finite and at least 0"),
            ("velocity", ~np.isfinite(u), "velocities are finite"),
        ):
            if bad.any():
                i = int(np.flatnonzero(bad)[0])
                raise InputError(f"heap: {name} {(h if name == 'height' else u)[i]:g} at x = {x[i]:g}; {remedy}")
        h = np.where(h < TINY, 0.0, h)  # no velocity can be told from a height with few digits
        q = np.asarray(h * u, dtype=float)
        bad = ~(np.abs(u) * np.abs(q) + self.beta * h * h < math.inf)
        if bad.any():
            i = int(np.flatnonzero(bad)[0])
            raise InputError(
                f"heap: height {h[i]:g} and velocity {u[i]:g} at x = {x[i]:g} have no finite momentum flux"
            )
        return h, q


def self_contained(scene: Scene) -> Scene:
    """The scene, with what it reads from files as values of its own."""
    if isinstance(scene.chute, SmoothChute) and isinstance(scene.chute.zeta, SlopeTable):
        scene = replace(scene, chute=replace(scene.chute, zeta=scene.chute.zeta.points()))
    if not isinstance(scene.heap, Table):
        return scene
    h, u = scene.heap(scene.x)
    return replace(scene, heap=Profile(h, u))
