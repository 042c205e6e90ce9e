"""The rows of a density in a step: f after transport, and f after the force, made from the stages of a tile.

M, the densities at faces and f are not stored: three rows of M and two of faces roll through the first-level cache, and
what is written is what somebody asked for.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..kernel import generic, routine
from ..schemes.bed import beta_of
from ..schemes.questions import (
    acts_before,
    beta_shown,
    comes_back,
    has_own_density,
    own_states,
    takes_own,
)  # fmt: skip
from ..schemes.tile import H1, Q1, QHAT, TILE, H, J, Model, Place, U
from .equilibrium.questions import both_sides
from .force import push
from .nodes import leaving

CHUNK = 32
"""Cells whose rows after transport wait for the force."""


@routine()
def cell_rows(model: Model, place: Place, k: int, room: Array, rows: Array, r: int) -> None:
    """M of cell k on both sides of xi = 0, into the rows r and r + 1."""
    beta = beta_of(model.ground.bed, place.begin + k)
    both_sides(model.flux.equilibrium, room[H + k], room[U + k], beta, model.flux.dxi, rows[r], rows[r + 1])


@routine()
def face_rows(model: Model, place: Place, k: int, lam: float, room: Array, rows: Array, r: int) -> None:
    """The density that stands at face k itself: of its left state for xi > 0, of its right one for xi < 0."""
    flux, scheme, order, bed, i = model.flux, model.scheme, model.order, model.ground.bed, place.begin + k
    h, u, g, v = own_states(scheme, order, k, room)
    by = beta_shown(order, bed, i, i)
    leaving(flux, scheme, order, h, u, by, room[H + k], room[U + k], beta_of(bed, i), lam, rows[r])
    by = beta_shown(order, bed, i + 1, i)
    beta = beta_of(bed, i + 1)
    leaving(flux, scheme, order, g, -v, by, room[H + k + 1], -room[U + k + 1], beta, lam, rows[r + 1])


@routine()
def transport_rows(
    model: Model, place: Place, dt: float, first: int, last: int, room: Array, work: Array, xi: Array, T: Array,
    M: Array, B: Array, into: int,
) -> None:  # fmt: skip
    """f_i = M_i - lam xi (M_{i+1/2} - M_{i-1/2}), (23) before the shift, of the cells `first` to below `last`.

    T gets one row for each, from the row `into` on, and so do M and B (of the face right of the cell) if they are
    wanted. The density at a face is upwind, (19), or one of its own.
    """
    lam = dt / model.ground.dx
    scheme, order = model.scheme, model.order
    before, here, after, at_left, at_right = 0, 2, 4, 6, 8
    cell_rows(model, place, first - 1, room, work, before)
    cell_rows(model, place, first, room, work, here)
    if has_own_density(scheme, order, first - 1, room):
        face_rows(model, place, first - 1, lam, room, work, at_left)
    for k in range(first, last):
        cell_rows(model, place, k + 1, room, work, after)
        own = has_own_density(scheme, order, k, room)
        if own:
            face_rows(model, place, k, lam, room, work, at_right)
        own_left, own_right = takes_own(scheme, order, k, 0, room), takes_own(scheme, order, k, 1, room)
        leaves_right, leaves_left = at_right if own_right else here, (at_left if own_left else here) + 1
        comes_left, comes_right = at_left if own_left else before, (at_right if own_right else after) + 1
        if comes_back(scheme, k - 1, room):
            comes_left = here + 1
        if comes_back(scheme, k, room):
            comes_right = here
        row = into + k - first
        step_side(work, here, leaves_right, comes_left, xi, lam, T, row, True)
        step_side(work, here + 1, leaves_left, comes_right, xi, lam, T, row, False)
        if M.shape[0] > 0:
            put_sides(work, here, here + 1, M, row)
        if B.shape[0] > 0:
            put_sides(work, at_right if own else here, (at_right if own else after) + 1, B, row)
        before, here, after = here, after, before
        at_left, at_right = at_right, at_left


@routine()
def step_side(
    work: Array, here: int, leaves: int, comes: int, xi: Array, lam: float, T: Array, row: int, ahead: bool
) -> None:  # fmt: skip
    """M - lam |xi| (M_leaving - M_coming) on one side of xi = 0."""
    half = np.uint64(xi.size)
    a, b, c = np.uint64(here), np.uint64(leaves), np.uint64(comes)
    if ahead:
        for k in range(half):
            share = lam * xi[k]
            T[row, half + k] = (work[a, k] - share * work[b, k]) + share * work[c, k]
    else:
        for k in range(half):
            share = lam * xi[k]
            T[row, half - np.uint64(1) - k] = (work[a, k] - share * work[b, k]) + share * work[c, k]


@routine()
def put_sides(work: Array, p: int, n: int, out: Array, row: int) -> None:
    """Both sides as an ascending row."""
    half = out.shape[1] // 2
    for k in range(half):
        out[row, half + k] = work[p, k]
    for k in range(half):
        out[row, half - 1 - k] = work[n, k]


@routine()
def push_rows(
    model: Model, place: Place, first: int, last: int, room: Array, work: Array, padded: Array, T: Array, at: int,
    f: Array, offset: Array, into: int,
) -> float:  # fmt: skip
    """Hand J over to the rows T of the cells `first` to below `last`; returns the mass that leaves, per dx."""
    force, dxi, n, gone = model.force, model.flux.dxi, T.shape[1], 0.0
    for k in range(first, last):
        for j in range(n):
            padded[0, j + 2] = T[at + k - first, j]
        height = room[H1 + k]
        if acts_before(force):
            height = room[H + k]
            cell_rows(model, place, k, room, work, 0)
            for j in range(n // 2):
                padded[1, n // 2 + 2 + j], padded[1, n // 2 + 1 - j] = work[0, j], work[1, j]
        row = into + k - first
        offset[row], lost = push(force, padded[0], padded[1], room[J + k], height, dxi, f, row)
        gone += lost
    return gone


@generic
def density(
    model: Model, dt: float, rooms: Array, nx: int, xi: Array, T: Array, f: Array, M: Array, B: Array, offset: Array
) -> float:
    """f after the force of a step whose stages stand in `rooms`, into `f`, shape (nx, n); `xi`, (n/2,), are nodes > 0.

    T (f after transport), M and B (face i + 1 at row i) are written too where they have rows. `offset` gets how far the
    force moved the nodes. Returns the mass that left the window, per dx.
    """
    half, gone = xi.size, 0.0
    work, padded, few = np.zeros((10, half)), np.zeros((2, 2 * half + 4)), np.zeros((CHUNK, 2 * half))
    for tile in range(rooms.shape[0]):
        begin = tile * TILE
        place = Place(2 + begin, min(TILE, nx - begin), tile == 0, tile == rooms.shape[0] - 1)
        for first in range(0, place.n, CHUNK):
            last, into = min(first + CHUNK, place.n), begin + first
            if T.shape[0] > 0:
                transport_rows(model, place, dt, first, last, rooms[tile], work, xi, T, M, B, into)
                gone += push_rows(model, place, first, last, rooms[tile], work, padded, T, into, f, offset, into)
            else:
                transport_rows(model, place, dt, first, last, rooms[tile], work, xi, few, M, B, 0)
                gone += push_rows(model, place, first, last, rooms[tile], work, padded, few, 0, f, offset, into)
    return gone


@generic
def push_transported(model: Model, rooms: Array, nx: int, T: Array, f: Array, offset: Array) -> None:
    """f after the force, of rows T after transport."""
    n = T.shape[1]
    work, padded = np.zeros((2, n // 2)), np.zeros((2, n + 4))
    for tile in range(rooms.shape[0]):
        at = tile * TILE
        place = Place(2 + at, min(TILE, nx - at), tile == 0, tile == rooms.shape[0] - 1)
        push_rows(model, place, 0, place.n, rooms[tile], work, padded, T, at, f, offset, at)


def push_all(model: Model, rooms: Array, T: Array) -> tuple[Array, Array]:
    """f after the force, shape (nx, n), of what stands after transport, and how far its nodes moved."""
    f, offset = np.zeros_like(T), np.zeros(T.shape[0])
    push_transported(model, rooms, T.shape[0], np.ascontiguousarray(T), f, offset)
    return f, offset


class FluxDifference(NamedTuple):
    """U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J), (24)."""


class Resummed(NamedTuple):
    """Sums of f taken anew, the letter of (20); repeats the sampling defect in every step.

    `T` and `f`, shape (nx, n), are f after transport and after the force, `offset` how far its nodes moved, `xi` the
    nodes > 0; the others are to work in.
    """

    T: Array
    f: Array
    offset: Array
    xi: Array
    work: Array
    padded: Array


@routine()
def sum_transported(model: Model, dt: float, place: Place, room: Array) -> float:
    """Sum h^{n+1} and qhat anew after transport; returns the mass this makes, per dx."""
    own, none = model.projection, model.projection.T[:0]
    at, made = place.begin - 2, 0.0
    transport_rows(model, place, dt, 0, place.n, room, own.work, own.xi, own.T, none, none, at)
    for k in range(place.n):
        m0, m1 = sum_row(own.T, at + k, own.xi, model.flux.dxi)
        made += m0 - room[H1 + k]
        room[H1 + k], room[QHAT + k] = m0, m1
    return made


@routine()
def sum_forced(model: Model, dt: float, place: Place, room: Array) -> float:
    """Sum h^{n+1} and q^{n+1} anew after the force; returns the mass this makes, per dx."""
    own, at, made = model.projection, place.begin - 2, 0.0
    push_rows(model, place, 0, place.n, room, own.work, own.padded, own.T, at, own.f, own.offset, at)
    for k in range(place.n):
        m0, m1 = sum_row(own.f, at + k, own.xi, model.flux.dxi)
        made += m0 - room[H1 + k]
        room[H1 + k], room[Q1 + k] = m0, m1 + own.offset[at + k] * m0
    return made


@routine()
def sum_row(f: Array, i: int, xi: Array, dxi: float) -> tuple[float, float]:
    """Sums of f and xi f over a row, (20), outward from xi = 0 in pairs, so that mirrored sums are mirrored."""
    half, m0, m1 = xi.size, 0.0, 0.0
    for k in range(half):
        p, n = f[i, half + k], f[i, half - 1 - k]
        m0 += p + n
        m1 += (p - n) * xi[k]
    return m0 * dxi, m1 * dxi


__all__ = ["FluxDifference", "Resummed", "cell_rows", "density", "face_rows", "push_all"]
