"""The family of force steps, which hand the impulse J over to the density."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from .derivative import DerivativeCentred, DerivativeUpwind
from .shift import ShiftExact, ShiftLinear, ShiftPFC

Array = NDArray[np.float64]


class Force(Protocol):
    """A force step."""

    @property
    def derivative(self) -> bool:
        """Whether it acts on M^n as in (18), with h^n in the impulse, and not on f as in (23), with h^{n+1}."""

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        """Push rows of f, shape (nx, n), by J/h.

        Args:
            f: Density after transport.
            M: Equilibrium at level n.
            J: Impulse, shape (nx,).
            h: The height that the force acts on, shape (nx,).
            dxi: Width of a velocity cell.
            out: Density after the force, written.
            offset: How far the nodes of each row moved, shape (nx,), written by a room that moves nodes, else 0.

        Returns:
            The mass that left the window, per dx.
        """


ForceName = Literal["shift-linear", "shift-exact", "shift-pfc", "derivative-upwind", "derivative-centred"]

FORCES: dict[ForceName, Force] = {
    "shift-linear": ShiftLinear(),
    "shift-exact": ShiftExact(),
    "shift-pfc": ShiftPFC(),
    "derivative-upwind": DerivativeUpwind(),
    "derivative-centred": DerivativeCentred(),
}
