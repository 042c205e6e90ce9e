"""What the march asks of a scheme, of an order and of a flux; their classes answer.

Loops over rows that are named by arguments run over unsigned indices: a signed one may count from the end, which keeps
a loop from running in vector registers.

A scheme writes, in this order: what it judges (faces that are still or static), the states that meet at faces, the
fluxes that cells take at their walls, and the impulse J.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..compiled import question, routine, short_question
from .bed import beta_of
from .friction import brought
from .tile import N1, N2, P1, P2, Ground, H, Place, U

# ---- an order -----------------------------------------------------------------------------------------------------


@short_question
def rows(order: Any) -> tuple[int, int, int, int]:
    """Where cells show h and u to the right, and h and u to the left."""
    return H, U, H, U


@short_question
def is_sloped(order: Any) -> bool:
    """Whether cells show other states at their walls than their own."""
    return False


@question
def show(order: Any, ground: Ground, dt: float, place: Place, room: Array) -> None:
    """Write what cells show to their walls."""


@short_question
def pulled(order: Any, h: float, h1: float) -> float:
    """H, the height that the impulse acts on."""
    return h1


@short_question
def midway(order: Any, k: int, room: Array) -> float:
    """The velocity of cell k at which friction that depends on it is taken."""
    return room[U + k]  # type: ignore[no-any-return]


@short_question
def beta_shown(order: Any, bed: Any, cell: int, face_at: int) -> float:
    """beta of what a cell shows at a face."""
    return beta_of(bed, cell)


@short_question
def friction_of(
    order: Any, law: Any, h: float, u: float, h1: float, w: float, dt: float, acts: float, n: float
) -> float:
    """The deceleration that the law brings to bear on a cell that would move with w."""
    return brought(law, h1, abs(w), acts, n)


# ---- a scheme -----------------------------------------------------------------------------------------------------


@question
def judge(scheme: Any, ground: Ground, dt: float, place: Place, room: Array) -> bool:
    """Judge the faces; whether a whole tile rests, so that nothing of it changes."""
    return False


@question
def face_states(scheme: Any, order: Any, ground: Ground, place: Place, room: Array) -> None:
    """Write the heights that meet at faces, where they are not those that cells show."""


@question
def fluxes(scheme: Any, order: Any, flux: Any, ground: Ground, dt: float, place: Place, room: Array) -> float:
    """Write the fluxes that cells take at their walls; returns the outermost velocity of states made at faces, or 0."""
    raise NotImplementedError


@short_question
def has_two_fluxes(scheme: Any) -> bool:
    """Whether the cell right of a face takes G at it, and the one left of it F."""
    return False


@question
def settle(
    scheme: Any, order: Any, force: Any, flux: Any, ground: Ground, dt: float, place: Place, room: Array
) -> float:
    """Settle h^{n+1} and qhat, and write J; returns the mass made of heights below 0, per dx."""
    raise NotImplementedError


# what the density asks, of cell k of a tile


@short_question
def has_own_density(scheme: Any, order: Any, k: int, room: Array) -> bool:
    """Whether other densities stand at face k than those of its cells."""
    return is_sloped(order)


@short_question
def own_states(scheme: Any, order: Any, k: int, room: Array) -> tuple[float, float, float, float]:
    """The states left and right of face k of which its density is made: h, u, h, u."""
    hp, up, hm, um = rows(order)
    return room[hp + k], room[up + k], room[hm + k + 1], room[um + k + 1]


@short_question
def takes_own(scheme: Any, order: Any, k: int, wall: int, room: Array) -> bool:
    """Whether cell k takes the density of the face itself at its left (0) or right (1) wall."""
    return has_own_density(scheme, order, k - 1 + wall, room)


@short_question
def comes_back(scheme: Any, k: int, room: Array) -> bool:
    """Whether face k sends the particles of both of its cells back."""
    return False


@short_question
def capped(scheme: Any) -> bool:
    """Whether no face sends more of any velocity than stands before it."""
    return False


# ---- a force on the density ---------------------------------------------------------------------------------------


@short_question
def acts_before(force: Any) -> bool:
    """Whether the force acts on M^n as in (18), with h^n in the impulse, and not on f as in (23), with h^{n+1}."""
    return False


# ---- a flux -------------------------------------------------------------------------------------------------------


@short_question
def leave(flux: Any, h: float, u: float, beta: float) -> tuple[float, float]:
    """First and second moment of M(h, xi - u) over xi > 0.

    What leaves to the left is what leaves to the right of the mirror image, so that mirrored flows are mirrored to the
    bit whatever the formula is.
    """
    raise NotImplementedError


@short_question
def leave_both(flux: Any, h: float, u: float, beta: float) -> tuple[float, float, float, float]:
    """The same to the right, and of the mirror image: of a cell that shows itself to both sides."""
    p1, p2 = leave(flux, h, u, beta)
    n1, n2 = leave(flux, h, -u, beta)
    return p1, p2, n1, n2


@short_question
def extent(flux: Any, low: float, high: float) -> tuple[float, float]:
    """The slowest and the fastest particle of a density between the velocities `low` and `high`."""
    return low, high


@question
def cell_moments(flux: Any, bed: Any, place: Place, low: int, high: int, room: Array) -> None:
    """Half-range moments of the cells `low` to below `high`: P of cell k at face k, N of it at face k - 1."""
    at, i = np.uint64(H + low), np.uint64(place.begin + low)
    u, p, n = np.uint64(U - H), np.uint64(P1 - H), np.uint64(N1 - H - 1)
    second = np.uint64(P2 - P1)
    for k in range(np.uint64(high - low)):
        here = at + k
        p1, p2, n1, n2 = leave_both(flux, room[here], room[here + u], beta_of(bed, i + k))
        room[here + p], room[here + p + second] = p1, p2
        room[here + n], room[here + n + second] = n1, n2


@question
def state_moments(
    flux: Any, scheme: Any, order: Any, bed: Any, place: Place, lam: float, low: int, high: int,
    hl: int, ul: int, hr: int, ur: int, p1: int, p2: int, n1: int, n2: int, room: Array,
) -> None:  # fmt: skip
    """The same of states at faces, for what the cells `low` to below `high` send.

    `hl` and `hr` are the rows of the heights left and right of faces, `ul` and `ur` those of the velocities that cells
    show to their right and to their left; `p1` to `n2` those of the moments.
    """
    i, one = np.uint64(place.begin + low), np.uint64(1)
    count = np.uint64(high - low)
    at_h, at_u, first, second = np.uint64(hl + low), np.uint64(ul + low), np.uint64(p1 + low), np.uint64(p2 + low)
    for k in range(count):
        by = beta_shown(order, bed, i + k, i + k)
        room[first + k], room[second + k] = leave(flux, room[at_h + k], room[at_u + k], by)
    at_h, at_u = np.uint64(hr + low - 1), np.uint64(ur + low)
    first, second = np.uint64(n1 + low - 1), np.uint64(n2 + low - 1)
    for k in range(count):
        by = beta_shown(order, bed, i + k, max(i + k, one) - one)
        room[first + k], room[second + k] = leave(flux, room[at_h + k], -room[at_u + k], by)


@question
def flux_of_cells(flux: Any, bed: Any, place: Place, low: int, high: int, f1: int, f2: int, room: Array) -> None:
    """(24) with the states (19), at the faces `low` to below `high`, into the rows `f1`, `f2`."""
    cell_moments(flux, bed, place, low, high + 1, room)
    meet(low, high, P1, P2, N1, N2, f1, f2, room)


@question
def flux_of_states(
    flux: Any, scheme: Any, order: Any, bed: Any, place: Place, lam: float, low: int, high: int,
    hl: int, ul: int, hr: int, ur: int, f1: int, f2: int, room: Array,
) -> None:  # fmt: skip
    """(24) with states of their own at the faces `low` to below `high`."""
    state_moments(flux, scheme, order, bed, place, lam, low, high + 1, hl, ul, hr, ur, P1, P2, N1, N2, room)
    meet(low, high, P1, P2, N1, N2, f1, f2, room)


@routine()
def meet(low: int, high: int, p1: int, p2: int, n1: int, n2: int, f1: int, f2: int, room: Array) -> None:
    """F = (I1 + I2, I3 + I4), (24): xi > 0 from the left of a face and xi < 0 from the right of it."""
    a1, b1, c1 = np.uint64(p1 + low), np.uint64(n1 + low), np.uint64(f1 + low)
    a2, b2, c2 = np.uint64(p2 + low), np.uint64(n2 + low), np.uint64(f2 + low)
    for k in range(np.uint64(high - low)):
        room[c1 + k] = room[a1 + k] - room[b1 + k]
        room[c2 + k] = room[a2 + k] + room[b2 + k]


@short_question
def limits_outflow(flux: Any) -> bool:
    """Whether what leaves a cell is cut node by node, and so never more than there is."""
    return False
