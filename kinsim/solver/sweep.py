"""One step of a tile: the parts of a step, in their order, and what is kept of the tile."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import formula, greatest, perform, routine
from ..kinetic.rows import Watch, least_entry
from ..schemes.bed import beta_of
from ..schemes.formulas import updated
from ..schemes.questions import extent, face_states, fluxes, is_sloped, judge, limits_outflow, settle, show
from ..schemes.tile import (
    F1,
    F2,
    G1,
    G2,
    H1,
    HIGH,
    HM,
    HP,
    LOW,
    MOVED,
    Q1,
    QHAT,
    RING,
    SPEED,
    TILE,
    UM,
    UP,
    End,
    H,
    J,
    Place,
    Q,
    U,
    all_dry,
    load,
)  # fmt: skip

Parts = NDArray[np.int64]
"""Addresses of the parts of a step and of their tables, shape (8, 3)."""

(
    LEAST_H, MOST_H, MOST_Q, MOST_U, FASTEST, IN_LEFT, IN_RIGHT, BAD, MOVED_LEFT, MOVED_RIGHT, RESTS, FACES, MADE,
    MENDED, CHANGE, LEAST_F,
) = range(KEPT := 16)  # fmt: skip
"""What is kept of each tile."""


class Shape(NamedTuple):
    """What the march itself asks of a model, as numbers.

    `dx` is the length of a cell; the ends are `left` and `right`; `two_fluxes` is 1 where the cells of a face may take
    different fluxes, `sloped` where cells show slopes, `summed` where U^{n+1} is summed anew from f. (28) counts a
    velocity as the outermost node that is occupied, at most `outermost`; as it is if dxi is 0.
    """

    dx: float
    left: End
    right: End
    two_fluxes: float
    sloped: float
    summed: float
    dxi: float
    shift: float
    wide: float
    outermost: float
    beta_left: float
    beta_right: float


JUDGE, SHOW, MEET, FLUXES, TRANSPORTED, SETTLE, FORCED, LOOK = range(8)
"""The parts of a step, in their order."""


@routine()
def sweep(
    shape: Shape, parts: Parts, place: Place, h: Array, q: Array, dt: float, h1: Array, q1: Array, whole: bool,
    room: Array, watch: Watch, kept: Array,
) -> None:  # fmt: skip
    """U^n -> U^{n+1} of a tile; the room then holds its stages. Unless all are asked for, rest costs its judgement."""
    n, lam, begin, first, last = place.n, dt / shape.dx, place.begin, place.first, place.last
    load(h, q, place, room)
    rests = all_dry(n, room)
    if whole or not rests:
        rests = perform(parts, JUDGE, dt, begin, n, first, last, room) > 0.0 or rests
    kept[RESTS] = kept[RESTS] + 1.0 if rests else 0.0
    if rests and not whole and shape.summed == 0.0:
        for k in range(n):
            h1[begin + k], q1[begin + k] = room[H + k], room[Q + k]
        for what in (IN_LEFT, IN_RIGHT, MOVED_LEFT, MOVED_RIGHT, FACES, MADE, MENDED, CHANGE, LEAST_F):
            kept[what] = 0.0
        return
    perform(parts, SHOW, dt, begin, n, first, last, room)  # slopes and half a step, or (19)
    perform(parts, MEET, dt, begin, n, first, last, room)  # held back
    kept[FACES] = perform(parts, FLUXES, dt, begin, n, first, last, room)  # (24)
    left1, left2 = (G1, G2) if shape.two_fluxes > 0.0 else (F1, F2)
    for k in range(n):
        room[H1 + k] = updated(room[H + k], lam, room[left1 + k - 1], room[F1 + k])  # h^{n+1}
    for k in range(n):
        room[QHAT + k] = updated(room[Q + k], lam, room[left2 + k - 1], room[F2 + k])
    mended = perform(parts, TRANSPORTED, dt, begin, n, first, last, room) if shape.summed > 0.0 else 0.0
    mended += perform(parts, SETTLE, dt, begin, n, first, last, room)  # J = dt g h^{n+1}, (21), (22)
    for k in range(n):
        room[Q1 + k] = room[QHAT + k] + room[J + k]  # q^{n+1}, (20)
    kept[MENDED] = mended + (perform(parts, FORCED, dt, begin, n, first, last, room) if shape.summed > 0.0 else 0.0)
    for k in range(n):
        h1[begin + k], q1[begin + k] = room[H1 + k], room[Q1 + k]
    kept[LEAST_F] = least_entry(watch, dt, place, room)
    kept[IN_LEFT], kept[IN_RIGHT], kept[MADE] = room[left1 - 1], -room[F1 + n - 1], 0.0
    if shape.two_fluxes > 0.0:  # where the two cells of a face take different fluxes, mass appears or vanishes
        for k in range(0 if first and shape.left.kind != RING else -1, n - 1):
            kept[MADE] += room[left1 + k] - room[F1 + k]
    look(parts, place, room, kept)


@routine()
def look(parts: Parts, place: Place, room: Array, kept: Array) -> None:
    """What a run wants to know of a new state."""
    n = place.n
    kept[BAD] = perform(parts, LOOK, 0.0, place.begin, n, False, False, room)
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


@routine()
def judged(scheme: Any, ground: Any, dt: float, place: Place, room: Array) -> float:
    """Judge the faces; 1 if the tile rests."""
    return 1.0 if judge(scheme, ground, dt, place, room) else 0.0


@routine()
def shown(order: Any, ground: Any, dt: float, place: Place, room: Array) -> float:
    """Write what cells show to their walls."""
    show(order, ground, dt, place, room)
    return 0.0


@routine()
def met(scheme: Any, order: Any, ground: Any, dt: float, place: Place, room: Array) -> float:
    """Write the states at faces."""
    face_states(scheme, order, ground, place, room)
    return 0.0


@routine()
def sent(scheme: Any, order: Any, flux: Any, ground: Any, dt: float, place: Place, room: Array) -> float:
    """Write the fluxes; returns the fastest particle of states made at faces, and of what cells show."""
    top = fluxes(scheme, order, flux, ground, dt, place, room)
    if limits_outflow(flux):
        for k in range(-1, place.n + 1):
            c = math.sqrt(2.0 * beta_of(ground.bed, place.begin + k) * room[H + k])
            room[LOW + k], room[HIGH + k] = extent(flux, room[U + k] - c, room[U + k] + c)
            if room[H + k] == 0.0:
                room[LOW + k], room[HIGH + k] = math.inf, -math.inf
    if is_sloped(order):
        for k in range(place.n):
            c = math.sqrt(2.0 * beta_of(ground.bed, place.begin + k) * max(room[HP + k], room[HM + k]))
            top = max(top, max(abs(room[UP + k]), abs(room[UM + k])) + c)
    return top


@routine()
def settled(
    scheme: Any, order: Any, force: Any, flux: Any, ground: Any, dt: float, place: Place, room: Array
) -> float:  # fmt: skip
    """Write J; returns the mass that is made of heights below 0."""
    return settle(scheme, order, force, flux, ground, dt, place, room)


@routine()
def looked(bed: Any, dt: float, place: Place, room: Array) -> float:
    """Write |u| and |u| + c of the new state; returns how many of its numbers are none."""
    bad = 0
    for k in range(place.n):
        h, q = room[H1 + k], abs(room[Q1 + k])
        bad += 0 if (abs(h) < math.inf) & (q < math.inf) else 1
        room[MOVED + k] = q / h if h > 0.0 else 0.0
        room[SPEED + k] = room[MOVED + k] + math.sqrt(2.0 * beta_of(bed, place.begin + k) * max(h, 0.0))
    return float(bad)


@formula()
def changed(room: Array, k: int) -> float:
    """Whether a cell is no more what it was."""
    return 0.0 if (room[H1 + k] == room[H + k]) & (room[Q1 + k] == room[Q + k]) else 1.0


@routine()
def survey(parts: Parts, h: Array, q: Array, kept: Array, room: Array) -> None:
    """What `look` sees of a state from which a march starts."""
    nx = h.size - 4
    for tile in range(kept.shape[0]):
        begin, end = 2 + tile * TILE, 2 + min((tile + 1) * TILE, nx)
        for k in range(end - begin):
            room[H1 + k] = room[H + k] = h[begin + k]
            room[Q1 + k] = room[Q + k] = q[begin + k]
        look(parts, Place(begin, end - begin, False, False), room, kept[tile])
        kept[tile, MOVED_LEFT] = kept[tile, MOVED_RIGHT] = 1.0
        kept[tile, RESTS] = 0.0
