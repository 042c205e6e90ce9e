"""Scheme 4: conservative, positive, at rest and on dry ground; static friction acts at faces and in cells.

At a face static friction holds back the part of the density that the admissible jump of heights would send across:
with e = clamp(h_{i+1} - h_i; (s - R) dx/beta, (s + R) dx/beta) and the share theta of `formulas.held_share`, a face
shows h_i - theta (-e)_+ to the right and h_{i+1} - theta (e)_+ to the left. M(h, v) grows with h, so no more leaves a
cell than it has. In cells one clamped impulse does what gravity, friction, stopping and holding do.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compiled import question, routine
from .bed import beta_of, face, normal, pull, uneven
from .formulas import (
    DRY,
    clamp,
    clamped_impulse,
    clipped,
    drained,
    face_speed,
    held_share,
    is_still,
    pressure,
    uphill_pull,
)  # fmt: skip
from .friction import grip, holds
from .questions import (
    acts_before,
    beta_shown,
    cell_moments,
    extent,
    friction_of,
    is_sloped,
    limits_outflow,
    meet,
    midway,
    pulled,
    rows,
    state_moments,
)  # fmt: skip
from .tile import (
    F1,
    F2,
    FRICTION,
    H1,
    HIGH,
    HL,
    HR,
    LOW,
    N1,
    N2,
    P1,
    P2,
    PULL_HIGH,
    PULL_LOW,
    QHAT,
    SHARE,
    STILL,
    THETA,
    WALL,
    E,
    H,
    J,
    U,
)  # fmt: skip


class Held(NamedTuple):
    """Faces hold back what friction can balance, cells are stopped by a clamp; conservative, positive, rests."""

    def judge(scheme, ground, dt, place, room):
        n, bed, law, dx, begin = place.n, ground.bed, ground.law, ground.dx, place.begin
        for k in range(-2, n + 1):
            h_i, h_j = room[H + k], room[H + k + 1]
            w = face_speed(h_i, room[U + k], h_j, room[U + k + 1])
            s, normal_force, beta, tilt = face(bed, begin + k)
            R = holds(law, max(h_i, h_j), w, normal_force)
            low, high = (s - R) * dx / beta, (s + R) * dx / beta
            if tilt != 0.0:
                low, high = low - tilt * (h_i + h_j), high - tilt * (h_i + h_j)
            room[E + k] = clamp(h_j - h_i, low, high)
            room[THETA + k] = held_share(w, min(h_i, h_j), s, R, beta, dx)
        for k in range(-2, n + 1):
            room[STILL + k] = is_still(
                room[H + k], room[U + k], room[H + k + 1], room[U + k + 1], room[E + k], room[THETA + k]
            )
        if place.first and ground.left.kind == WALL:  # a wall is judged as the face next to it
            for row in (E, THETA, STILL):
                room[row - 2] = room[row - 1] = room[row]
        if place.last and ground.right.kind == WALL:
            for row in (E, THETA, STILL):
                room[row + n] = room[row + n - 1] = room[row + n - 2]
        still = 0
        for k in range(-1, n):
            still += 1 if room[STILL + k] == 1.0 else 0
        return still == n + 1

    def face_states(scheme, order, ground, place, room):
        n = place.n
        hp, _, hm, _ = rows(order)
        for k in range(-2, n + 1):
            a, b, e, theta = room[hp + k], room[hm + k + 1], room[E + k], room[THETA + k]
            from_left, from_right = uneven_shown(order, ground.bed, place.begin + k)
            above, below = -e - from_left * (a + e), e - from_right * (b - e)
            still = room[STILL + k] == 1.0
            room[HL + k] = min(a, (1.0 + from_left) * b) if still else max(a - theta * max(above, 0.0), 0.0)
            room[HR + k] = min(b, (1.0 + from_right) * a) if still else max(b - theta * max(below, 0.0), 0.0)
        if place.first and ground.left.kind == WALL:  # it shows on both sides what its cell does: nothing passes
            room[HL - 1] = room[HR - 1] = max(room[hm] - room[THETA - 1] * max(room[E - 1], 0.0), 0.0)
        if place.last and ground.right.kind == WALL:
            m = n - 1
            room[HL + m] = room[HR + m] = max(room[hp + m] - room[THETA + m] * max(-room[E + m], 0.0), 0.0)

    def fluxes(scheme, order, flux, ground, dt, place, room):
        n, bed = place.n, ground.bed
        held_flux(flux, scheme, order, ground, dt / ground.dx, place, room)
        for k in range(-1, n):
            left = beta_shown(order, bed, place.begin + k, place.begin + k)
            right = beta_shown(order, bed, place.begin + k + 1, place.begin + k)
            still = room[STILL + k] == 1.0
            room[F1 + k] = 0.0 if still else room[F1 + k]
            room[F2 + k] = pressure(left, room[HL + k], right, room[HR + k]) if still else room[F2 + k]
        return 0.0

    def settle(scheme, order, force, flux, ground, dt, place, room):
        n, bed, law, begin = place.n, ground.bed, ground.law, place.begin
        made = settle_heights(order, flux, bed, place, room)
        grip_dt, driven = dt * grip(law), 0
        for k in range(n):
            i, h, h1 = begin + k, room[H + k], room[H1 + k]
            height = h if acts_before(force) else pulled(order, h, h1)
            per = max(h1, DRY)
            acts, s = dt * (height / per), pull(bed, i)
            above = normal(bed, i, midway(order, k, room), grip_dt)
            R = friction_of(order, law, h, room[U + k], h1, room[QHAT + k] / per + acts * s, dt, acts, above)
            room[PULL_LOW + k], room[PULL_HIGH + k] = s - R, s + R
        for k in range(n):
            driven += 1 if (room[PULL_LOW + k] > 0.0) | (room[PULL_HIGH + k] < 0.0) else 0
        if driven > 0:
            lean(ground, place, room)
        for k in range(n):
            height = room[H + k] if acts_before(force) else pulled(order, room[H + k], room[H1 + k])
            stopped = clamped_impulse(room[QHAT + k], room[PULL_LOW + k], room[PULL_HIGH + k], height, dt)
            still = (room[STILL + k - 1] == 1.0) & (room[STILL + k] == 1.0)
            room[J + k] = -room[QHAT + k] if still else stopped
        return made

    def has_own_density(scheme, order, k, room):
        hp, _, hm, _ = rows(order)
        return (hp != H) | (room[HL + k] != room[hp + k]) | (room[HR + k] != room[hm + k + 1])

    def own_states(scheme, order, k, room):
        _, up, _, um = rows(order)
        return room[HL + k], room[up + k], room[HR + k], room[um + k + 1]

    def capped(scheme):
        return True


@question
def held_flux(flux, scheme, order, ground, lam, place, room):
    """(24) with the held states, of which no cell gives more than it has."""
    n = place.n
    _, up, _, um = rows(order)
    if not is_sloped(order) and holds_nothing(n, room):  # then cells show themselves to both sides
        cell_moments(flux, ground.bed, place, -1, n + 1, room)
    else:
        state_moments(flux, scheme, order, ground.bed, place, lam, -1, n + 1, HL, up, HR, um, P1, P2, N1, N2, room)
    if not limits_outflow(flux):
        drain(ground, lam, place, room)
    meet(-1, n, P1, P2, N1, N2, F1, F2, room)


@routine()
def holds_nothing(n, room):
    """Whether no face of a tile shows less than the cells beside it."""
    held = 0
    for k in range(-2, n + 1):
        held += 1 if (room[HL + k] != room[H + k]) | (room[HR + k] != room[H + k + 1]) else 0
    return held == 0


@routine()
def uneven_shown(order, bed, i):
    """r - 1 and 1/r - 1 of a face; 0 where both sides show the beta of the face, in second order."""
    return (0.0, 0.0) if rows(order)[0] != H else uneven(bed, i)


@routine()
def drain(ground, lam, place, room):
    """Cut the moments of what a cell sends to what it has; the ghost of a wall is its mirror image."""
    n = place.n
    for k in range(-1, n + 1):
        room[SHARE + k] = drained(room[H + k], room[P1 + k] + room[N1 + k - 1], lam)
    if place.first and ground.left.kind == WALL:
        room[SHARE - 1] = room[SHARE]
    if place.last and ground.right.kind == WALL:
        room[SHARE + n] = room[SHARE + n - 1]
    for k in range(-1, n + 1):
        share = room[SHARE + k]
        room[P1 + k], room[P2 + k] = share * room[P1 + k], share * room[P2 + k]
        room[N1 + k - 1], room[N2 + k - 1] = share * room[N1 + k - 1], share * room[N2 + k - 1]


@routine()
def settle_heights(order, flux, bed, place, room):
    """Cut heights below 0, and keep qhat/h^{n+1} among the particles that could come; returns the mass made, per dx."""
    n = place.n
    hp, up, hm, um = rows(order)
    made = 0.0
    for k in range(-1, n + 1):  # the slowest and the fastest particle of a cell
        i = place.begin + k
        right, left = beta_shown(order, bed, i, i), beta_shown(order, bed, i, i - 1)
        c, c_left = math.sqrt(2.0 * right * room[hp + k]), math.sqrt(2.0 * left * room[hm + k])
        slowest, quickest = extent(
            flux, min(room[up + k] - c, room[um + k] - c_left), max(room[up + k] + c, room[um + k] + c_left)
        )
        wet = room[hp + k] + room[hm + k] > 0.0
        room[LOW + k], room[HIGH + k] = slowest if wet else math.inf, quickest if wet else -math.inf
    for k in range(n):
        made -= min(room[H1 + k], 0.0)
    for k in range(n):
        slowest = min(room[LOW + k], min(room[LOW + k - 1], room[LOW + k + 1]))
        quickest = max(room[HIGH + k], max(room[HIGH + k - 1], room[HIGH + k + 1]))
        room[QHAT + k] = clipped(room[QHAT + k], room[H1 + k], slowest, quickest)
        room[H1 + k] = 0.0 + 0.0 * room[H1 + k] if room[H1 + k] < DRY else room[H1 + k]
    return made


@routine()
def lean(ground, place, room):
    """Where even a resting mass is driven, it is pulled as its faces see it; a wall bears what stands before it."""
    n, dx = place.n, ground.dx
    for k in range(n):
        before, here, after = room[H + k - 1], room[H + k], room[H + k + 1]
        if ground.left.kind == WALL and place.first and k == 0:
            before = max(here - room[E - 1], 0.0)
        if ground.right.kind == WALL and place.last and k == n - 1:
            after = max(here + room[E + n - 1], 0.0)
        low, high, beta = room[PULL_LOW + k], room[PULL_HIGH + k], beta_of(ground.bed, place.begin + k)
        held = min(room[THETA + k - 1], room[THETA + k])
        if low > 0.0:
            room[PULL_LOW + k] = uphill_pull(here, before, after, low, low * dx / beta, held)
        elif high < 0.0:
            room[PULL_HIGH + k] = -uphill_pull(here, after, before, -high, -high * dx / beta, held)


__all__ = ["FRICTION", "Held"]
