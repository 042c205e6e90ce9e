"""The scene: what happens, and nothing about how it is computed."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from .errors import InputError
from .model.boundary import Boundary
from .model.cells import TINY, Cells
from .model.chute import Chute
from .model.friction import Friction, Frictionless
from .model.heap import Heap
from .value import Number, value


@value
class Scene:
    """A granular mass on a chute: equation (1) with its data.

    All quantities are dimensionless, scaled as by Savage and Hutter (1989).

    Attributes:
        cells: The cells of the x-axis.
        heap: Initial height and velocity.
        chute: The ground; sin zeta pulls along it.
        friction: Holds the mass back by at most R.
        boundary: "open", "wall" or "periodic", or a pair (left, right) of the first two.
        epsilon: Height over length of the mass, > 0.
        k: Earth pressure coefficient, > 0.
        title: A line for people.
    """

    cells: Cells
    heap: Heap
    chute: Chute = Chute()
    friction: Friction = Frictionless()
    boundary: Boundary = "open"
    epsilon: Annotated[Number, Field(gt=0)] = 1.0
    k: Annotated[Number, Field(gt=0)] = 1.0
    title: str = ""

    def __post_init__(self) -> None:
        if not TINY <= self.beta < math.inf:
            raise InputError(f"beta = epsilon k cos zeta = {self.beta:g} is out of range; change epsilon or k")
        self.initial()

    @property
    def x(self) -> NDArray[np.float64]:
        """Cell centres, shape (nx,)."""
        return self.cells.x

    @property
    def beta(self) -> float:
        """beta = epsilon k cos zeta of (1)."""
        return self.epsilon * self.k * self.chute.cos

    @property
    def resistance(self) -> float:
        """R of Definition 1; the force of friction lies in [-R, R]."""
        return self.friction.resistance(self.chute)

    @property
    def forced(self) -> bool:
        """Whether anything pulls at the mass or holds it back."""
        return self.chute.sin != 0.0 or self.resistance != 0.0

    @property
    def fastest(self) -> float:
        """The fastest particle at the start, max(|u| + c), c = sqrt(2 beta h)."""
        h, q = self.initial()
        u = np.divide(q, h, out=np.zeros_like(q), where=h > 0)
        return float(np.max(np.abs(u) + np.sqrt(2.0 * self.beta * h)))

    @np.errstate(over="ignore", invalid="ignore")
    def initial(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Initial h and q = h u, the values at the cell centres, each of shape (nx,).

        A height below the smallest normal number, 2.2e-308, is dry.

        Raises:
            InputError: A height is negative, or a value or its momentum flux is not finite (the message names the
                place).
        """
        x = self.cells.x
        h, u = self.heap(x)
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
