"""Scheme 4: conservative, positive, at rest and on dry ground, of first or second order.

Static friction acts at faces, on the density that would cross them, and in cells, as one clamped impulse. Two rooms say
what it does at a face: it holds back a part of the density (`Held`), or it turns particles round (`Reflecting`).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..model.boundary import ends, extend_shown
from ..model.ground import OfCells, OfFaces
from ..scene import Scene
from .clamp import below_nothing, clamped, clip_velocity, within
from .hold import hold_back, judge_faces, rest_flux
from .reflect import find_static, reflected, stopped
from .slopes import reconstruct
from .stages import Array, Stages
from .update import Walls
from .wing import Wing

Limiter = Literal["minmod", "between", "mc"]

STEEPEST: dict[Limiter, float] = {"minmod": 1.0, "between": 1.2, "mc": 2.0}
"""How many times the smaller one of two differences a slope may be; see `balance.slopes`."""


class Held:
    """Faces hold back what friction can balance, cells are stopped by a clamp; conservative, positive, rests."""

    uses_balanced = sloped = False
    has_faces = True

    def __init__(self, scene: Scene) -> None:
        self._boundary = scene.boundary
        self._ground = scene.ground
        self._faces: OfFaces = scene.ground.faces
        self._beta, self._uneven = scene.ground.shown(self.sloped).faces, scene.ground.uneven(self.sloped)
        left, right = ends(scene.boundary)
        self._walls = (left == "wall", right == "wall")

    def prepare(self, now: Stages, fastest: float) -> None:
        judge_faces(now.h, now.u, *self._faces, *self._walls, now.e, now.theta, now.still)

    def fluxes(self, now: Stages, wing: Wing, dt: float) -> Walls:
        to = now.balanced
        states = (to.h_left, to.u_left, to.h_right, to.u_right)
        hold_back(*now.plus, *now.minus, now.e, now.theta, now.still, self._uneven, *self._walls, *states, now.held)
        wing.support(now)
        wing.held_flux(now)
        rest_flux(to.h_left, to.h_right, now.still, self._beta, now.F1, now.F2)
        return Walls.of(now.F1, now.F2)

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        mended = below_nothing(now.h1)
        clip_velocity(now.low, now.high, now.h1, now.qhat)
        ground: OfCells = self._ground.cells(now.u[1:-1], dt)
        clamped(now.h, now.h1, now.qhat, pulled, now.e, now.theta, now.still, *ground, dt, *self._walls, now.J)
        return mended


class HeldSloped(Held):
    """The same with limited slopes of h and u in the cells: a stage of the scheme of second order."""

    sloped = True

    def __init__(self, scene: Scene, limiter: Limiter) -> None:
        super().__init__(scene)
        self._steepest = STEEPEST[limiter]
        self._pulled = np.zeros(scene.cells.count)

    def prepare(self, now: Stages, fastest: float) -> None:
        super().prepare(now, fastest)
        beta = self._faces[2]
        reconstruct(now.h, now.u, now.theta, self._steepest, beta, fastest, *now.minus, *now.plus)
        extend_shown(self._boundary, now.minus, now.plus)

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        """The impulse of a stage acts on h^n, at least half and at most twice h^{n+1}."""
        within(now.h[1:-1], now.h1, self._pulled)
        return super().impulse(now, self._pulled, dt)


class Reflecting(Held):
    """Faces that friction can hold turn particles round; conservative in mass, positive, rests."""

    has_faces = False

    def prepare(self, now: Stages, fastest: float) -> None:
        pass

    def fluxes(self, now: Stages, wing: Wing, dt: float) -> Walls:
        find_static(now.h, now.u, *self._faces, dt, *self._walls, now.leftover, now.static)
        wing.support(now)
        half = wing.half_moments(now)
        reflected(half[:2], half[2:], now.static, now.F1, now.F2, now.B2)
        return Walls(now.F1[:-1], now.B2[:-1], now.F1[1:], now.F2[1:])

    def impulse(self, now: Stages, pulled: Array, dt: float) -> float:
        s, R, _, _ = self._ground.cells(now.u[1:-1], dt)
        mended = below_nothing(now.h1)
        clip_velocity(now.low, now.high, now.h1, now.qhat)
        stopped(pulled, now.qhat, now.leftover, now.static, s, R, dt, now.J)
        return mended
