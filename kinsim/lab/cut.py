"""A cut through the density at one cell, and what passes the face on its right: half-range moments, judged."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .. import printed
from ..arrays import Array
from ..film.reel import equilibrium
from ..kinetic.equilibrium import weights
from ..kinetic.velocity import Grid
from ..macroscopic.closed_form import half_moments_closed
from ..method import Kinetic
from ..solver.step import step
from .play import Moment, Play

FaceStates = Literal["upwind", "balanced", "held"]

FACES: dict[FaceStates, str] = {
    "upwind": "upwind face (19)", "balanced": "balanced face (25)", "held": "held face of scheme 4"
}  # fmt: skip

LINE = 241
"""Points of the curve of M."""


@dataclass(frozen=True, eq=False)
class Half:
    """The first or second moment of one side of xi = 0 at a face.

    Attributes:
        name: As in the paper, "I1" to "I4".
        told: What is integrated.
        summed: Over the velocity cells that are shaded.
        closed: In closed form.
        bound: Of the difference of these two, or not-a-number where none is proved.
        printed: What the paper's formula gives as it is printed.
    """

    name: str
    told: str
    summed: float
    closed: float
    bound: float
    printed: float

    @property
    def misprinted(self) -> bool:
        """Whether the printed formula is off by more than rounding."""
        return abs(self.printed - self.closed) > 1e-12 * max(abs(self.closed), abs(self.printed))


@dataclass(frozen=True, eq=False)
class Cut:
    """f and M over xi in one cell, and the density at its right face.

    Attributes:
        cell, x: Which cell, and its centre.
        edges: Of the velocity cells of f, shape (n + 1,).
        f: Shape (n,).
        xi, M: The curve of the equilibrium with the mass and the momentum of f.
        face_x: Where the face is.
        face_edges, face: The density at the face, xi > 0 from the left and xi < 0 from the right, and its cells.
        halves: I1 to I4.
    """

    cell: int
    x: float
    edges: Array
    f: Array
    xi: Array
    M: Array
    face_x: float
    face_edges: Array
    face: Array
    halves: tuple[Half, ...]


def faces_of(method: Kinetic) -> tuple[FaceStates, ...]:
    """Whose half-ranges can be looked at; those that the scheme itself sums up, or mostly does, come first."""
    if method.scheme == 4 and method.order == 1 and method.statics == "hold":
        return "held", "upwind", "balanced"
    return ("balanced", "upwind") if method.scheme == 2 else ("upwind", "balanced")


def cut_at(play: Play, moment: Moment, cell: int, states: FaceStates = "upwind") -> Cut:
    """The cut through `moment` at `cell`; the last cell shows the face on its left."""
    scene, grid = play.scene, play.density.grid
    cell = min(max(cell, 0), scene.cells.count - 1)
    left = min(cell, scene.cells.count - 2)
    h, u = _face_states(play, moment, left, states)
    beta = np.broadcast_to(scene.beta, scene.cells.count)[left : left + 2]
    sides = (beta[:1].copy(), beta[1:].copy())
    rows = play.face_rows(h[:1], u[:1], h[1:], u[1:], sides)
    edges: Array = grid.dxi * (np.arange(grid.count + 1.0) - grid.half)
    curve = np.linspace(edges[0], edges[-1], LINE)
    here, mean = moment.h[cell : cell + 1], np.nan_to_num(moment.u[cell : cell + 1])
    M = equilibrium(here, mean, float(np.broadcast_to(scene.beta, scene.cells.count)[cell]), curve)[0]
    return Cut(
        cell=cell, x=float(scene.x[cell]), edges=edges + moment.offset[cell], f=moment.f[cell], xi=curve,
        M=M, face_x=scene.cells.left + (left + 1) * scene.cells.dx,
        face_edges=edges, face=rows[0], halves=_halves(play, rows[0], grid, h, u, beta, states),
    )  # fmt: skip


def _face_states(play: Play, moment: Moment, left: int, states: FaceStates) -> tuple[Array, Array]:
    """Heights and velocities on both sides of the right wall of cell `left`."""
    h, u = moment.face_h[left : left + 2], moment.face_u[left : left + 2]
    if states == "balanced":
        return np.full(2, 0.5 * (h[0] + h[1])), u
    if states == "held":  # what is held depends on no time step
        shown = step(play.scene, play.method.twin, moment.face_h, moment.face_h * moment.face_u, play.scene.cells.dx)
        assert shown.states is not None
        return np.array([of[left + 1] for of in (shown.states.h_left, shown.states.h_right)]), u
    return h, u


def _halves(
    play: Play, row: Array, grid: Grid, h: Array, u: Array, beta: Array, states: FaceStates
) -> tuple[Half, ...]:
    w1, w2 = weights(play.method.equilibrium, grid)
    positive, negative = row[grid.half :], row[: grid.half][::-1]
    summed = (w1 @ positive, -(w1 @ negative), w2 @ positive, w2 @ negative)
    left, right = (half_moments_closed(float(h[k]), float(u[k]), float(beta[k])) for k in (0, 1))
    closed = (left[0], right[2], left[1], right[3])
    as_printed = _printed(h, u, beta, states)
    name = "Ĩ" if states == "balanced" else "I"
    told = ("ξ M, ξ > 0", "ξ M, ξ < 0", "ξ² M, ξ > 0", "ξ² M, ξ < 0")
    averaged = play.method.equilibrium == "cell-average"
    halves = []
    for k in range(4):
        side = k % 2
        state = float(h[side]), float(u[side]), float(beta[side])
        bound = error_bound(k >= 2, *state, grid.dxi) if averaged else math.nan
        halves.append(Half(f"{name}{k + 1}", told[k], float(summed[k]), float(closed[k]), bound, as_printed[k]))
    return tuple(halves)


def error_bound(second: bool, h: float, u: float, beta: float, dxi: float) -> float:
    """How far a half-range sum over exact cell averages of M can be from the integral.

    In a velocity cell let M vary by V; with s = xi - xi_j the integral of s (M - mean) is at most V dxi^2/8, and M
    rises once to c/(pi beta) and falls once, c = sqrt(2 beta h), so that all V add up to 2 c/(pi beta). Where xi weighs
    that is all; where xi^2 = xi_j^2 + 2 xi_j s + s^2 does, it comes times 2 (|u| + c + dxi/2), and s^2 <= dxi^2/4 and
    the weight's dxi^2/12 add at most h dxi^2/3. Rounding adds a few parts in 10^16 of the sums for each velocity cell.
    """
    c = math.sqrt(2.0 * beta * max(h, 0.0))
    fastest = abs(u) + c + dxi
    cells = fastest / dxi + 1.0
    first = dxi * dxi * c / (4.0 * math.pi * beta)
    if not second:
        return first + 4.0 * cells * 2.3e-16 * h * fastest
    return 2.0 * fastest * first + h * dxi * dxi / 3.0 + 4.0 * cells * 2.3e-16 * h * fastest * fastest


def _printed(h: Array, u: Array, beta: Array, states: FaceStates) -> tuple[float, float, float, float]:
    """The four formulas of section 3.2 as they are printed."""
    (h0, h1), (u0, u1), (b0, b1) = h.tolist(), u.tolist(), beta.tolist()
    first: tuple[Callable[..., float], ...] = (printed.I1, printed.I2, printed.I3, printed.I4)
    if states == "balanced":
        first = (printed.I1_tilde, printed.I2_tilde, printed.I3_tilde, printed.I4_tilde)
    beyond = {} if states == "balanced" else {"u_left": u0}
    return (
        first[0](h0, u0, b0) if h0 > 0.0 else 0.0,
        first[1](h1, u1, b1) if h1 > 0.0 else 0.0,
        first[2](h0, u0, b0) if h0 > 0.0 else 0.0,
        first[3](h1, u1, b1, **beyond) if h1 > 0.0 else 0.0,
    )
