"""Scheme 1: upwind faces (19) and sliding friction; never rests."""

from __future__ import annotations

from typing import NamedTuple

from .bed import LEAST, beta_of, normal, pull
from .formulas import acceleration, is_dry, static_acceleration
from .friction import grip, resistance
from .questions import acts_before, flux_of_cells, pulled
from .tile import F1, F2, H1, QHAT, H, J, U


class Upwind(NamedTuple):
    """Upwind faces (19) and sliding friction; never rests."""

    def fluxes(scheme, order, flux, ground, dt, place, room):
        flux_of_cells(flux, ground.bed, place, -1, place.n, F1, F2, room)
        return 0.0

    def settle(scheme, order, force, flux, ground, dt, place, room):
        bed, law, grip_dt = ground.bed, ground.law, dt * grip(ground.law)
        for k in range(place.n):
            i, u = place.begin + k, room[U + k]
            before, here, after, h1 = room[H + k - 1], room[H + k], room[H + k + 1], room[H1 + k]
            dry = is_dry(before, here, after, h1)
            room[H1 + k], room[QHAT + k] = (0.0, 0.0) if dry else (h1, room[QHAT + k])
            s, R = pull(bed, i), resistance(law, max(here, LEAST), abs(u), normal(bed, i, u, grip_dt))
            still = static_acceleration(before, after, s, R, beta_of(bed, i), ground.dx)
            g = still if u == 0.0 else acceleration(u, s, R)
            room[J + k] = dt * g * (here if acts_before(force) else pulled(order, here, room[H1 + k]))
        return 0.0
