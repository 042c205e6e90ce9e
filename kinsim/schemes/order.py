"""First and second order: what cells show to their walls."""

from __future__ import annotations

from typing import NamedTuple

from .bed import LEAST, beta_jump, beta_of, face, normal, pull
from .formulas import DRY, clamp, limited, weight
from .friction import brought_midway, grip, resistance
from .questions import rows
from .tile import FRICTION, HM, HP, RING, STREAM, THETA, UM, UP, WALL, E, H, U


class First(NamedTuple):
    """Cells show what they are."""


class Second(NamedTuple):
    """Cells show limited slopes of h and u, half a step later; one stage (Hancock's predictor in h and u).

    Slopes are `steepest` times the smaller difference at most, and 0 where a face of the cell is held wholly. The
    velocities u -+ (h_+-/h) s_u/2 give the two halves of the cell, of h_- and h_+, its momentum together.
    """

    steepest: float

    def rows(order):
        return HP, UP, HM, UM

    def is_sloped(order):
        return True

    def show(order, ground, dt, place, room):
        n, bed, law, lam, begin = place.n, ground.bed, ground.law, dt / ground.dx, place.begin
        for k in range(-1, n + 1):
            rise = limited(room[H + k] - room[H + k - 1], room[H + k + 1] - room[H + k], order.steepest)
            room[HP + k] = 0.5 * (1.0 - max(room[THETA + k - 1], room[THETA + k])) * rise
        for k in range(-1, n + 1):
            before = weight(room[H + k - 1], room[H + k]) * (room[U + k] - room[U + k - 1])
            after = weight(room[H + k + 1], room[H + k]) * (room[U + k + 1] - room[U + k])
            turn = limited(before, after, order.steepest)
            room[UP + k] = 0.5 * (1.0 - max(room[THETA + k - 1], room[THETA + k])) * turn
        grip_dt = 0.5 * dt * grip(law)
        for k in range(-1, n + 1):
            above = normal(bed, begin + k, room[U + k], grip_dt)
            room[FRICTION + k] = resistance(law, max(room[H + k], LEAST), abs(room[U + k]), above)
        for k in range(-1, n + 1):
            i, h, u = begin + k, room[H + k], room[U + k]
            free = 1.0 - max(room[THETA + k - 1], room[THETA + k])
            low, high = max(h - room[HP + k], 0.0), max(h + room[HP + k], 0.0)
            per = max(h, DRY)
            slow, fast = u - high / per * room[UP + k], u + low / per * room[UP + k]
            a = -0.5 * lam * (high * fast - low * slow)  # h_t = -(h u)_x
            steep = beta_of(bed, i) * (high - low) + free * (0.5 * (beta_jump(bed, i) * h))
            b = -0.5 * lam * (u * (fast - slow) + steep)  # u_t = -u u_x - beta h_x + g
            s, R = pull(bed, i), room[FRICTION + k]
            b += free * clamp(-(u + b), 0.5 * dt * (s - R), 0.5 * dt * (s + R))
            room[HM + k], room[UM + k] = max(low + a, 0.0), slow + b
            room[HP + k], room[UP + k] = max(high + a, 0.0), fast + b
        if place.first and ground.left.kind != RING:  # a ghost shows what stands on the other side of its face
            stream = ground.left.kind == STREAM
            room[HP - 1] = room[H - 1] if stream else room[HM]
            room[UP - 1] = room[U - 1] if stream else (-room[UM] if ground.left.kind == WALL else room[UM])
        if place.last and ground.right.kind != RING:
            stream = ground.right.kind == STREAM
            room[HM + n] = room[H + n] if stream else room[HP + n - 1]
            room[UM + n] = (
                room[U + n] if stream else (-room[UP + n - 1] if ground.right.kind == WALL else room[UP + n - 1])
            )

    def pulled(order, h, h1):
        return min(0.5 * (h + h1), 2.0 * h1)

    def midway(order, k, room):
        return 0.5 * (room[UM + k] + room[UP + k])

    def beta_shown(order, bed, cell, face_at):
        return face(bed, face_at)[2]

    def friction_of(order, law, h, u, h1, w, dt, acts, n):
        return brought_midway(law, h, u, h1, w, dt, acts, n)


__all__ = ["E", "First", "Second", "rows"]
