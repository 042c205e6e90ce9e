"""Densities at held faces: what stands there is made in packed rows, so that others cost nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..balance.stages import Array, Stages
from ..kernel import kernel
from ..local import Sides
from .equilibrium import Status

Flags = NDArray[np.bool_]
Places = NDArray[np.int64]


class HeldFaces:
    """The held faces of a step, packed: their places, their states and beta, and how their equilibrium fared.

    Attributes:
        where: Which faces are held, the first `count` entries.
        count: How many are.
    """

    def __init__(self, faces: int, beta: Sides) -> None:
        self.where = np.zeros(faces, dtype=np.int64)
        self.count = 0
        self._beta = beta
        self._packed = np.zeros((6, faces))
        self._status = Status.empty(faces)

    def pack(self, now: Stages) -> None:
        """Find the held faces of a step, and their states."""
        at, beta, packed = now.balanced, self._beta, self._packed
        self.count = pack(now.held, self.where)
        sides = beta if isinstance(beta, tuple) else ()
        for row, values in zip(packed, (at.h_left, at.u_left, at.h_right, at.u_right, *sides), strict=False):
            take(values, self.where, self.count, row)

    @property
    def states(self) -> tuple[Array, Array, Array, Array]:
        """Left and right states, each of shape (count,)."""
        h_left, u_left, h_right, u_right = self._packed[:4, : self.count]
        return h_left, u_left, h_right, u_right

    @property
    def beta(self) -> Sides:
        """beta on both sides of them."""
        if not isinstance(self._beta, tuple):
            return self._beta
        left, right = self._packed[4:, : self.count]
        return left, right

    @property
    def status(self) -> Status:
        """How the equilibrium fared in each of them."""
        reports = vars(self._status).values()
        return Status(*(report[: self.count] for report in reports))


@kernel
def pack(held: Flags, where: Places) -> int:
    """Write the places of what is held; returns their number."""
    count = 0
    for i in range(held.size):
        if held[i]:
            where[count] = i
            count += 1
    return count


@kernel
def take(values: Array, where: Places, count: int, packed: Array) -> None:
    """packed = values[where] for the first `count` places."""
    for k in range(count):
        packed[k] = values[where[k]]


@kernel
def put_capped(rows: Array, where: Places, M: Array, share: float, B: Array) -> None:
    """Rows of B at the places `where`: no face sends more than `share` times what stands before it in M, ghosted."""
    n = B.shape[1]
    half = n // 2
    for k in range(rows.shape[0]):
        face = where[k]
        for j in range(half):
            rows[k, j] = min(rows[k, j], share * M[face + 1, j])
            B[face, j] = rows[k, j]
        for j in range(half, n):
            rows[k, j] = min(rows[k, j], share * M[face, j])
            B[face, j] = rows[k, j]


@kernel
def put_flux(sums: Array, where: Places, count: int, F1: Array, F2: Array) -> None:
    """The fluxes of the faces `where` from their half-range sums, shape (4, faces)."""
    for k in range(count):
        F1[where[k]] = sums[0, k] + sums[2, k]
        F2[where[k]] = sums[1, k] + sums[3, k]
