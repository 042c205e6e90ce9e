"""f after transport and shift in one sweep over the cells, from what a step has settled: M is made again, never stored.

Three rows of M roll through the first-level cache, each as two sides counted outward from xi = 0, so that upwinding is
the choice of a row. The sweep does what the rooms do to each entry, in their order: the bits are theirs.

Loops run over unsigned indices of whole arrays: a signed one may count from the end in numpy, and a slice counts
references, and either keeps a short loop from running in vector registers.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner, kernel_part
from .equilibrium.averages import average_inside
from .shift import split_shift

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Spans = NDArray[np.int64]


@kernel_inner
def fill_row(h: float, u: float, beta: float, dxi: float, averaged: bool, side: Array, rows: Array, row: int) -> int:
    """M(h, xi - u) on the side xi > 0, of which `side` are the nodes; returns a number past which it is zero."""
    half = side.size
    if averaged:
        begin, end = average_inside(h, u, beta, dxi, rows[row])
        blank(rows[row], 0, begin)
    else:
        square, scale = 2.0 * beta * max(h, 0.0), 1.0 / (math.pi * beta)
        c = math.sqrt(square)
        end = min((int(min(max((u + c) / dxi + 1.0, 0.0), half)) + 8) & -8, half) if c > 0.0 else 0
        for k in range(np.uint64(end)):
            w = side[k] - u
            rows[row, k] = scale * math.sqrt(max(square - w * w, 0.0))
    for k in range(np.uint64(end), np.uint64(half)):
        rows[row, k] = 0.0
    return end


@kernel_part
def cap(rows: Array, row: int, most: int, end: int) -> None:
    """No face sends more than stands before it."""
    for k in range(np.uint64(end)):
        rows[row, k] = min(rows[row, k], rows[most, k])


@kernel_part
def transport_outward(
    rows: Array, here: int, leaving: int, coming: int, side: Array, lam: float, to: Array, zero: int, count: int
) -> None:
    """M - lam |xi| (M_leaving - M_coming) of `count` nodes with xi > 0, into entries of `to` from `zero` on."""
    at = np.uint64(zero)
    for k in range(np.uint64(count)):
        a = lam * side[k]
        to[at + k] = (rows[here, k] - a * rows[leaving, k]) + a * rows[coming, k]


@kernel_part
def transport_inward(
    rows: Array, here: int, leaving: int, coming: int, side: Array, lam: float, to: Array, zero: int, count: int
) -> None:
    """The same of nodes with xi < 0, into entries of `to` from below `zero` downward."""
    at = np.uint64(zero - 1)
    for k in range(np.uint64(count)):
        a = lam * side[k]
        to[at - k] = (rows[here, k] - a * rows[leaving, k]) + a * rows[coming, k]


@kernel_part
def blank(row: Array, begin: int, end: int) -> None:
    """Zero from `begin` to below `end`, nothing if there is nothing between."""
    for j in range(begin, end):
        row[j] = 0.0


@kernel_part
def blend(padded: Array, near: int, far: int, theta: float, f: Array, i: int, begin: int, end: int) -> None:
    """f_i = (1 - theta) near + theta far from `begin` to below `end`; both are views of a row that begin where told."""
    keep = 1.0 - theta
    one, other = np.uint64(near), np.uint64(far)
    for j in range(np.uint64(begin), np.uint64(end)):
        f[i, j] = keep * padded[one + j] + theta * padded[other + j]


@kernel_part
def shift_row(
    padded: Array, low: int, high: int, J: float, h1: float, dxi: float, f: Array, i: int, span: Spans
) -> None:
    """The linear remap of `shift_linear` for one row, which stands in `padded` with n + 1 zeros on both sides.

    The row holds something from `low` to below `high`; where f_i does is kept in span[i], and elsewhere it is zero.
    """
    n = f.shape[1]
    whole, theta = split_shift(J, h1, dxi, n)
    first = n + 1
    if J < 0.0:
        begin, end = max(low - whole - 1, 0), max(high - whole, 0)
        blend(padded, first + whole, first + whole + 1, theta, f, i, begin, end)
    else:
        begin, end = min(low + whole, n), min(high + whole + 1, n)
        blend(padded, first - whole, first - whole - 1, theta, f, i, begin, end)
    for j in range(span[i, 0], min(begin, span[i, 1])):
        f[i, j] = 0.0
    for j in range(max(end, span[i, 0]), span[i, 1]):
        f[i, j] = 0.0
    span[i, 0], span[i, 1] = begin, end


@kernel
def carry(
    h: Array, u: Array, h_left: Array, u_left: Array, h_right: Array, u_right: Array, at_left: Flags, at_right: Flags,
    J: Array, pulled: Array, side: Array, beta: float, dxi: float, averaged: bool, lam: float,
    rows: Array, padded: Array, f: Array, span: Spans,
) -> None:  # fmt: skip
    """f after transport and shift, shape (nx, n), zero outside of `span` before and after.

    h, u are ghosted; `rows`, shape (10, n/2), and `padded`, shape (3 n + 2,) and zero, are room to work in. Where
    at_left and at_right say so a cell takes the states of its face at that wall, else (19).
    """
    nx, half = J.size, side.size
    middle = 3 * half + 1
    old_low, old_high = middle, middle
    ahead, behind, ahead_before, ahead_face, behind_face = 0, 0, 0, 0, 0
    rest = rows.shape[0]  # no number is written out, or each would be compiled for itself
    after, before, here, face, next_face = rest - 10, rest - 8, rest - 6, rest - 4, rest - 2
    for c in range(nx + 2):
        ahead_after = fill_row(h[c], u[c], beta, dxi, averaged, side, rows, after)
        behind_after = fill_row(h[c], -u[c], beta, dxi, averaged, side, rows, after + 1)
        ahead_next, behind_next = 0, 0
        if c > 0 and ((c > 1 and at_right[c - 2]) or (c <= nx and at_left[c - 1])):
            k = c - 1
            ahead_next = fill_row(h_left[k], u_left[k], beta, dxi, averaged, side, rows, next_face)
            behind_next = fill_row(h_right[k], -u_right[k], beta, dxi, averaged, side, rows, next_face + 1)
            cap(rows, next_face, here, ahead_next)
            cap(rows, next_face + 1, after + 1, behind_next)
        if c > 1:
            i = c - 2
            down, up = max(behind, behind_after), max(ahead, ahead_before)
            if at_left[i]:
                down, up = max(down, behind_face), max(up, ahead_face)
            if at_right[i]:
                down, up = max(down, behind_next), max(up, ahead_next)
            leaving, coming = face + 1 if at_left[i] else here + 1, next_face + 1 if at_right[i] else after + 1
            transport_inward(rows, here + 1, leaving, coming, side, lam, padded, middle, down)
            leaving, coming = next_face if at_right[i] else here, face if at_left[i] else before
            transport_outward(rows, here, leaving, coming, side, lam, padded, middle, up)
            blank(padded, old_low, middle - down)
            blank(padded, middle + up, old_high)
            old_low, old_high = middle - down, middle + up
            shift_row(padded, half - down, half + up, J[i], pulled[i], dxi, f, i, span)
        ahead_before, ahead, behind = ahead, ahead_after, behind_after
        ahead_face, behind_face = ahead_next, behind_next
        before, here, after = here, after, before
        face, next_face = next_face, face
    blank(padded, 0, padded.size)
