"""What the chute and its friction are to a scheme: numbers, or numbers per cell and per face.

At faces of a smooth chute, where cells i and i + 1 meet, the pressure of (13) has the slope

    D = (beta_f (h_{i+1} - h_i) + (beta_{i+1} - beta_i) (h_i + h_{i+1})/4)/dx,   beta_f = (beta_i + beta_{i+1})/2,

of second order for beta h_x + beta' h/2; so that what friction balances, |sin zeta - D| <= R, is a jump of heights
between (+-R + sin zeta) dx/beta_f - tilt (h_i + h_{i+1}) with tilt = (beta_{i+1} - beta_i)/(4 beta_f).

Resting cells send the same mass to both sides of their face where h_i = r h_{i+1}, r = (beta_{i+1}/beta_i)^(1/3), for a
half of M carries (2 beta h)^(3/2)/(3 pi beta).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..local import Local, Sides
from .boundary import Boundary, Inflow, ends
from .cells import Cells
from .chute import Incline, SmoothChute
from .friction import FrictionLaw
from .slope import angles

Array = NDArray[np.float64]

MEET = 1e-6
"""Slopes at the ends of a periodic domain may differ by so much, in radians."""


OfFaces = tuple[Local, Local, Local, Array | None, float]
"""sin zeta, R, beta, tilt (None on a constant slope) and dx."""

OfCells = tuple[Local, Local, Local, float]
"""sin zeta, R, beta and dx."""


class Shown(NamedTuple):
    """beta of what ghosted cells show to their left wall (`minus`) and to their right wall (`plus`)."""

    minus: Local
    plus: Local

    @property
    def faces(self) -> Sides:
        """beta on both sides of each face."""
        if isinstance(self.plus, np.ndarray) and isinstance(self.minus, np.ndarray):
            return self.plus[:-1], self.minus[1:]
        return self.plus


@dataclass(frozen=True)
class Flat:
    """A constant slope.

    Attributes:
        pull: sin zeta.
        hold: R of Definition 1, what friction can hold.
        beta: beta of (1).
        dx: Length of a cell.
    """

    pull: float
    hold: float
    beta: float
    dx: float

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """sin zeta, R, beta and dx."""
        return self.pull, self.hold, self.beta, self.dx

    @property
    def faces(self) -> OfFaces:
        """sin zeta, R, beta, tilt and dx of faces."""
        return self.pull, self.hold, self.beta, None, self.dx

    def cells(self, u: Array, dt: float) -> OfCells:
        """sin zeta, the most friction that a step of dt can bring to bear at velocities u, beta and dx of cells."""
        return self.pull, self.hold, self.beta, self.dx

    def shown(self, sloped: bool) -> Shown:
        """beta of what cells show."""
        return Shown(self.beta, self.beta)

    def uneven(self, sloped: bool) -> None:
        """r - 1 is 0 everywhere."""

    def part(self, low: int, high: int) -> Flat:
        """The same of the cells from `low` to below `high`."""
        return self


@dataclass(frozen=True)
class Smooth:
    """A chute of varying slope; cells have shape (nx,), ghosted ones (nx + 2,), faces (nx + 1,).

    Attributes:
        grip: Friction over normal force, tan delta.
        pull, cos, bend: sin zeta, cos zeta, and eta kappa of cells.
        hold: What friction can hold of resting cells.
        ghosted: beta of ghosted cells; a ghost has that of the cell it shows, or makes that of a stream
            right at its face.
        pull_face, hold_face, beta_face: The same of faces.
        most: Room for the most friction of a step.
        bends: Whether there is friction of the bend.
        dx: Length of a cell.
    """

    grip: float
    pull: Array
    cos: Array
    bend: Array
    hold: Array
    ghosted: Array
    pull_face: Array
    hold_face: Array
    beta_face: Array
    most: Array
    bends: bool
    dx: float

    @classmethod
    def of(cls, chute: SmoothChute, law: FrictionLaw, scale: float, cells: Cells, boundary: Boundary) -> Smooth:
        """The ground of `chute` with beta = scale cos zeta.

        Raises:
            InputError: It is too steep, or its ends do not meet in a periodic domain.
        """
        face, _ = angles(chute.zeta, cells.faces)
        zeta, rise = angles(chute.zeta, cells.x)
        wraps = boundary == "periodic"
        if wraps and abs(face[0] - face[-1]) > MEET:
            raise InputError(
                f"chute: zeta is {face[0]:.6g} at the left end and {face[-1]:.6g} at the right one, which meet in a "
                "periodic domain; give a periodic zeta, or another boundary"
            )
        if wraps:
            face[-1] = face[0]
        cos = np.cos(zeta)
        ghosted = np.pad(scale * cos, 1, mode="wrap" if wraps else "edge")
        for at, end in zip((0, -1), ends(boundary), strict=True):
            if isinstance(end, Inflow):
                ghosted[at] = max(2.0 * scale * math.cos(face[at]) - ghosted[at], 0.0)
        grip = float(law.resistance(Incline(1.0)))
        return cls(
            grip, np.sin(zeta), cos, -chute.eta * rise, grip * cos, ghosted,
            np.sin(face), grip * np.cos(face), 0.5 * (ghosted[:-1] + ghosted[1:]),
            np.zeros_like(cos), bool(np.any(chute.eta * rise)), cells.dx,
        )  # fmt: skip

    @property
    def beta(self) -> Array:
        """beta of cells."""
        return self.ghosted[1:-1]

    @property
    def faces(self) -> OfFaces:
        """sin zeta, R, beta, tilt and dx of faces."""
        tilt = np.diff(self.ghosted) / (4.0 * self.beta_face)
        return self.pull_face, self.hold_face, self.beta_face, tilt, self.dx

    def cells(self, u: Array, dt: float) -> OfCells:
        """sin zeta, the most friction that a step of dt can bring to bear at velocities u, beta and dx of cells.

        The normal force is cos zeta + eta kappa u^2, and 0 where it would be negative. Where the bend presses, it takes
        the share a = dt tan(delta) eta kappa |u| of the momentum. Where a > 1/10 it leaves 0.81/(a + 0.8) of it, which
        goes on from 1 - a without a kink and is near the 1/(1 + a) of u' = -tan(delta) eta kappa u^2 at any a.
        """
        if not self.bends:
            return self.pull, self.hold, self.beta, self.dx
        from ..balance.brake import brake  # scenes are made without numba

        brake(u, dt, self.grip, self.cos, self.bend, self.most)
        return self.pull, self.most, self.beta, self.dx

    def shown(self, sloped: bool) -> Shown:
        """beta of what cells show: in first order that of the cell, in second order that of the face."""
        if not sloped:
            return Shown(self.ghosted, self.ghosted)
        ends = self.ghosted[[0, -1]]
        return Shown(np.append(ends[0], self.beta_face), np.append(self.beta_face, ends[1]))

    def uneven(self, sloped: bool) -> tuple[Array, Array] | None:
        """r - 1 and 1/r - 1 of faces; 0 where both sides show the beta of the face."""
        if sloped:
            return None
        left, right = self.ghosted[:-1], self.ghosted[1:]
        return np.cbrt(right / left) - 1.0, np.cbrt(left / right) - 1.0

    def part(self, low: int, high: int) -> Smooth:
        """The same of the cells from `low` to below `high`."""
        here, around, faces = slice(low, high), slice(low, high + 2), slice(low, high + 1)
        return replace(
            self, pull=self.pull[here], cos=self.cos[here], bend=self.bend[here], hold=self.hold[here],
            ghosted=self.ghosted[around], pull_face=self.pull_face[faces], hold_face=self.hold_face[faces],
            beta_face=self.beta_face[faces], most=self.most[here].copy(),
        )  # fmt: skip


Ground = Flat | Smooth
