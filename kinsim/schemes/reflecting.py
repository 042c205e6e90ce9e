"""Scheme 4 with static faces: where friction can hold what stands on both sides, particles come back from the face.

With D = beta (h_{i+1} - h_i)/dx the leftover friction of a face is L = R - |s - D|. A face is static where L >= 0 but
for rounding, and both its cells are slower than what L stops in a step: |u| <= dt L. No mass passes it; each cell has
its own pressure there, and the ground takes the difference.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from .bed import face, normal, pull
from .formulas import DRY, face_speed
from .friction import brought, grip, holds
from .questions import acts_before, cell_moments, meet, pulled
from .scheme4 import settle_heights
from .tile import F1, F2, G1, G2, H1, LEFTOVER, N1, N2, P1, P2, QHAT, STATIC, WALL, H, J, U

ROUNDING = 1e-13
"""L may fall short of 0 by so much."""


class Reflecting(NamedTuple):
    """Faces that friction can hold turn particles round; conservative in mass, positive, rests; first order."""

    def judge(scheme, ground, dt, place, room):
        n, dx = place.n, ground.dx
        for k in range(-2, n + 1):
            h_i, h_j, u_i, u_j = room[H + k], room[H + k + 1], room[U + k], room[U + k + 1]
            s, normal_force, beta, tilt = face(ground.bed, place.begin + k)
            R = holds(ground.law, max(h_i, h_j), face_speed(h_i, u_i, h_j, u_j), normal_force)
            slope = beta * (h_j - h_i) / dx
            if tilt != 0.0:
                slope += beta * tilt * (h_i + h_j) / dx
            spare = R - abs(s - slope)
            room[LEFTOVER + k] = max(spare, 0.0)
            slow = max(abs(u_i), abs(u_j)) <= dt * room[LEFTOVER + k]
            room[STATIC + k] = 1.0 if (R > 0.0) & (spare >= -ROUNDING) & slow else 0.0
        if place.first and ground.left.kind == WALL:  # a wall is judged as the face next to it
            room[LEFTOVER - 1], room[STATIC - 1] = room[LEFTOVER], room[STATIC]
        if place.last and ground.right.kind == WALL:
            room[LEFTOVER + n - 1], room[STATIC + n - 1] = room[LEFTOVER + n - 2], room[STATIC + n - 2]
        still = 0
        for k in range(-1, n):
            still += 1 if (room[STATIC + k] == 1.0) & (room[U + k] == 0.0) & (room[U + k + 1] == 0.0) else 0
        return still == n + 1

    def fluxes(scheme, order, flux, ground, dt, place, room):
        n = place.n
        cell_moments(flux, ground.bed, place, -1, n + 1, room)
        meet(-1, n, P1, P2, N1, N2, F1, F2, room)
        for k in range(-1, n):
            static = room[STATIC + k] == 1.0
            room[F1 + k] = 0.0 if static else room[F1 + k]
            room[G1 + k], room[G2 + k] = room[F1 + k], room[F2 + k]
            room[F2 + k] = 2.0 * room[P2 + k] if static else room[F2 + k]
            room[G2 + k] = 2.0 * room[N2 + k] if static else room[G2 + k]
        return 0.0

    def has_two_fluxes(scheme):
        return True

    def settle(scheme, order, force, flux, ground, dt, place, room):
        bed, law, grip_dt = ground.bed, ground.law, dt * grip(ground.law)
        made = settle_heights(order, flux, bed, place, room)
        for k in range(place.n):
            i, h, h1 = place.begin + k, room[H + k], room[H1 + k]
            height = h if acts_before(force) else pulled(order, h, h1)
            left, right = room[STATIC + k - 1], room[STATIC + k]  # a static face counts with half of what is left there
            w = (1.0 - 0.5 * left) - 0.5 * right
            spare = (0.5 * left) * room[LEFTOVER + k - 1] + (0.5 * right) * room[LEFTOVER + k]
            drive = (dt * (w * pull(bed, i))) * height
            per = max(h1, DRY)
            acts = dt * (height / per)
            R = brought(law, h1, abs((room[QHAT + k] + drive) / per), acts, normal(bed, i, room[U + k], grip_dt))
            most = (dt * (w * R + spare)) * height
            q = room[QHAT + k] + drive
            room[J + k] = -room[QHAT + k] if abs(q) <= most else drive - math.copysign(most, q)
        return made

    def comes_back(scheme, k, room):
        return room[STATIC + k] == 1.0
