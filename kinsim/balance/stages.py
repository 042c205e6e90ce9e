"""The arrays of one step that both wings share, from U^n to U^{n+1}."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner, kernel_part
from ..local import Local, at
from ..model.boundary import extend
from ..model.ground import Shown
from ..scene import Scene
from .interface import Faces, upwind

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Stages:
    """What one step hands from line to line; ghosted arrays have shape (nx + 2,), faces (nx + 1,), cells (nx,).

    Attributes:
        h, u: Height and velocity at level n, ghosted.
        q: Momentum at level n, cells.
        minus, plus: What a cell shows to its left and to its right wall, (h, u), ghosted; views of h and u unless the
            scheme has slopes.
        upwind: Face states (19), views of `plus` and `minus`.
        balanced: Face states (25), or the held ones of scheme 4.
        F1, F2: Flux of the upwind states, faces; in scheme 4 the one flux.
        B1, B2: Flux of the balanced states, faces; with reflection the flux seen from the right of a face.
        e, theta: The jump of height that friction can balance, and the share of it that is held, faces.
        held, still, static: Faces that hold something back, that are at rest, that reflect.
        leftover: Friction that a face has to spare, faces.
        low, high: The slowest and the fastest particle, ghosted; inf and -inf where it is dry.
        h1_candidate: h^{n+1} as the balanced flux would give it, cells.
        slow: Cells that take the first branch of schemes 2 and 3, ghosted.
        at_left, at_right: Whether a cell takes the balanced flux at its left and right wall, cells.
        h1: h^{n+1}, cells.
        qhat: Momentum after transport, before the impulse, cells.
        J: Impulse of gravity and friction, cells.
        q1: q^{n+1}, cells.
    """

    h: Array
    u: Array
    q: Array
    minus: tuple[Array, Array]
    plus: tuple[Array, Array]
    upwind: Faces
    balanced: Faces
    F1: Array
    F2: Array
    B1: Array
    B2: Array
    e: Array
    theta: Array
    leftover: Array
    held: Flags
    still: Flags
    static: Flags
    low: Array
    high: Array
    h1_candidate: Array
    slow: Flags
    at_left: Flags
    at_right: Flags
    h1: Array
    qhat: Array
    J: Array
    q1: Array

    @classmethod
    def empty(cls, nx: int, sloped: bool = False) -> Stages:
        """Room for a step of `nx` cells; `sloped` if cells show other states at their walls than their own."""
        h, u = np.zeros(nx + 2), np.zeros(nx + 2)
        minus = plus = (h, u)
        if sloped:
            minus, plus = ((np.zeros(nx + 2), np.zeros(nx + 2)) for _ in range(2))
        cells = {name: np.zeros(nx) for name in ("q", "h1_candidate", "h1", "qhat", "J", "q1")}
        faces = {name: np.zeros(nx + 1) for name in ("F1", "F2", "B1", "B2", "e", "theta", "leftover")}
        held, still, static = (np.zeros(nx + 1, dtype=bool) for _ in range(3))
        return cls(
            h=h, u=u, minus=minus, plus=plus, upwind=upwind(plus, minus),
            balanced=Faces.empty(nx), low=np.zeros(nx + 2), high=np.zeros(nx + 2), slow=np.zeros(nx + 2, dtype=bool),
            at_left=np.zeros(nx, dtype=bool), at_right=np.zeros(nx, dtype=bool), held=held, still=still, static=static,
            **cells, **faces,
        )  # fmt: skip

    def begin(self, scene: Scene, h: Array, q: Array) -> None:
        """Take over U^n = (h, q) and fill the ghosts; dry cells are at rest."""
        self.q[:] = q
        split(h, q, self.h, self.u)
        extend(scene.boundary, self.h, self.u)


@kernel_part
def velocity(h: float, q: float) -> float:
    """u = q/h where there is mass, 0 where there is none."""
    return q / h if h > 0.0 else 0.0


@kernel
def split(h: Array, q: Array, h_ghosted: Array, u_ghosted: Array) -> None:
    """h and u = q/h into the inner cells of ghosted arrays."""
    for i in range(h.size):
        h_ghosted[i + 1] = h[i]
        u_ghosted[i + 1] = velocity(h[i], q[i])


def reach(now: Stages, beta: Shown, balanced: bool) -> float:
    """max(|u| + c) over all that the cells show, and with `balanced` over the face states (25)."""
    shown: float = fastest(*now.plus, beta.plus, balanced, TOP)
    return shown if now.minus is now.plus else max(shown, fastest(*now.minus, beta.minus, False, TOP))


@kernel
def support(h: Array, u: Array, beta: Local, low: Array, high: Array) -> None:
    """The slowest and the fastest particle u -+ c of each cell, inf and -inf where it is dry."""
    for i in range(h.size):
        c = np.sqrt(2.0 * at(beta, i) * h[i])
        low[i] = u[i] - c if h[i] > 0.0 else np.inf
        high[i] = u[i] + c if h[i] > 0.0 else -np.inf


LANES = 256
"""Cells whose extremes are kept side by side: one running extreme would wait for itself."""


TOP = np.empty(LANES)
"""What `fastest` works in; kernels hold the interpreter's lock, so that one room serves all threads."""


@kernel
def fastest(h: Array, u: Array, beta: Local, faces: bool, room: Array) -> float:
    """max(|u| + sqrt(2 beta h)) over cells with mass and, with `faces`, over face states (25); h, u are ghosted."""
    room[:] = 0.0
    quicken(h, u, beta, room)
    top = largest(room)
    if faces:
        for i in range(1, h.size):
            mean = max(0.5 * (h[i - 1] + h[i]), 0.0)
            top = max(top, max(abs(u[i - 1]), abs(u[i])) + np.sqrt(2.0 * at(beta, i) * mean))
    return top


@kernel_part
def speed(h: float, u: float, beta: float) -> float:
    """|u| + sqrt(2 beta h) where there is mass, else 0."""
    quickest = abs(u) + np.sqrt(2.0 * beta * max(h, 0.0))
    return quickest if h > 0.0 else 0.0


@kernel_inner
def quicken(h: Array, u: Array, beta: Local, room: Array) -> None:
    """Raise the speeds kept side by side in `room` to those of the cells with mass."""
    for begin in range(0, h.size, room.size):
        first, last = np.uint64(begin), np.uint64(min(begin + room.size, h.size))
        for i in range(first, last):
            k = i - first
            room[k] = max(room[k], speed(h[i], u[i], at(beta, i)))


@kernel_part
def largest(top: Array) -> float:
    """The largest entry."""
    most: float = top[0]
    for k in range(top.size):
        most = max(most, top[k])
    return most
