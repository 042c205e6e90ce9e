"""Schemes 2 and 3: balanced faces (25), and slow cells that stop and start, (21), (22)."""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compiled import short_question
from .bed import LEAST, beta_of, normal, pull
from .formulas import acceleration, is_slow, static_acceleration, updated
from .friction import grip, resistance
from .questions import acts_before, flux_of_cells, flux_of_states, pulled
from .tile import B1, B2, CANDIDATE, F1, F2, G1, G2, H1, HB, RING, SLOW, W1, W2, H, J, Q, U


@short_question
def balanced_at(scheme, slow_here: float, slow_there: float) -> bool:
    """Whether a cell takes the balanced flux (25) at a wall beyond which stands a slow cell, or none."""
    return True


class Balanced(NamedTuple):
    """Balanced faces (25) everywhere; slow cells stop and start, (21), (22)."""

    def fluxes(scheme, order, flux, ground, dt, place, room):
        n, bed, lam = place.n, ground.bed, dt / ground.dx
        for k in range(-2, n + 1):
            room[HB + k] = 0.5 * (room[H + k] + room[H + k + 1])  # (25)
        flux_of_states(flux, scheme, order, bed, place, lam, -2, n + 1, HB, U, HB, U, B1, B2, room)
        flux_of_cells(flux, bed, place, -1, n, W1, W2, room)
        grip_dt = dt * grip(ground.law)
        for k in range(-1, n + 1):
            i = place.begin + k
            R = resistance(ground.law, max(room[H + k], LEAST), abs(room[U + k]), normal(bed, i, room[U + k], grip_dt))
            room[CANDIDATE + k] = updated(room[H + k], lam, room[B1 + k - 1], room[B1 + k])
            room[SLOW + k] = is_slow(room[Q + k], room[CANDIDATE + k], pull(bed, i), R, dt)
        if place.first and ground.left.kind != RING:  # a ghost counts as the cell that it shows
            room[SLOW - 1] = room[SLOW]
        if place.last and ground.right.kind != RING:
            room[SLOW + n] = room[SLOW + n - 1]
        for k in range(-1, n):
            of_left = balanced_at(scheme, room[SLOW + k], room[SLOW + k + 1])
            of_right = balanced_at(scheme, room[SLOW + k + 1], room[SLOW + k])
            room[F1 + k], room[F2 + k] = (room[B1 + k], room[B2 + k]) if of_left else (room[W1 + k], room[W2 + k])
            room[G1 + k], room[G2 + k] = (room[B1 + k], room[B2 + k]) if of_right else (room[W1 + k], room[W2 + k])
        top = 0.0
        for k in range(-1, n):
            c = math.sqrt(2.0 * beta_of(bed, place.begin + k) * max(room[HB + k], 0.0))
            top = max(top, max(abs(room[U + k]), abs(room[U + k + 1])) + c)
        return top

    def has_two_fluxes(scheme):
        return True

    def settle(scheme, order, force, flux, ground, dt, place, room):
        bed, law, dx, grip_dt = ground.bed, ground.law, ground.dx, dt * grip(ground.law)
        for k in range(place.n):
            i, q, here = place.begin + k, room[Q + k], room[H + k]
            s, R = (
                pull(bed, i),
                resistance(law, max(here, LEAST), abs(room[U + k]), normal(bed, i, room[U + k], grip_dt)),
            )
            if room[SLOW + k] == 1.0:  # q^n + mu dt g h^{n+1} = 0 by the choice of mu
                mu = -q / (dt * acceleration(q, s, R) * room[CANDIDATE + k]) if q != 0.0 else 0.0
                g = static_acceleration(room[H + k - 1], room[H + k + 1], s, R, beta_of(bed, i), dx)
                mean = 0.25 * ((room[H + k + 1] + room[H + k - 1]) + 2.0 * here)
                room[J + k] = (1.0 - mu) * (dt * g * mean) - q
            elif q == 0.0:
                room[J + k] = 0.0
            else:
                height = here if acts_before(force) else pulled(order, here, room[H1 + k])
                room[J + k] = dt * acceleration(q, s, R) * height
        return 0.0

    def has_own_density(scheme, order, k, room):
        return balanced_at(scheme, room[SLOW + k], room[SLOW + k + 1]) | balanced_at(
            scheme, room[SLOW + k + 1], room[SLOW + k]
        )

    def own_states(scheme, order, k, room):
        return room[HB + k], room[U + k], room[HB + k], room[U + k + 1]

    def takes_own(scheme, order, k, wall, room):
        return balanced_at(scheme, room[SLOW + k], room[SLOW + k - 1 + 2 * wall])


class CoupledByCell(NamedTuple):
    """By cell, the paper's: slow cells take balanced fluxes, the others upwind ones; not conservative."""

    fluxes = Balanced.fluxes
    has_two_fluxes = Balanced.has_two_fluxes
    settle = Balanced.settle
    has_own_density = Balanced.has_own_density
    own_states = Balanced.own_states
    takes_own = Balanced.takes_own

    def balanced_at(scheme, slow_here, slow_there):
        return slow_here == 1.0


class CoupledByFace(NamedTuple):
    """By face: one flux per face, balanced where both its cells are slow; conservative."""

    fluxes = Balanced.fluxes
    has_two_fluxes = Balanced.has_two_fluxes
    settle = Balanced.settle
    has_own_density = Balanced.has_own_density
    own_states = Balanced.own_states
    takes_own = Balanced.takes_own

    def balanced_at(scheme, slow_here, slow_there):
        return (slow_here == 1.0) & (slow_there == 1.0)
