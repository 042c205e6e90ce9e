"""Many steps of all tiles: the whole time loop in one compiled call."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import formula, kernel, routine
from ..kinetic.nodes import outermost
from ..kinetic.rows import Watch
from ..schemes.tile import (
    H1,
    HIGH,
    LOW,
    OPEN,
    RING,
    STREAM,
    TILE,
    End,
    J,
    Place,
)  # fmt: skip
from .sweep import (
    BAD,
    CHANGE,
    FACES,
    FASTEST,
    IN_LEFT,
    IN_RIGHT,
    LEAST_F,
    LEAST_H,
    MADE,
    MENDED,
    MOST_H,
    MOST_Q,
    MOST_U,
    MOVED_LEFT,
    MOVED_RIGHT,
    RESTS,
    Parts,
    Shape,
    survey,
    sweep,
)

REACHED, COUNTED, COURANT, NOT_FINITE, AT_REST, OUTSIDE, LIFTED, TOO_SHORT, TIGHT = range(9)
"""Why a march ended: the time is reached; all steps are made; the next one would break (28); it would have numbers that
are none; all rests; velocities leave the window; the mass leaves the ground; steps get too short; f may lose mass over
the edge of the window, so that somebody has to look at it."""

(
    T, BEFORE, TICKS, LEFT_OVER, STILL, IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL, LOST_ALL, MENDED_ALL, H_MIN, U_MAX,
    WORST, REACH, BEYOND, SWEPT, LIFT_MOST, LIFT_EVER, LIFT_FROM, LIFT_TO, LIFT_SINCE, LIFT_LEAST, F_MIN,
) = range(SEEN := 23)  # fmt: skip
"""What is seen of a run: the time, now and before the last step; ticks of a clock, and what is left over of a step that
was cut; steps in a row without motion; mass that came in, appeared where a face has two fluxes, left the window, was
mended; since a row of the ledger least h, largest |u|, Courant number; the fastest state, and the fastest beyond the
window; cells that were swept; of cells that left the ground: most at once, since a row and ever, from where to where,
since when, and the least normal force; the least f since a row."""

ROUNDING = 1e-12
"""By so much may Courant numbers and velocity windows be passed: the rounding of their own computation."""

THIN = 1e-3
"""Cells lower than this share of the highest one do not count as having left the ground."""

FASTEST_OF_ALL = 1e100
"""Velocities beyond are refused: third moments have to be numbers, and so have sums of them."""

RESTING = 100
"""So many steps in a row without motion are called rest."""


class Asked(NamedTuple):
    """What is asked of a march.

    `dt` is the length of steps, or `number` the Courant number, with `falling` the speed of a grain that starts to
    slide and `shortest` the least step worth taking; `limit` the largest Courant number; `room` the largest sums,
    infinite where all is taken;
    `bound` the velocity window, at which it `stops`; `pull` the largest acceleration, `tight` the speed from which the
    force may push f over the edge; a momentum up to `still` + `still_per_h` max h is rest, which `stop_at_rest` ends;
    `until` a time to land on; `past` a time after which to come back; `lifts` is 1 if lifting cells are counted, 2 if
    they end the run.
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


@formula()
def count_velocity(shape: Shape, fastest: float) -> float:
    """The outermost velocity that (28) counts, where the fastest particle has |u| + c = `fastest`."""
    if shape.dxi == 0.0 or fastest == 0.0:
        return fastest
    return min(outermost(shape.dxi, shape.shift, shape.wide, fastest), shape.outermost)


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


@kernel
def march(
    shape: Shape, parts: Parts, lifting: Array, asked: Asked, planned: Array, most: int, states: Any, rooms: Array,
    watch: Watch, kept: Array, dts: Array, seen: Array, fresh: bool, whole: bool,
) -> tuple[int, int]:  # fmt: skip
    """At most `most` steps; returns how many were made, and why it ended.

    `states` are three times (h, q) with two ghosts at each end: the state, the one before it, room for the next one;
    they take turns. `rooms` is one room for all tiles, or with `whole`, which makes all stages, one for each. A step
    that is refused leaves all as it was.
    """
    (h, q), (h0, q0), (h1, q1) = states
    dx, left, right = shape.dx, shape.left, shape.right
    nx, tiles = h.size - 4, kept.shape[0]
    streams = max(speed_of(left, shape.beta_left), speed_of(right, shape.beta_right))
    if fresh:
        survey(parts, h, q, kept, rooms[0])
    for steps in range(most):
        fill(left, h, q, 1, 1)
        fill(right, h, q, nx + 2, -1)
        fast = largest(kept, FASTEST)
        top = count_velocity(shape, max(fast, streams))
        tick, left_over = seen[TICKS], seen[LEFT_OVER]
        dt, after, lands = next_dt(asked, planned, top, fast, dx, seen)
        courant, reason, dts[steps] = top * dt / dx, COUNTED, dt
        if dt < asked.shortest and not lands:
            reason = TOO_SHORT
        elif not courant <= asked.limit or not courant < math.inf:
            reason = COURANT
        may_leave, leaves = not whole and max(fast, streams) + dt * asked.pull > asked.tight, False
        before, reach, still, swept = 1.0, max(fast, streams), True, 0.0
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
                sweep(shape, parts, place, h, q, dt, h1, q1, whole, rooms[tile if whole else 0], watch, kept[tile])
                swept += 0.0 if kept[tile, RESTS] > 0.0 else place.n
                if may_leave and (kept[tile, RESTS] == 0.0 or shape.summed > 0.0):
                    leaves = leaves or leave_window(shape, place.n, rooms[0])
            reach, still = max(reach, kept[tile, FACES]), still & (kept[tile, CHANGE] == 0.0)
        if reason == COUNTED:
            seen[REACH] = max(seen[REACH], reach)
        if reason == COUNTED and reach > asked.bound * (1.0 + ROUNDING):
            seen[BEYOND] = max(seen[BEYOND], reach)
            reason = OUTSIDE if asked.stops > 0.0 else COUNTED
        if reason == COUNTED and leaves:
            reason = TIGHT
        if reason == COUNTED and asked.room < math.inf and not counts(kept, asked.room, nx, seen, dt):
            reason = NOT_FINITE
        if reason != COUNTED:
            seen[TICKS], seen[LEFT_OVER] = tick, left_over
            kept[:, RESTS] = 0.0
            return steps, reason
        h, q, h0, q0, h1, q1 = h1, q1, h, q, h0, q0
        seen[BEFORE], seen[T] = seen[T], after
        seen[SWEPT] += swept
        note(left.kind == RING, kept, dt, dx, courant, seen)
        high = largest(kept, MOST_H)
        seen[STILL] = seen[STILL] + 1.0 if largest(kept, MOST_Q) <= asked.still + asked.still_per_h * high else 0.0
        up = lift_off(lifting, h, q, high, after, seen) if asked.lifts > 0.0 else False
        if up and asked.lifts > 1.0:
            return steps + 1, LIFTED
        creeps = seen[STILL] >= RESTING and largest(kept, CHANGE) <= ROUNDING * high
        if asked.stop_at_rest > 0.0 and seen[STILL] > 0.0 and (still or creeps):
            return steps + 1, AT_REST
        if lands or after >= asked.past:
            return steps + 1, REACHED
    return most, COUNTED


@routine()
def leave_window(shape: Shape, n: int, room: Array) -> bool:
    """Whether the force may push some of f over the edge of the velocity window.

    f of a cell stands where its cell and the two neighbours stood, and is moved by the force.
    """
    half, leaves = shape.outermost / shape.dxi + 0.5, 0
    for k in range(n):
        slowest = min(room[LOW + k], min(room[LOW + k - 1], room[LOW + k + 1]))
        quickest = max(room[HIGH + k], max(room[HIGH + k - 1], room[HIGH + k + 1]))
        first, last = math.floor(slowest / shape.dxi) + half, math.floor(quickest / shape.dxi) + half
        way = room[J + k] / room[H1 + k] / shape.dxi if room[H1 + k] > 0.0 else 0.0
        over = last + (math.floor(way) + 1.0 if way > 0.0 else 0.0) >= 2.0 * half
        under = first - (math.floor(-way) + 1.0 if way < 0.0 else 0.0) < 0.0
        leaves += 1 if over or under else 0
    return leaves > 0


@routine()
def counts(kept: Array, room: float, nx: int, seen: Array, dt: float) -> bool:
    """Whether a new state is made of numbers, and so are sums over its cells."""
    high = max(max(largest(kept, MOST_H), -least(kept, LEAST_H)), largest(kept, MOST_Q))
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
    seen[H_MIN], seen[U_MAX] = min(seen[H_MIN], least(kept, LEAST_H)), max(seen[U_MAX], largest(kept, MOST_U))
    seen[WORST] = max(seen[WORST], courant)
    seen[F_MIN] = min(seen[F_MIN], least(kept, LEAST_F))


@routine()
def lift_off(lifting: Array, h: Array, q: Array, high: float, t: float, seen: Array) -> bool:
    """Count the cells that left the ground; says whether any has."""
    up = 0
    for i in range(2, h.size - 2):
        if h[i] > THIN * high:
            normal = lifting[0, i] + lifting[1, i] * (q[i] / h[i]) ** 2
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
def least(kept: Array, what: int) -> float:
    """The least of all tiles."""
    low = kept[0, what]
    for tile in range(1, kept.shape[0]):
        low = min(low, kept[tile, what])
    return low
