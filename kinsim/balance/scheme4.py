"""Scheme 4: conservative, positive, at rest and on dry ground, of first or second order.

Static friction acts at faces, on the density that would cross them, and in cells, as one clamped impulse. Two rooms say
what it does at a face: it holds back a part of the density (`Held`), or it turns particles round (`Reflecting`).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..model.boundary import ends, extend_shown
from ..scene import Scene
from .clamp import clamped, clip_velocity
from .hold import find_still, hold_back, judge_faces, rest_flux
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

    def prepare(self, scene: Scene, now: Stages, fastest: float) -> None:
        """Judge the faces: e and theta; a wall is judged as the face next to it."""
        s, R, beta, dx = scene.chute.sin, scene.resistance, scene.beta, scene.cells.dx
        judge_faces(now.h, now.u, s, R, beta, dx, now.e, now.theta)
        find_still(now.h, now.u, now.e, now.theta, now.still)
        for at, inner in _walls(scene):
            now.e[at], now.theta[at], now.still[at] = now.e[inner], now.theta[inner], now.still[inner]

    def fluxes(self, scene: Scene, now: Stages, wing: Wing, dt: float) -> Walls:
        to, shown = now.balanced, now.upwind
        hold_back(
            *now.plus, *now.minus, now.e, now.theta, now.still, to.h_left, to.u_left, to.h_right, to.u_right, now.held
        )
        for at, _ in _walls(scene):  # both sides alike, so that nothing passes
            inside, ghost, of = (
                (to.h_right, to.h_left, shown.h_right) if at == 0 else (to.h_left, to.h_right, shown.h_left)
            )
            ghost[at] = inside[at]
            now.held[at] = inside[at] != of[at]
        wing.support(now)
        wing.held_flux(now)
        rest_flux(to.h_left, now.still, scene.beta, now.F1, now.F2)
        return Walls.of(now.F1, now.F2)

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        s, R, beta, dx = scene.chute.sin, scene.resistance, scene.beta, scene.cells.dx
        clip_velocity(now.low, now.high, now.h1, now.qhat)
        h = now.h.copy()
        for at, _ in _walls(scene):  # a wall bears what stands before it as a heap of the same slope would
            h[at] = max(h[1] - now.e[0] if at == 0 else h[-2] + now.e[-1], 0.0)
        clamped(h, now.h1, now.qhat, pulled, now.theta, now.still, s, R, beta, dx, dt, now.J)


class HeldSloped(Held):
    """The same with limited slopes of h and u in the cells: a stage of the scheme of second order."""

    sloped = True

    def __init__(self, limiter: Limiter) -> None:
        self._steepest = STEEPEST[limiter]

    def prepare(self, scene: Scene, now: Stages, fastest: float) -> None:
        """Judge the faces, and show slopes to them where they are not held."""
        super().prepare(scene, now, fastest)
        reconstruct(now.h, now.u, now.theta, self._steepest, scene.beta, fastest, *now.minus, *now.plus)
        extend_shown(scene.boundary, now.minus, now.plus)

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        """The impulse of a stage acts on h^n, at least half and at most twice h^{n+1}."""
        super().impulse(scene, now, np.clip(now.h[1:-1], 0.5 * now.h1, 2.0 * now.h1), dt)


class Reflecting:
    """Faces that friction can hold turn particles round; conservative in mass, positive, rests."""

    uses_balanced = has_faces = sloped = False

    def prepare(self, scene: Scene, now: Stages, fastest: float) -> None:
        pass

    def fluxes(self, scene: Scene, now: Stages, wing: Wing, dt: float) -> Walls:
        s, R, beta, dx = scene.chute.sin, scene.resistance, scene.beta, scene.cells.dx
        find_static(now.h, now.u, s, R, beta, dx, dt, now.leftover, now.static)
        for at, inner in _walls(scene):
            now.leftover[at], now.static[at] = now.leftover[inner], now.static[inner]
        wing.support(now)
        half = wing.half_moments(now)
        reflected(half[:2], half[2:], now.static, now.F1, now.F2, now.B2)
        return Walls(now.F1[:-1], now.B2[:-1], now.F1[1:], now.F2[1:])

    def impulse(self, scene: Scene, now: Stages, pulled: Array, dt: float) -> None:
        s, R = scene.chute.sin, scene.resistance
        clip_velocity(now.low, now.high, now.h1, now.qhat)
        stopped(pulled, now.qhat, now.leftover, now.static, s, R, dt, now.J)


def _walls(scene: Scene) -> list[tuple[int, int]]:
    """Which end faces are walls, each with the face next to it, as which it is judged."""
    next_to = ((0, 1), (-1, -2)) if scene.cells.count > 1 else ((0, 0), (-1, -1))
    return [faces for kind, faces in zip(ends(scene.boundary), next_to, strict=True) if kind == "wall"]
