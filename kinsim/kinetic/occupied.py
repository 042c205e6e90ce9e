"""Half-range sums of M over the nodes that it occupies: M is made on one side of xi = 0 and forgotten."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..balance.sides import TINY
from ..kernel import kernel, kernel_inner, kernel_part
from .equilibrium.averages import antiderivative, average_inside, sample_inside
from .shift import split_shift

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


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
def occupied_nodes(
    h: float, u: float, beta: float, dxi: float, averaged: bool, slowest: float, quickest: float, half: int
) -> tuple[int, int]:
    """The first node xi > 0 at which M(h, xi - u) is not zero, and one past the last; the same number where none is.

    M reaches from `slowest` to `quickest`, in velocity cells.
    """
    begin = int(min(max(slowest - 1.0, 0.0), half))
    end = math.ceil(min(max(quickest + 1.0, 0.0), half)) if h > 0.0 else begin
    while end > begin and empty(h, u, beta, dxi, averaged, end - 1):
        end -= 1
    while begin < end and empty(h, u, beta, dxi, averaged, begin):
        begin += 1
    return begin, max(begin, end)


@kernel_inner
def empty(h: float, u: float, beta: float, dxi: float, averaged: bool, k: int) -> bool:
    """Whether M is zero at node k."""
    if averaged:
        c = math.sqrt(2.0 * beta * h)
        below, above = antiderivative((k * dxi - u) / c), antiderivative(((k + 1) * dxi - u) / c)
        return not h / (math.pi * dxi) * (above - below) > 0.0
    w = (k + 0.5) * dxi - u
    return not 2.0 * beta * h - w * w > 0.0


@kernel_part
def add_sampled(
    h: Array, v: Array, square: Array, beta: float, dxi: float, w1: Array, w2: Array, begin: int, end: int,
    m1: Array, m2: Array,
) -> None:  # fmt: skip
    """Sums of samples, node by node for many cells; `v` is u or, for xi < 0, -u, and `square` room."""
    scale = 1.0 / (math.pi * beta)
    for i in range(h.size):
        square[i], m1[i], m2[i] = 2.0 * beta * max(h[i], 0.0), 0.0, 0.0
    for k in range(begin, end):
        xi, first, second = (k + 0.5) * dxi, w1[k], w2[k]
        for i in range(h.size):
            w = xi - v[i]
            M = scale * math.sqrt(max(square[i] - w * w, 0.0))
            m1[i] += first * M
            m2[i] += second * M


@kernel_part
def add_averages(
    h: Array, v: Array, below: Array, beta: float, dxi: float, w1: Array, w2: Array, begin: int, end: int,
    m1: Array, m2: Array,
) -> None:  # fmt: skip
    """Sums of cell averages, likewise."""
    for i in range(h.size):
        c = math.sqrt(2.0 * beta * max(h[i], 0.0))
        below[i], m1[i], m2[i] = antiderivative((begin * dxi - v[i]) / max(c, TINY)), 0.0, 0.0
    for k in range(begin, end):
        edge, first, second = (k + 1) * dxi, w1[k], w2[k]
        for i in range(h.size):
            c = math.sqrt(2.0 * beta * max(h[i], 0.0))
            above = antiderivative((edge - v[i]) / max(c, TINY))
            M = max(max(h[i], 0.0) / (math.pi * dxi) * (above - below[i]), 0.0)
            below[i] = above
            m1[i] += first * M
            m2[i] += second * M


@kernel
def sum_cells(
    h: Array, u: Array, beta: float, dxi: float, averaged: bool, w1: Array, w2: Array, room: Array,
    sums: Array, low: Array, high: Array,
) -> float:  # fmt: skip
    """Half-range sums of each ghosted cell, shape (4, nx + 2), and its outermost occupied nodes.

    M is made node by node for `room.shape[1]` cells at once, and never stored. The sums of a cell run outward from
    xi = 0 as those of `transport.half_sums` do, and what they add besides is zero: they are bitwise those of stored
    rows, and so are the outermost nodes. Returns the outermost of all nodes, 0 if all is dry.
    """
    top, half = 0, w1.size
    for start in range(0, h.size, room.shape[1]):
        stop = min(start + room.shape[1], h.size)
        tile, count = slice(start, stop), stop - start
        v, spare = room[0, :count], room[1, :count]
        begins, ends = (half, half), (0, 0)
        for i in range(start, stop):
            v[i - start] = -u[i]
            low[i], high[i] = np.inf, -np.inf
            c = math.sqrt(2.0 * beta * max(h[i], 0.0))
            slowest, quickest = (u[i] - c) / dxi, (u[i] + c) / dxi
            first, last = occupied_nodes(h[i], u[i], beta, dxi, averaged, slowest, quickest, half)
            begin, end = occupied_nodes(h[i], -u[i], beta, dxi, averaged, -quickest, -slowest, half)
            if first < last:
                low[i], high[i] = (first + 0.5) * dxi, (last - 0.5) * dxi
                begins, ends = (min(begins[0], first), begins[1]), (max(ends[0], last), ends[1])
            if begin < end:
                low[i] = -(end - 0.5) * dxi
                high[i] = high[i] if first < last else -(begin + 0.5) * dxi
                begins, ends = (begins[0], min(begins[1], begin)), (ends[0], max(ends[1], end))
        top = max(top, max(ends[0], ends[1]))
        p, n = (sums[0, tile], sums[1, tile]), (sums[2, tile], sums[3, tile])
        if averaged:
            add_averages(h[tile], u[tile], spare, beta, dxi, w1, w2, begins[0], ends[0], p[0], p[1])
            add_averages(h[tile], v, spare, beta, dxi, w1, w2, begins[1], ends[1], n[0], n[1])
        else:
            add_sampled(h[tile], u[tile], spare, beta, dxi, w1, w2, begins[0], ends[0], p[0], p[1])
            add_sampled(h[tile], v, spare, beta, dxi, w1, w2, begins[1], ends[1], n[0], n[1])
        for i in range(start, stop):
            sums[2, i] = 0.0 - sums[2, i]
    return (top - 0.5) * dxi if top > 0 else 0.0


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
    leaves, empty = False, False
    for i in range(J.size):
        slowest = min(low[i + 1], min(low[i], low[i + 2]))
        quickest = max(high[i + 1], max(high[i], high[i + 2]))
        if slowest > quickest:
            empty = True
            continue
        first, last = math.floor(slowest / dxi) + half, math.floor(quickest / dxi) + half
        if forced and J[i] != 0.0:
            whole, _ = split_shift(J[i], h1[i], dxi, 2 * half)
            if J[i] < 0.0:
                first -= whole + 1
            else:
                last += whole + 1
        leaves = leaves or first < 0 or last >= 2 * half
        empty = empty or first > 0 or last < 2 * half - 1
    return leaves, empty
