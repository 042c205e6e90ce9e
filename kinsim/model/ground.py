"""What the chute and its friction are to a scheme: numbers, or numbers per cell and per face."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..arrays import Array
from ..errors import InputError
from .boundary import Boundary, Inflow, ends
from .cells import Cells
from .chute import SmoothChute
from .friction import Friction, held_by
from .slope import angles

MEET = 1e-6
"""Slopes at the ends of a periodic domain may differ by so much, in radians."""


@dataclass(frozen=True)
class Flat:
    """A constant slope.

    Attributes:
        pull: sin zeta.
        cos: cos zeta.
        hold: R of Definition 1, what friction can hold.
        beta: beta of (1).
        dx: Length of a cell.
    """

    pull: float
    cos: float
    hold: float
    beta: float
    dx: float
    bends: ClassVar[bool] = False


@dataclass(frozen=True)
class Smooth:
    """A chute of varying slope; cells have shape (nx,), ghosted ones (nx + 2,), faces (nx + 1,).

    Attributes:
        grip: Friction over normal force, tan delta.
        pull, cos, bend: sin zeta, cos zeta, and eta kappa of cells.
        hold: What friction can hold of resting cells.
        ghosted: beta of ghosted cells; a ghost has that of the cell it shows, or makes that of a stream
            right at its face.
        pull_face, cos_face, beta_face: The same of faces.
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
    cos_face: Array
    beta_face: Array
    bends: bool
    dx: float

    @classmethod
    def of(cls, chute: SmoothChute, law: Friction, scale: float, cells: Cells, boundary: Boundary) -> Smooth:
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
        grip = held_by(law, 1.0)
        return cls(
            grip, np.sin(zeta), cos, -chute.eta * rise, grip * cos, ghosted,
            np.sin(face), np.cos(face), 0.5 * (ghosted[:-1] + ghosted[1:]),
            bool(np.any(chute.eta * rise)), cells.dx,
        )  # fmt: skip

    @property
    def beta(self) -> Array:
        """beta of cells."""
        return self.ghosted[1:-1]


Ground = Flat | Smooth


def flat(ground: Ground) -> Flat:
    """The ground of a scene with a constant slope."""
    assert isinstance(ground, Flat)
    return ground
