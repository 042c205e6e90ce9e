"""Half-range sums of M over the nodes that it occupies: M is made on one side of xi = 0 and forgotten."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..balance.sides import TINY
from ..kernel import kernel, kernel_inner, kernel_part
from .equilibrium.averages import antiderivative, average_inside, nodes_between, sample_inside

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LANES = 32
"""Cells whose sums run side by side."""

H, V, SQUARE, C, BELOW, M1, M2, LAST = (LANES * place for place in range(8))
"""Where lanes keep h; u or, for xi < 0, -u; 2 beta h; c; the integral of M so far; the sums; the last node occupied.

All in one array: of several the compiler would ask before each loop whether they overlap.
"""


@kernel_inner
def fill_occupied(h: float, u: float, beta: float, dxi: float, averaged: bool, side: Array) -> tuple[int, int]:
    """M(h, xi - u) at the nodes xi > 0 from the first at which it is not zero to the last; returns these, last + 1."""
    begin, end = average_inside(h, u, beta, dxi, side) if averaged else sample_inside(h, u, beta, dxi, side)
    while end > begin and side[end - 1] == 0.0:
        end -= 1
    while begin < end and side[begin] == 0.0:
        begin += 1
    return begin, end


@kernel_inner
def sum_side(side: Array, begin: int, end: int, w1: Array, w2: Array) -> tuple[float, float]:
    """First and second moment of what stands from `begin` to below `end` of one side."""
    m1, m2 = 0.0, 0.0
    for k in range(begin, end):
        m1 += w1[k] * side[k]
        m2 += w2[k] * side[k]
    return m1, m2


@kernel_inner
def first_node(h: float, u: float, beta: float, dxi: float, averaged: bool) -> float:
    """The first node at which M(h, xi - u) is not zero where all of it stands on xi > 0."""
    c = max(math.sqrt(2.0 * beta * h), TINY)
    k = max(math.floor((u - c) / dxi - 1.0), 0)
    while empty(h, u, c, beta, dxi, averaged, k):
        k += 1
    return (k + 0.5) * dxi


@kernel_inner
def empty(h: float, u: float, c: float, beta: float, dxi: float, averaged: bool, k: int) -> bool:
    """Whether M is zero at node k."""
    if averaged:
        below, above = antiderivative((k * dxi - u) / c), antiderivative(((k + 1) * dxi - u) / c)
        return not h / (math.pi * dxi) * (above - below) > 0.0
    w = (k + 0.5) * dxi - u
    return not 2.0 * beta * h - w * w > 0.0


@kernel_part
def add_sampled(beta: float, dxi: float, w1: Array, w2: Array, begin: int, rim: int, end: int, room: Array) -> None:
    """Sums of samples, node by node for all lanes; no wet lane ends before `rim`."""
    scale = 1.0 / (math.pi * beta)
    for k in range(begin, end):
        xi, first, second = (k + 0.5) * dxi, w1[k], w2[k]
        for i in range(LANES):
            w = xi - room[V + i]
            M = scale * math.sqrt(max(room[SQUARE + i] - w * w, 0.0))
            room[M1 + i] += first * M
            room[M2 + i] += second * M
    for k in range(rim, end):
        xi = (k + 0.5) * dxi
        for i in range(LANES):
            w = xi - room[V + i]
            room[LAST + i] = max(room[LAST + i], xi if room[SQUARE + i] - w * w > 0.0 else -np.inf)


@kernel_part
def add_averages(beta: float, dxi: float, w1: Array, w2: Array, begin: int, end: int, room: Array) -> None:
    """Sums of cell averages, likewise."""
    for i in range(LANES):
        room[BELOW + i] = antiderivative((begin * dxi - room[V + i]) / max(room[C + i], TINY))
    for k in range(begin, end):
        xi, edge, first, second = (k + 0.5) * dxi, (k + 1) * dxi, w1[k], w2[k]
        for i in range(LANES):
            above = antiderivative((edge - room[V + i]) / max(room[C + i], TINY))
            M = max(room[H + i] / (math.pi * dxi) * (above - room[BELOW + i]), 0.0)
            room[BELOW + i] = above
            room[M1 + i] += first * M
            room[M2 + i] += second * M
            room[LAST + i] = max(room[LAST + i], xi if M > 0.0 else -np.inf)


@kernel_inner
def add_lanes(
    beta: float, dxi: float, averaged: bool, w1: Array, w2: Array, slowest: float, early: float, quickest: float,
    room: Array,
) -> None:  # fmt: skip
    """Sums over xi > 0 of all lanes, in which M reaches from `slowest` on, to `early` at least, `quickest` at most."""
    half = w1.size
    begin, end = nodes_between(slowest, quickest, dxi, half)
    for i in range(LANES):
        room[M1 + i], room[M2 + i], room[LAST + i] = 0.0, 0.0, -np.inf
    if averaged:
        add_averages(beta, dxi, w1, w2, begin, end, room)
    else:
        rim = max(int(min(max(early / dxi - 1.0, 0.0), half - 1.0)), begin)  # past the window, the last node tells
        add_sampled(beta, dxi, w1, w2, begin, rim, end, room)


@kernel
def sum_cells(
    h: Array, u: Array, beta: float, dxi: float, averaged: bool, w1: Array, w2: Array, room: Array,
    sums: Array, low: Array, high: Array,
) -> tuple[float, float]:  # fmt: skip
    """Half-range sums of each ghosted cell, shape (4, nx + 2), and its outermost occupied nodes.

    M is made node by node for LANES cells at once in `room`, shape (8 LANES,), and never stored. The sums of a cell
    run outward from xi = 0 as those of `transport.half_sums` do, and what they add besides is zero: they are bitwise
    those of stored rows, and so are the outermost nodes. Returns the outermost of all nodes and max(|u| + c), both 0
    where all is dry.
    """
    top, reach = 0.0, 0.0
    for start in range(0, h.size, LANES):
        stop = min(start + LANES, h.size)
        slowest, late, early, quickest = np.inf, -np.inf, np.inf, -np.inf
        for i in range(LANES):
            here = start + i < stop
            room[H + i] = max(h[start + i], 0.0) if here else 0.0
            room[V + i] = u[start + i] if here else 0.0
        for i in range(LANES):
            room[SQUARE + i] = 2.0 * beta * room[H + i]
            room[C + i] = math.sqrt(room[SQUARE + i])
        for i in range(LANES):
            c = room[C + i]
            if room[H + i] > 0.0:
                slowest, late = min(slowest, room[V + i] - c), max(late, room[V + i] - c)
                early, quickest = min(early, room[V + i] + c), max(quickest, room[V + i] + c)
        reach = max(reach, max(-slowest, quickest))
        add_lanes(beta, dxi, averaged, w1, w2, slowest, early, quickest, room)
        for i in range(start, stop):
            sums[0, i], sums[1, i], high[i] = room[M1 + i - start], room[M2 + i - start], room[LAST + i - start]
        for i in range(LANES):
            room[V + i] = -room[V + i]
        add_lanes(beta, dxi, averaged, w1, w2, -quickest, -late, -slowest, room)
        for i in range(start, stop):
            sums[2, i], sums[3, i], low[i] = 0.0 - room[M1 + i - start], room[M2 + i - start], -room[LAST + i - start]
            if low[i] == np.inf and high[i] > 0.0:
                low[i] = first_node(h[i], u[i], beta, dxi, averaged)
            if high[i] == -np.inf and low[i] < 0.0:
                high[i] = -first_node(h[i], -u[i], beta, dxi, averaged)
            top = max(top, max(-low[i], high[i]))
    return top, reach


@kernel_inner
def fill_held(
    h: float, u: float, of_cell: float, u_of_cell: float, beta: float, dxi: float, averaged: bool, side: Array,
    spare: Array,
) -> tuple[int, int]:  # fmt: skip
    """What a held face sends of xi > 0: the density of its own state, and no more than stands in the cell before it."""
    begin, end = fill_occupied(h, u, beta, dxi, averaged, side)
    first, last = fill_occupied(of_cell, u_of_cell, beta, dxi, averaged, spare)
    begin = max(begin, first)
    end = max(min(end, last), begin)
    for k in range(begin, end):
        side[k] = min(side[k], spare[k])
    return begin, end


@kernel
def add_held(
    h: Array, u: Array, h_left: Array, u_left: Array, h_right: Array, u_right: Array, held: Flags, still: Flags,
    beta: float, dxi: float, averaged: bool, w1: Array, w2: Array, side: Array, spare: Array, sums: Array,
    F1: Array, F2: Array, at_left: Flags, at_right: Flags,
) -> None:  # fmt: skip
    """The one flux of scheme 4; that of still faces is not asked for. Says which walls of each cell are held, too."""
    for i in range(F1.size):
        F1[i] = sums[0, i] + sums[2, i + 1]
        F2[i] = sums[1, i] + sums[3, i + 1]
        if held[i] and not still[i]:
            begin, end = fill_held(h_left[i], u_left[i], h[i], u[i], beta, dxi, averaged, side, spare)
            p1, p2 = sum_side(side, begin, end, w1, w2)
            begin, end = fill_held(h_right[i], -u_right[i], h[i + 1], -u[i + 1], beta, dxi, averaged, side, spare)
            n1, n2 = sum_side(side, begin, end, w1, w2)
            F1[i], F2[i] = p1 - n1, p2 + n2
        if i > 0:
            at_right[i - 1] = held[i]
        if i < at_left.size:
            at_left[i] = held[i]


@kernel
def foresee(low: Array, high: Array, J: Array, h1: Array, dxi: float, half: int, forced: bool) -> tuple[bool, bool]:
    """Of f after the force, without f: whether any of it may have left the window, and whether a node is surely empty.

    A row of f stands where its cell and the two neighbours stood, and is moved by the force.
    """
    n, leaves, full, one = 2.0 * half, 0, 0, np.uint64(1)
    for i in range(np.uint64(J.size)):
        k = i + one
        slowest, quickest = min(low[k], min(low[i], low[k + one])), max(high[k], max(high[i], high[k + one]))
        first, last = np.floor(slowest / dxi) + half, np.floor(quickest / dxi) + half
        whole = np.floor(min(abs(J[i]) / h1[i] / dxi if h1[i] > 0.0 else 0.0, n))
        first -= whole + 1.0 if forced and J[i] < 0.0 else 0.0
        last += whole + 1.0 if forced and J[i] > 0.0 else 0.0
        leaves += (first < 0.0) | (last >= n)
        full += (first <= 0.0) & (last >= n - 1.0)
    return leaves > 0, full < J.size
