"""Face states: what stands left and right of each face.

Face i is the left wall of cell i; faces and ghosted cells are numbered so that cells i and i + 1 of a ghosted array
(shape (nx + 2,)) meet at face i (shape (nx + 1,)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Faces:
    """Heights and velocities left and right of each face, each of shape (nx + 1,)."""

    h_left: Array
    u_left: Array
    h_right: Array
    u_right: Array

    @classmethod
    def empty(cls, nx: int) -> Faces:
        """Uninitialised face states for `nx` cells."""
        return cls(*(np.empty(nx + 1) for _ in range(4)))


def upwind(plus: tuple[Array, Array], minus: tuple[Array, Array]) -> Faces:
    """(19): each side of a face is what the cell on that side shows, (h, u) ghosted; views, nothing is copied."""
    return Faces(plus[0][:-1], plus[1][:-1], minus[0][1:], minus[1][1:])


@kernel
def balanced(h: Array, u: Array, h_left: Array, u_left: Array, h_right: Array, u_right: Array) -> None:
    """(25): the mean height on both sides of a face; only the velocity is upwinded."""
    for i in range(h_left.size):
        mean = 0.5 * (h[i] + h[i + 1])
        h_left[i] = mean
        h_right[i] = mean
        u_left[i] = u[i]
        u_right[i] = u[i + 1]
