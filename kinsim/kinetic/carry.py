"""f after transport and shift in one sweep over the cells, from what a step has settled: M is made again, never stored.

Three rows of M roll through the first-level cache. The sweep does what the rooms do to each entry, in their order: the
bits are theirs. M is made of blocks of nodes that cover its support, for what a block holds besides is zero, and a loop
over whole blocks runs in vector registers to its end.

Loops run over unsigned indices of whole arrays: a signed one may count from the end in numpy, and a slice counts
references, and either keeps a short loop from running in vector registers.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner, kernel_part
from .equilibrium.averages import antiderivative
from .shift import split_shift

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Spans = NDArray[np.int64]
Faces = tuple[Array, Array, Array, Array, Flags, Flags]
Place = np.uint64

BLOCK = 8
"""Nodes of a block."""


@kernel_inner
def cover(h: float, u: float, beta: float, dxi: float, n: int) -> tuple[int, int]:
    """The first of the nodes that cover the support of M(h, xi - u), and one past the last, in whole blocks."""
    c, half = math.sqrt(2.0 * beta * max(h, 0.0)), 0.5 * n
    low = int(min(max((u - c) / dxi + half - 1.0, 0.0), n)) & -BLOCK
    high = (int(min(max((u + c) / dxi + half + 1.0, 0.0), n)) + BLOCK) & -BLOCK
    return (low, min(high, n)) if c > 0.0 else (low, low)


@kernel_part
def fill_row(
    h: float, u: float, beta: float, dxi: float, averaged: bool, at: Array, low: int, high: int, rows: Array, row: Place
) -> None:
    """M(h, xi - u) from node `low` to below `high`, elsewhere zero; `at` are the nodes, or the edges around them."""
    begin, end = Place(low), Place(high)
    for j in range(begin):
        rows[row, j] = 0.0
    if averaged:
        c, scale = math.sqrt(2.0 * beta * max(h, 0.0)), h / (math.pi * dxi)
        for j in range(begin, end):
            rows[row, j] = antiderivative((at[j + Place(1)] - u) / c)
        below = antiderivative((at[begin] - u) / c)
        for j in range(begin, end):
            above = rows[row, j]
            rows[row, j] = max(scale * (above - below), 0.0)
            below = above
    else:
        square, scale = 2.0 * beta * max(h, 0.0), 1.0 / (math.pi * beta)
        for j in range(begin, end):
            w = at[j] - u
            rows[row, j] = scale * math.sqrt(max(square - w * w, 0.0))
    for j in range(end, Place(rows.shape[1])):
        rows[row, j] = 0.0


@kernel_part
def cap(rows: Array, row: Place, most: Place, low: int, high: int) -> None:
    """No face sends more than stands before it."""
    for j in range(Place(low), Place(high)):
        rows[row, j] = min(rows[row, j], rows[most, j])


@kernel_part
def transport_row(
    rows: Array, here: Place, leaving: Place, coming: Place, speed: Array, lam: float, low: int, high: int,
    padded: Array,
) -> None:  # fmt: skip
    """M - lam |xi| (M_leaving - M_coming) of nodes on one side of xi = 0, one entry further in `padded`."""
    for j in range(Place(low), Place(high)):
        a = lam * speed[j]
        padded[j + Place(1)] = (rows[here, j] - a * rows[leaving, j]) + a * rows[coming, j]


@kernel_part
def blend(padded: Array, near: int, far: int, theta: float, f: Array, i: int, begin: int, end: int) -> None:
    """f_i = (1 - theta) near + theta far from `begin` to below `end`, of what stands in `padded` from there on."""
    keep = 1.0 - theta
    at, one, other = Place(begin), Place(near), Place(far)
    for k in range(Place(end - begin)):
        f[i, at + k] = keep * padded[one + k] + theta * padded[other + k]


@kernel_part
def shift_row(
    padded: Array, low: int, high: int, J: float, h1: float, dxi: float, f: Array, i: int, span: Spans
) -> None:
    """The linear remap of `shift_linear` for one row, which stands in `padded` one entry further.

    The row holds something from `low` to below `high`; where f_i does is kept in span[i], and elsewhere it is zero.
    """
    n = f.shape[1]
    whole, theta = split_shift(J, h1, dxi, n)
    padded[low], padded[high + 1] = 0.0, 0.0
    if J < 0.0:
        begin, end = max(low - whole - 1, 0), max(high - whole, 0)
        blend(padded, begin + whole + 1, begin + whole + 2, theta, f, i, begin, end)
    else:
        begin, end = min(low + whole, n), min(high + whole + 1, n)
        blend(padded, begin - whole + 1, begin - whole, theta, f, i, begin, end)
    for j in range(Place(span[i, 0]), Place(min(begin, span[i, 1]))):
        f[i, j] = 0.0
    for j in range(Place(max(end, span[i, 0])), Place(span[i, 1])):
        f[i, j] = 0.0
    span[i, 0], span[i, 1] = begin, end


@kernel
def carry(
    h: Array, u: Array, faces: Faces | None, J: Array, pulled: Array, at: Array, speed: Array, beta: float, dxi: float,
    averaged: bool, lam: float, cells: Spans, rows: Array, padded: Array, f: Array, span: Spans,
) -> None:  # fmt: skip
    """f after transport and shift, shape (nx, n), zero outside of `span` before and after.

    h, u are ghosted; `at` are the nodes, or with `averaged` the n + 1 edges, and `speed` is |xi|. `faces` are h_left,
    u_left, h_right, u_right and at_left, at_right: where these say so a cell takes the states of its face at that wall,
    else (19). `cells`, shape (nx + 2, 2), `rows`, shape (7, n), and `padded`, shape (n + 2,), are room to work in.
    """
    nx, n = J.size, speed.size
    half = n // 2
    for c in range(nx + 2):
        cells[c, 0], cells[c, 1] = cover(h[c], u[c], beta, dxi, n)
    low_face, high_face, low_next, high_next = half, half, half, half
    one = Place(1)
    before, here, after, face, next_face = Place(0), one, Place(2), Place(3), Place(5)
    for c in range(nx + 2):
        fill_row(h[c], u[c], beta, dxi, averaged, at, cells[c, 0], cells[c, 1], rows, after)
        if faces is not None:
            h_left, u_left, h_right, u_right, at_left, at_right = faces
            low_next, high_next = half, half
            if c > 0 and ((c > 1 and at_right[c - 2]) or (c <= nx and at_left[c - 1])):
                k = c - 1
                low, high = cover(h_left[k], u_left[k], beta, dxi, n)
                low, high_next = max(low, half), max(high, half)
                fill_row(h_left[k], u_left[k], beta, dxi, averaged, at, low, high_next, rows, next_face)
                cap(rows, next_face, here, low, high_next)
                low, high = cover(h_right[k], u_right[k], beta, dxi, n)
                low_next, high = min(low, half), min(high, half)
                fill_row(h_right[k], u_right[k], beta, dxi, averaged, at, low_next, high, rows, next_face + one)
                cap(rows, next_face + one, after, low_next, high)
        if c > 1:
            i = c - 2
            low = min(cells[i, 0], min(cells[i + 1, 0], cells[c, 0]))
            high = max(cells[i, 1], max(cells[i + 1, 1], cells[c, 1]))
            if faces is None:
                transport_row(rows, here, here, after, speed, lam, low, min(high, half), padded)
                transport_row(rows, here, here, before, speed, lam, max(low, half), high, padded)
            else:
                at_left, at_right = faces[4], faces[5]
                low, high = min(low, min(low_face, low_next)), max(high, max(high_face, high_next))
                leaving, coming = face + one if at_left[i] else here, next_face + one if at_right[i] else after
                transport_row(rows, here, leaving, coming, speed, lam, low, min(high, half), padded)
                leaving, coming = next_face if at_right[i] else here, face if at_left[i] else before
                transport_row(rows, here, leaving, coming, speed, lam, max(low, half), high, padded)
            shift_row(padded, low, high, J[i], pulled[i], dxi, f, i, span)
        low_face, high_face = low_next, high_next
        before, here, after = here, after, before
        face, next_face = next_face, face
