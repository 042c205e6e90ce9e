"""The formulas of the schemes, one face or one cell at a time, each with its number in the paper.

s = sin zeta, R is what friction holds (Definition 1), beta that of (1), lam = dt/dx; g = s - sgn(u) R is the total
acceleration of (1), not gravity.
"""

from __future__ import annotations

import math

from ..compiled import formula

DRY = 2.2250738585072014e-308
"""The smallest height whose velocity has all its digits, the smallest normal number; it scales with no unit."""

ROUNDING = 64.0 * 2.220446049250313e-16
"""By less than this share of the heights around does rounding miss a height."""

SAME = 8e-15
"""Jumps of height that differ by less than this share of the sum of heights are the same but for rounding."""

SHY = 1.0 - 1e-13
"""Keeps the pull at rest below what it balances, rounding of heights a thousand jumps high included."""


@formula()
def clamp(x: float, low: float, high: float) -> float:
    """x, at least low and at most high."""
    return min(max(x, low), high)


# ---- faces --------------------------------------------------------------------------------------------------------


@formula()
def face_speed(h_i: float, u_i: float, h_j: float, u_j: float) -> float:
    """w: how fast the material of a face moves."""
    return (h_i * abs(u_i) + h_j * abs(u_j)) / (h_i + h_j) if h_i + h_j > 0.0 else 0.0


@formula()
def held_share(w: float, least: float, s: float, R: float, beta: float, dx: float) -> float:
    """theta: the share of the balanced jump e that is held at a face whose lower height is `least`.

    theta > 0 where the material of the face is stopped, by friction or by the heap on which it leans, before its
    fastest particle has crossed a cell; no dt is in it, so that no time step makes it chatter. With (4/pi)(|s| - R) a
    leaning pile that moves downhill compresses: (c/pi)(1 - theta)|e| spills back, which is at most what moves.
    """
    slowing = max(R, (abs(s) - R) * (4.0 / math.pi)) * dx
    share = max(1.0 - w * (w + math.sqrt(2.0 * beta * max(least, 0.0))) / slowing, 0.0)
    return share if R > 0.0 else 0.0


@formula()
def is_still(h_i: float, u_i: float, h_j: float, u_j: float, e: float, theta: float) -> float:
    """1 for a face between resting cells whose jump friction balances, else 0."""
    rest = (theta == 1.0) & (u_i == 0.0) & (u_j == 0.0)
    return 1.0 if rest & (abs((h_j - h_i) - e) <= SAME * (h_i + h_j)) else 0.0


@formula()
def pressure(beta_left: float, h_left: float, beta_right: float, h_right: float) -> float:
    """The momentum flux of a still face: the mean pressure of what stands left and right of it."""
    return 0.25 * (beta_left * h_left * h_left) + 0.25 * (beta_right * h_right * h_right)


# ---- second order -------------------------------------------------------------------------------------------------


@formula()
def limited(before: float, after: float, steepest: float) -> float:
    """The mean of two differences of one sign, at most `steepest` times the smaller one; 0 if their signs differ.

    The family of van Leer (1979, Towards the ultimate conservative difference scheme V, DOI
    10.1016/0021-9991(79)90145-1): `steepest` 2 is his limiter, "monotonized central" (mc), 1 is minmod.
    """
    least = min(abs(before), abs(after))
    size = min(0.5 * abs(before + after), steepest * least)
    return math.copysign(size, after) if before * after > 0.0 else 0.0


@formula()
def weight(other: float, h: float) -> float:
    """How much the velocity of a neighbour counts: less where it has less than half of the height.

    So that a film before a front does what dry ground does.
    """
    return min(1.0, 2.0 * other / max(h, DRY))


@formula()
def drained(h: float, out: float, lam: float) -> float:
    """k: the share of its outflow that a cell has; no cell gives more than that."""
    return min(1.0, (1.0 - 4e-16) * h / max(lam * out, DRY))


# ---- update and impulse -------------------------------------------------------------------------------------------


@formula()
def updated(U: float, lam: float, F_left: float, F_right: float) -> float:
    """U^n - lam (F_{i+1/2} - F_{i-1/2}), (24)."""
    return U - lam * (F_right - F_left)


@formula()
def acceleration(v: float, s: float, R: float) -> float:
    """g(v) = s - sgn(v) R for v != 0."""
    return s - R if v > 0.0 else s + R


@formula()
def static_acceleration(before: float, after: float, s: float, R: float, beta: float, dx: float) -> float:
    """g~ of (21), (22): what holds the slope beta h_x, as far as friction reaches."""
    return clamp(beta * ((after - before) / (2.0 * dx)), s - R, s + R)


@formula()
def is_dry(before: float, here: float, after: float, h1: float) -> bool:
    """Whether h^{n+1} is below the smallest normal number, or below 0 by the rounding of the heights around."""
    return (h1 < DRY) & (h1 >= -(ROUNDING * ((before + after) + here)))


@formula()
def is_slow(q: float, h1: float, s: float, R: float, dt: float) -> float:
    """1 for the slow cells of (21), (22): |q| < |dt g(q) h^{n+1}|, h1 of the balanced flux; q = 0 is slow if forced."""
    if q == 0.0:
        return 1.0 if (s != 0.0) | (R != 0.0) else 0.0
    return 1.0 if abs(q) < abs(dt * acceleration(q, s, R) * h1) else 0.0


@formula()
def clipped(qhat: float, h1: float, slowest: float, quickest: float) -> float:
    """qhat with qhat/h^{n+1} among the velocities of the particles that could come; 0 on dry ground.

    In exact arithmetic nothing changes; it is the whole rule for dry ground. Where no particle is seen, none came.
    """
    v = qhat / h1
    among = qhat if v >= slowest else slowest * h1
    among = quickest * h1 if v > quickest else among
    among = qhat if slowest > quickest else among
    return 0.0 if h1 < DRY else among


@formula()
def uphill_pull(h: float, above: float, below: float, net: float, reach: float, theta: float) -> float:
    """The least pull s - R > 0 (`net`) on a cell of a mass that leans downhill, as the faces of a resting one see it.

    The faces of the cell show the lower heights, so that the pressure between them is that of the mean of h and `above`
    (its neighbour uphill), less than that of h; the pull is lessened alike, as far as theta holds. At a toe lower
    than the jump `reach` = (s - R) dx/beta that friction balances, all of the pressure of h is at hand, and that of its
    neighbour `below`; where it moves it is let go slower than the faces give pressure back, with (1 - theta)^2.
    """
    if not (h > 0.0 and theta > 0.0):
        return net
    share = 1.0 - theta * max(h - above, 0.0) / (2.0 * h)
    if h < reach:
        least = min(above, h)
        at_hand = 0.5 * max(h * h - least * least, 0.0) / (h * reach) + max(1.0 - (below - h) / reach, 0.0)
        share = min(share, 1.0 - (1.0 - at_hand) * theta * (2.0 - theta))
    return net * share * SHY


@formula()
def clamped_impulse(qhat: float, low: float, high: float, H: float, dt: float) -> float:
    """J = clamp(-qhat; dt (s - R) H, dt (s + R) H): friction stops, and never reverses."""
    return clamp(-qhat, (dt * low) * H, (dt * high) * H)
