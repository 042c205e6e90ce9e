"""One step of a tile, and many steps of all tiles: the whole time loop in one compiled call."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..kernel import formula, generic, greatest, routine
from ..schemes.bed import beta_of, lift, varies
from ..schemes.formulas import updated
from ..schemes.questions import (
    counted,
    face_states,
    fluxes,
    is_sloped,
    is_summed,
    judge,
    left_walls,
    settle,
    show,
    sum_forced,
    sum_transported,
)  # fmt: skip
from ..schemes.tile import (
    F1,
    F2,
    H1,
    HM,
    HP,
    MOVED,
    OPEN,
    Q1,
    QHAT,
    RING,
    SPEED,
    STREAM,
    TILE,
    UM,
    UP,
    Array,
    End,
    H,
    Model,
    Place,
    Q,
    all_dry,
    load,
)  # fmt: skip

REACHED, COUNTED, COURANT, NOT_FINITE, AT_REST, OUTSIDE, LIFTED, TOO_SHORT, TIGHT = range(9)
"""Why a march ended: the time is reached; all steps are made; the next one would break (28); it would have numbers that
are none; all rests; velocities leave the window; the mass leaves the ground; steps get too short; f may lose mass over
the edge of the window, so that somebody has to look at it."""

(
    LEAST_H, MOST_H, MOST_Q, MOST_U, FASTEST, IN_LEFT, IN_RIGHT, BAD, MOVED_LEFT, MOVED_RIGHT, RESTS, FACES, MADE,
    MENDED, CHANGE,
) = range(15)  # fmt: skip
"""What is kept of each tile."""

(
    T, BEFORE, TICKS, LEFT_OVER, STILL, IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL, LOST_ALL, MENDED_ALL, H_MIN, U_MAX,
    WORST, REACH, BEYOND, SWEPT, LIFT_MOST, LIFT_EVER, LIFT_FROM, LIFT_TO, LIFT_SINCE, LIFT_LEAST,
) = range(22)  # fmt: skip
"""What is seen of a run: see `solver.State`."""

ROUNDING = 1e-12
"""By so much may Courant numbers and velocity windows be passed: the rounding of their own computation."""

THIN = 1e-3
"""Cells lower than this share of the highest one do not count as having left the ground: velocities mean little there."""

FASTEST_OF_ALL = 1e100
"""Velocities beyond are refused: third moments have to be numbers, and so have sums of them."""

RESTING = 100
"""So many steps in a row without motion are called rest."""


class Asked(NamedTuple):
    """What is asked of a march.

    `dt` is the length of steps, or `number` the Courant number, with `falling` the speed of a grain that starts to
    slide and `shortest` the least step worth taking; `limit` the largest Courant number; `room` the largest sums;
    `bound` the velocity window, at which it `stops`; `pull` the largest acceleration, `tight` the speed from which the
    force may push f over the edge; a momentum up to `still` + `still_per_h` max h is rest, which `stop_at_rest` ends; `until` a time to land on; `past` a time after
    which to come back; `lifts` is 1 if lifting cells are counted, 2 if they end the run.
    """

    dt: float
    number: float
    falling: float
    shortest: float
    limit: float
    room: float
    bound: float
    stops: float
    pull: float
    tight: float
    still: float
    still_per_h: float
    stop_at_rest: float
    until: float
    past: float
    lifts: float


@routine()
def sweep(
    model: Model, place: Place, h: Array, q: Array, dt: float, h1: Array, q1: Array, whole: bool, room: Array,
    kept: Array,
) -> None:  # fmt: skip
    """U^n -> U^{n+1} of a tile; the room then holds its stages. Unless all are asked for, rest costs its judgement."""
    n, lam, ground, order = place.n, dt / model.ground.dx, model.ground, model.order
    load(h, q, place, room)
    rests = all_dry(n, room)
    if whole or not rests:
        rests = judge(model.scheme, ground, dt, place, room) or rests
    kept[RESTS] = kept[RESTS] + 1.0 if rests else 0.0
    if rests and not whole and not is_summed(model.projection):
        for k in range(n):
            h1[place.begin + k], q1[place.begin + k] = room[H + k], room[Q + k]
        for what in (IN_LEFT, IN_RIGHT, MOVED_LEFT, MOVED_RIGHT, FACES, MADE, MENDED, CHANGE):
            kept[what] = 0.0
        return
    show(order, ground, dt, place, room)  # slopes and half a step, or (19)
    face_states(model.scheme, order, ground, place, room)  # held back, or (25)
    made_at_faces = fluxes(model.scheme, order, model.flux, ground, dt, place, room)  # (24)
    kept[FACES] = max(made_at_faces, shown_reach(model, place, room) if is_sloped(order) else 0.0)
    left1, left2 = left_walls(model.scheme)
    for k in range(n):
        room[H1 + k] = updated(room[H + k], lam, room[left1 + k - 1], room[F1 + k])  # h^{n+1}
    for k in range(n):
        room[QHAT + k] = updated(room[Q + k], lam, room[left2 + k - 1], room[F2 + k])
    mended = sum_transported(model.projection, model, dt, place, room)
    mended += settle(model.scheme, order, model.force, model.flux, ground, dt, place, room)  # J = dt g h^{n+1}
    kept[MENDED] = mended + sum_forced(model.projection, model, dt, place, room)  # q^{n+1} = qhat + J, (20)
    for k in range(n):
        h1[place.begin + k], q1[place.begin + k] = room[H1 + k], room[Q1 + k]
    kept[IN_LEFT], kept[IN_RIGHT], kept[MADE] = room[left1 - 1], -room[F1 + n - 1], 0.0
    if left1 != F1:  # where the two cells of a face take different fluxes, mass appears or vanishes
        for k in range(0 if place.first and ground.left.kind != RING else -1, n - 1):
            kept[MADE] += room[left1 + k] - room[F1 + k]
    look(model, place, room, kept)


@routine()
def shown_reach(model: Model, place: Place, room: Array) -> float:
    """The fastest particle of all that cells show."""
    top = 0.0
    for k in range(place.n):
        c = math.sqrt(2.0 * beta_of(model.ground.bed, place.begin + k) * max(room[HP + k], room[HM + k]))
        top = max(top, max(abs(room[UP + k]), abs(room[UM + k])) + c)
    return top


@routine()
def look(model: Model, place: Place, room: Array, kept: Array) -> None:
    """What a run wants to know of a new state."""
    n, bad = place.n, 0
    for k in range(n):
        h, q = room[H1 + k], abs(room[Q1 + k])
        bad += 0 if (abs(h) < math.inf) & (q < math.inf) else 1
        room[MOVED + k] = q / h if h > 0.0 else 0.0
        room[SPEED + k] = room[MOVED + k] + math.sqrt(2.0 * beta_of(model.ground.bed, place.begin + k) * max(h, 0.0))
    kept[BAD] = bad
    negative, most, push, quick, top = -room[H1], room[H1], 0.0, 0.0, 0.0
    for k in range(n):
        negative, most = greatest(negative, -room[H1 + k]), greatest(most, room[H1 + k])
        push = greatest(push, abs(room[Q1 + k]))
        quick, top = greatest(quick, room[MOVED + k]), greatest(top, room[SPEED + k])
    kept[LEAST_H], kept[MOST_H], kept[MOST_Q], kept[MOST_U], kept[FASTEST] = -negative, most, push, quick, top
    far, moved = 0.0, 0.0
    for k in range(n):
        far, moved = greatest(far, abs(room[H1 + k] - room[H + k])), greatest(moved, abs(room[Q1 + k] - room[Q + k]))
    kept[CHANGE] = far if moved == 0.0 else max(far, 5e-324)
    kept[MOVED_LEFT] = changed(room, 0) + changed(room, 1)
    kept[MOVED_RIGHT] = changed(room, n - 2) + changed(room, n - 1)


@formula()
def changed(room: Array, k: int) -> float:
    """Whether a cell is no more what it was."""
    return 0.0 if (room[H1 + k] == room[H + k]) & (room[Q1 + k] == room[Q + k]) else 1.0


@routine()
def survey(model: Model, h: Array, q: Array, kept: Array, room: Array) -> None:
    """The same of a state from which a march starts."""
    nx = h.size - 4
    for tile in range(kept.shape[0]):
        begin, end = 2 + tile * TILE, 2 + min((tile + 1) * TILE, nx)
        for k in range(end - begin):
            room[H1 + k] = room[H + k] = h[begin + k]
            room[Q1 + k] = room[Q + k] = q[begin + k]
        look(model, Place(begin, end - begin, False, False), room, kept[tile])
        kept[tile, MOVED_LEFT] = kept[tile, MOVED_RIGHT] = 1.0
        kept[tile, RESTS] = 0.0


@formula()
def fill(end: End, h: Array, q: Array, g: int, d: int) -> None:
    """Fill the two cells beyond an end: g next to it, g - d beyond that, g + d the first inner one."""
    nx = h.size - 4
    if end.kind == RING:
        h[g], q[g], h[g - d], q[g - d] = h[g + d * nx], q[g + d * nx], h[g - d + d * nx], q[g - d + d * nx]
    elif end.kind == STREAM:
        h[g], q[g], h[g - d], q[g - d] = end.h, end.h * end.u, end.h, end.h * end.u
    elif end.kind == OPEN:
        h[g], q[g], h[g - d], q[g - d] = h[g + d], q[g + d], h[g + d], q[g + d]
    else:
        h[g], q[g], h[g - d], q[g - d] = h[g + d], -q[g + d], h[g + 2 * d], -q[g + 2 * d]


@formula()
def speed_of(end: End, beta: float) -> float:
    """|u| + c of a stream that comes in."""
    return abs(end.u) + math.sqrt(2.0 * beta * end.h) if (end.kind == STREAM) & (end.h > 0.0) else 0.0


@routine()
def next_dt(asked: Asked, planned: Array, top: float, fast: float, dx: float, seen: Array) -> tuple[float, float, bool]:
    """The length of the next step, the time after it, and whether it ends on `until`; steps are only shortened."""
    t, tick = seen[T], int(seen[TICKS])
    left = asked.until - t
    if asked.number > 0.0:
        speed = max(max(top, fast), asked.falling)
        dt = asked.number * dx / speed if speed > 0.0 else math.inf
        while dt / dx * speed > asked.number:  # by rounding
            dt = np.nextafter(dt, 0.0)
        return (left, asked.until, True) if dt >= left else (dt, t + dt, False)
    whole = planned[tick] if planned.size > 0 else asked.dt
    dt = seen[LEFT_OVER] if seen[LEFT_OVER] > 0.0 else whole
    if dt > left * (1.0 + 1e-9) and dt > left + 1e-9 * whole:
        seen[LEFT_OVER] = dt - left
        return left, asked.until, True
    seen[LEFT_OVER] = 0.0
    seen[TICKS] += 1.0
    after = t + dt if planned.size > 0 else (tick + 1) * asked.dt
    return (dt, asked.until, True) if abs(asked.until - after) <= 1e-9 * whole else (dt, after, False)


@generic
def march(
    model: Model, asked: Asked, planned: Array, most: int, states: Any, rooms: Array, kept: Array, dts: Array,
    seen: Array, fresh: bool,
) -> tuple[int, int]:  # fmt: skip
    """At most `most` steps; returns how many were made, and why it ended.

    `states` are three times (h, q) with two ghosts at each end: the state, the one before it, room for the next one;
    they take turns. `rooms` is one room for all tiles, or one for each. A step that is refused leaves all as it was.
    """
    (h, q), (h0, q0), (h1, q1) = states
    dx, bed, ground = model.ground.dx, model.ground.bed, model.ground
    nx, tiles, one_room = h.size - 4, kept.shape[0], rooms.shape[0] == 1
    streams = max(speed_of(ground.left, beta_of(bed, 1)), speed_of(ground.right, beta_of(bed, nx + 2)))
    if fresh:
        survey(model, h, q, kept, rooms[0])
    for steps in range(most):
        fill(ground.left, h, q, 1, 1)
        fill(ground.right, h, q, nx + 2, -1)
        fast = largest(kept, FASTEST)
        top = counted(model.flux, max(fast, streams))
        tick, left_over = seen[TICKS], seen[LEFT_OVER]
        dt, after, lands = next_dt(asked, planned, top, fast, dx, seen)
        courant, reason, dts[steps] = top * dt / dx, COUNTED, dt
        if dt < asked.shortest and not lands:
            reason = TOO_SHORT
        elif not courant <= asked.limit or not courant < math.inf:
            reason = COURANT
        elif one_room and max(fast, streams) + dt * asked.pull > asked.tight:
            reason = TIGHT
        whole = not one_room
        before, reach, still = 1.0, max(fast, streams), True
        for tile in range(tiles if reason == COUNTED else 0):
            now_moved = kept[tile, MOVED_RIGHT]
            first, last = tile == 0, tile == tiles - 1
            asleep = (kept[tile, RESTS] > 2.0) & (before == 0.0) & (not first) & (not last)
            if asleep:
                asleep = (kept[tile - 1, MOVED_RIGHT] == 0.0) & (kept[tile + 1, MOVED_LEFT] == 0.0)
            before = now_moved
            if whole or not asleep:
                begin = 2 + tile * TILE
                place = Place(begin, min(TILE, nx + 2 - begin), first, last)
                sweep(model, place, h, q, dt, h1, q1, whole, rooms[0 if one_room else tile], kept[tile])
                seen[SWEPT] += 0.0 if kept[tile, RESTS] > 0.0 else place.n
            reach, still = max(reach, kept[tile, FACES]), still & (kept[tile, CHANGE] == 0.0)
        seen[REACH] = max(seen[REACH], reach)
        if reason == COUNTED and reach > asked.bound * (1.0 + ROUNDING):
            seen[BEYOND] = max(seen[BEYOND], reach)
            reason = OUTSIDE if asked.stops > 0.0 else COUNTED
        if reason == COUNTED and not counts(kept, asked.room, nx, seen, dt):
            reason = NOT_FINITE
        if reason != COUNTED:
            seen[TICKS], seen[LEFT_OVER] = tick, left_over
            kept[:, RESTS] = 0.0
            return steps, reason
        h, q, h0, q0, h1, q1 = h1, q1, h, q, h0, q0
        seen[BEFORE], seen[T] = seen[T], after
        note(ground.left.kind == RING, kept, dt, dx, courant, seen)
        high = largest(kept, MOST_H)
        seen[STILL] = seen[STILL] + 1.0 if largest(kept, MOST_Q) <= asked.still + asked.still_per_h * high else 0.0
        up = lift_off(bed, h, q, high, after, seen) if varies(bed) and asked.lifts > 0.0 else False
        if up and asked.lifts > 1.0:
            return steps + 1, LIFTED
        creeps = seen[STILL] >= RESTING and largest(kept, CHANGE) <= ROUNDING * high
        if asked.stop_at_rest > 0.0 and seen[STILL] > 0.0 and (still or creeps):
            return steps + 1, AT_REST
        if lands or after >= asked.past:
            return steps + 1, REACHED
    return most, COUNTED


@routine()
def counts(kept: Array, room: float, nx: int, seen: Array, dt: float) -> bool:
    """Whether a new state is made of numbers, and so are sums over its cells."""
    high = max(max(largest(kept, MOST_H), -least(kept)), largest(kept, MOST_Q))
    sums = abs(seen[IN_LEFT_ALL]) + abs(seen[IN_RIGHT_ALL]) + abs(seen[MADE_ALL]) + abs(seen[MENDED_ALL])
    new = abs(kept[0, IN_LEFT]) + abs(kept[kept.shape[0] - 1, IN_RIGHT])
    for tile in range(kept.shape[0]):
        new += abs(kept[tile, MADE]) + abs(kept[tile, MENDED])
    fine = (largest(kept, BAD) == 0.0) & (largest(kept, FASTEST) <= FASTEST_OF_ALL)
    return fine & (nx * high < room) & (sums + abs(seen[LOST_ALL]) + dt * new < room)


@routine()
def note(ring: bool, kept: Array, dt: float, dx: float, courant: float, seen: Array) -> None:
    """Add to what is seen of a run what a step did to the mass, and its extremes."""
    last = kept.shape[0] - 1
    made, mended = 0.0, 0.0
    for tile in range(last + 1):
        made, mended = made + kept[tile, MADE], mended + kept[tile, MENDED]
    if not ring:
        seen[IN_LEFT_ALL] += dt * kept[0, IN_LEFT]
        seen[IN_RIGHT_ALL] += dt * kept[last, IN_RIGHT]
    seen[MADE_ALL] += dt * made
    seen[MENDED_ALL] += dx * mended
    seen[H_MIN], seen[U_MAX] = min(seen[H_MIN], least(kept)), max(seen[U_MAX], largest(kept, MOST_U))
    seen[WORST] = max(seen[WORST], courant)


@routine()
def lift_off(bed: Any, h: Array, q: Array, high: float, t: float, seen: Array) -> bool:
    """Count the cells that left the ground; says whether any has."""
    up = 0
    for i in range(2, h.size - 2):
        if h[i] > THIN * high:
            normal = lift(bed, i, q[i] / h[i])
            seen[LIFT_LEAST] = min(seen[LIFT_LEAST], normal)
            if normal < 0.0:
                up += 1
                seen[LIFT_FROM], seen[LIFT_TO] = min(seen[LIFT_FROM], i - 2), max(seen[LIFT_TO], i - 2)
                seen[LIFT_SINCE] = min(seen[LIFT_SINCE], t)
    seen[LIFT_MOST], seen[LIFT_EVER] = max(seen[LIFT_MOST], up), max(seen[LIFT_EVER], up)
    return up > 0


@formula()
def largest(kept: Array, what: int) -> float:
    """The largest of all tiles."""
    most = kept[0, what]
    for tile in range(1, kept.shape[0]):
        most = max(most, kept[tile, what])
    return most


@formula()
def least(kept: Array) -> float:
    """The least height of all tiles."""
    low = kept[0, LEAST_H]
    for tile in range(1, kept.shape[0]):
        low = min(low, kept[tile, LEAST_H])
    return low
