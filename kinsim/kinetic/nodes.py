"""Half-range sums of M over a velocity grid: the flux of the kinetic scheme. M is made row by row, and forgotten."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..arrays import Array
from ..compiled import formula, routine
from ..schemes.bed import beta_of
from ..schemes.questions import beta_shown, capped, is_sloped
from ..schemes.tile import N1, N2, P1, P2, H, U
from .equilibrium import both_sides, is_sampled, one_side, reports, wider

ROUNDED = 1.0 - 1e-15
"""Keeps what leaves below what is there, rounding included."""

PASSES = 5
"""How often what a cap took is given back; two or three do in a fan."""

EVEN = 1e-14
"""The share of what is sent that may be missing."""


class Nodes(NamedTuple):
    """Sums over the nodes +-(k + 1/2) dxi, k below n/2, of an equilibrium.

    `w1` and `w2` are what xi and xi^2 weigh, `P`, `N`, `of_cell`, `spare` rows to work in, all of shape (n/2,);
    `report`, shape (6,), collects how often the equilibrium fell back to what, its most iterations, and its largest
    residual.
    """

    equilibrium: Any
    dxi: float
    w1: Array
    w2: Array
    P: Array
    N: Array
    of_cell: Array
    spare: Array
    report: Array

    def leave_both(flux, h, u, beta):
        both_sides(flux.equilibrium, h, u, beta, flux.dxi, flux.P, flux.N)
        p1, p2 = sum_side(flux.P, 0, flux.P.size, flux.w1, flux.w2)
        n1, n2 = sum_side(flux.N, 0, flux.N.size, flux.w1, flux.w2)
        return p1, p2, n1, n2

    def cell_moments(flux, bed, place, low, high, room):
        for k in range(low, high):
            send_both(flux, k, beta_of(bed, place.begin + k), room)

    def state_moments(flux, scheme, order, bed, place, lam, low, high, hl, ul, hr, ur, p1, p2, n1, n2, room):
        for k in range(low, high):
            h, u, i = room[H + k], room[U + k], place.begin + k
            as_it_is = (room[hl + k] == h) & (room[ul + k] == u) & (room[hr + k - 1] == h) & (room[ur + k] == u)
            if as_it_is and not is_sloped(order):
                send_both(flux, k, beta_of(bed, i), room)
                continue
            beta = beta_of(bed, i)
            by = beta_shown(order, bed, i, i)
            begin, end = leaving(flux, scheme, order, room[hl + k], room[ul + k], by, h, u, beta, lam, flux.P)
            room[p1 + k], room[p2 + k] = sum_side(flux.P, begin, end, flux.w1, flux.w2)
            by = beta_shown(order, bed, i, i - 1)
            begin, end = leaving(flux, scheme, order, room[hr + k - 1], -room[ur + k], by, h, -u, beta, lam, flux.P)
            room[n1 + k - 1], room[n2 + k - 1] = sum_side(flux.P, begin, end, flux.w1, flux.w2)

    def limits_outflow(flux):
        return True

    def extent(flux, low, high):
        shift, wide = rim(flux.equilibrium, flux.dxi)
        return -outermost(flux.dxi, shift, wide, -low), outermost(flux.dxi, shift, wide, high)


class Spread(NamedTuple):
    """Where the particles of a density on velocity cells are: see `outermost`."""

    dxi: float
    shift: float
    wide: float

    def extent(flux, low, high):
        dxi, shift, wide = flux
        return -outermost(dxi, shift, wide, -low), outermost(dxi, shift, wide, high)


@formula()
def rim(equilibrium: Any, dxi: float) -> tuple[float, float]:
    """`shift` and `wide` of an equilibrium, by which `outermost` tells how far it reaches."""
    if is_sampled(equilibrium):
        return 0.5, 0.0
    return 0.0, wider(equilibrium, dxi)


@formula()
def outermost(dxi, shift, wide, velocity):
    """The outermost node that is occupied of a density whose fastest particle has this velocity."""
    return (math.ceil((velocity + wide) / dxi - shift) - 0.5) * dxi


@routine("reassoc", "contract", "nsz")
def sum_side(side, begin, end, w1, w2):
    """First and second moment of what stands from `begin` to below `end` of one side."""
    m1, m2 = 0.0, 0.0
    for k in range(begin, end):
        m1 += w1[k] * side[k]
        m2 += w2[k] * side[k]
    return m1, m2


@routine()
def send_both(flux, k, beta, room):
    """The moments of both sides of a cell that shows what it is."""
    P, N = flux.P, flux.N
    if reports(flux.equilibrium):
        tries, defect, fell = both_sides(flux.equilibrium, room[H + k], room[U + k], beta, flux.dxi, P, N)
        flux.report[fell] += 1.0
        flux.report[4], flux.report[5] = max(flux.report[4], tries), max(flux.report[5], defect)
        room[P1 + k], room[P2 + k] = sum_side(P, 0, P.size, flux.w1, flux.w2)
        room[N1 + k - 1], room[N2 + k - 1] = sum_side(N, 0, N.size, flux.w1, flux.w2)
        return
    begin, end = one_side(flux.equilibrium, room[H + k], room[U + k], beta, flux.dxi, P, N)
    room[P1 + k], room[P2 + k] = sum_side(P, begin, end, flux.w1, flux.w2)
    begin, end = one_side(flux.equilibrium, room[H + k], -room[U + k], beta, flux.dxi, N, P)
    room[N1 + k - 1], room[N2 + k - 1] = sum_side(N, begin, end, flux.w1, flux.w2)


@routine()
def leaving(flux, scheme, order, h, u, by, h_cell, u_cell, beta, lam, side):
    """The density G of the state (h, u) that a cell shows, at the nodes xi > 0; returns where it stands.

    No face sends more of a velocity than stands in the cell before it: in first order G is cut to M. In second order
    lam xi G is, and what this takes is given back where there is room, so that mass and momentum stay as they were.
    """
    begin, end = one_side(flux.equilibrium, h, u, by, flux.dxi, side, flux.spare)
    if not capped(scheme) or (h == h_cell and u == u_cell and by == beta):
        return begin, end
    M = flux.of_cell
    first, last = one_side(flux.equilibrium, h_cell, u_cell, beta, flux.dxi, M, flux.spare)
    if not is_sloped(order):
        for k in range(begin, end):
            side[k] = min(side[k], M[k])
        return begin, end
    return cap(flux.w1, flux.w2, M, min(begin, first), max(end, last), lam, flux.dxi, side)


@routine("reassoc", "contract", "nsz")
def cap(w1, w2, M, begin, end, lam, dxi, side):
    """lam xi G <= M, and what that takes of mass and momentum given back as (al + ga e) z (M - z), z = lam xi G.

    What a node would then have beyond M, or below 0, is taken and given back once more. Where M holds no such mass
    and momentum, as at the edge of dry ground, less is sent.
    """
    scale = lam / dxi
    asked1, asked2 = 0.0, 0.0
    for k in range(begin, end):
        asked1, asked2 = asked1 + scale * (w1[k] * side[k]), asked2 + scale * (w2[k] * side[k])
    for k in range(begin, end):
        side[k] = min(side[k], ROUNDED * M[k] / (lam * (k + 0.5) * dxi))
    for _ in range(PASSES):
        lost1, lost2, a, b, c = asked1, asked2, 0.0, 0.0, 0.0
        for k in range(begin, end):
            z, e = lam * (k + 0.5) * dxi * side[k], w2[k] / w1[k]
            lost1, lost2 = lost1 - scale * (w1[k] * side[k]), lost2 - scale * (w2[k] * side[k])
            room = z * (M[k] - z)
            a, b, c = a + room, b + e * room, c + e * e * room
        det = a * c - b * b
        if not (det > 0.0 and abs(lost1) > EVEN * asked1):
            break
        al, ga = (lost1 * c - lost2 * b) / det, (lost2 * a - lost1 * b) / det
        for k in range(begin, end):
            z, e = lam * (k + 0.5) * dxi * side[k], w2[k] / w1[k]
            given = side[k] + (al + ga * e) * side[k] * (M[k] - z)
            side[k] = max(min(given, ROUNDED * M[k] / (lam * (k + 0.5) * dxi)), 0.0)
    return begin, end
