"""The force steps, which hand the impulse J over to the density of a cell.

(23) moves f rigidly, f(xi + J/h^{n+1}) <- f(xi); (18) takes a difference of M^n instead. A row stands in a padded
array, entry j + 2 of which belongs to node j, with zeros around it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import formula, kernel, question, routine
from ..method import ForceName
from .equilibrium.questions import both_sides


class ShiftLinear(NamedTuple):
    """Shift (23) by a conservative linear remap; exact in mass and momentum, keeps f >= 0."""

    def push(force, row, M, J, h, dxi, f, i):
        return 0.0, remap(row, J, h, dxi, f, i)


class ShiftExact(NamedTuple):
    """Shift (23) by moving the nodes: values stay, node j of row i stands at xi_j + J_i/h_i^{n+1}."""

    def push(force, row, M, J, h, dxi, f, i):
        for j in range(f.shape[1]):
            f[i, j] = row[j + 2]
        return J / h if h > 0.0 else 0.0, 0.0

    def moves_nodes(force):
        return True


class ShiftPFC(NamedTuple):
    """Shift (23) by the positive and flux-conservative remap of third order.

    After Filbet, Sonnendruecker and Bertrand (2001), Conservative numerical schemes for the Vlasov equation, DOI
    10.1006/jcph.2001.6818. Without its limiter the remap is exact in mass and momentum; where the limiter acts, at the
    rim of the support, the momentum of f errs, and the ledger books it.
    """

    def push(force, row, M, J, h, dxi, f, i):
        return 0.0, shift_pfc(row, J, h, dxi, f, i)


class DerivativeUpwind(NamedTuple):
    """Derivative (18) of M^n by the one-sided difference from where the force pushes."""

    def push(force, row, M, J, h, dxi, f, i):
        nu = J / h / dxi if h > 0.0 else 0.0
        for j in range(f.shape[1]):
            behind = M[j + 1] if nu >= 0.0 else M[j + 3]
            f[i, j] = row[j + 2] - abs(nu) * (M[j + 2] - behind)
        n = f.shape[1]
        return 0.0, abs(nu) * (M[n + 1] if nu >= 0.0 else M[2]) * dxi

    def acts_before(force):
        return True

    def lay_equilibrium(force, flux, beta, h, u, work, padded):
        lay(flux, beta, h, u, work, padded)


class DerivativeCentred(NamedTuple):
    """Derivative (18) of M^n by the centred difference; for study."""

    def push(force, row, M, J, h, dxi, f, i):
        nu = J / h / dxi if h > 0.0 else 0.0
        for j in range(f.shape[1]):
            f[i, j] = row[j + 2] - 0.5 * nu * (M[j + 3] - M[j + 1])
        return 0.0, 0.5 * nu * (M[f.shape[1] + 1] - M[2]) * dxi

    def acts_before(force):
        return True

    def lay_equilibrium(force, flux, beta, h, u, work, padded):
        lay(flux, beta, h, u, work, padded)


class After(NamedTuple):
    """Any force on f, as far as the march is concerned."""


class Before(NamedTuple):
    """Any force on M^n, likewise."""

    def acts_before(force):
        return True


class Unforced(NamedTuple):
    """Nothing pulls, and nothing holds back: f stays."""

    def push(force, row, M, J, h, dxi, f, i):
        for j in range(f.shape[1]):
            f[i, j] = row[j + 2]
        return 0.0, 0.0


@question
def lay_equilibrium(force: Any, flux: Any, beta: float, h: float, u: float, work: Array, padded: Array) -> None:
    """Put M^n into the second padded row, if the force acts on it."""


@routine()
def lay(flux: Any, beta: float, h: float, u: float, work: Array, padded: Array) -> None:
    """M(h, xi - u) as an ascending row."""
    both_sides(flux.equilibrium, h, u, beta, flux.dxi, work[0], work[1])
    half = work.shape[1]
    for j in range(half):
        padded[1, half + 2 + j], padded[1, half + 1 - j] = work[0, j], work[1, j]


@question
def push(
    force: Any, row: Array, M: Array, J: float, h: float, dxi: float, f: Array, i: int
) -> tuple[float, float]:  # fmt: skip
    """Write f_i from the padded row and, for (18), from the padded M^n.

    Returns how far the nodes moved, and the mass that left the window.
    """
    raise NotImplementedError


@question
def moves_nodes(force: Any) -> bool:
    """Whether nodes are moved, and not values."""
    return False


@formula()
def split_shift(J: float, h: float, dxi: float, n: int) -> tuple[int, float]:
    """|J|/h in velocity cells as whole cells and a fraction; n cells when everything leaves, none where it is dry."""
    distance = abs(J) / h / dxi if h > 0.0 else 0.0
    if not distance < n:
        return n, 0.0
    whole = int(distance)
    return whole, distance - whole


@routine()
def remap(row: Array, J: float, h: float, dxi: float, f: Array, i: int) -> float:
    """Move a padded row by J/h into f_i; returns the mass that left the window.

    By whole + theta cells: 1 - theta of a cell lands `whole` cells on, theta behind it.
    """
    n = f.shape[1]
    whole, theta = split_shift(J, h, dxi, n)
    keep, one = 1.0 - theta, np.uint64(1)
    for j in range(n):
        f[i, j] = 0.0
    count = np.uint64(max(n - 1 - whole, 0))  # nodes to which two others come
    near = np.uint64(whole)
    if J < 0.0:
        if whole < n:
            f[i, n - 1 - whole] = keep * row[n + 1]
        for k in range(count):
            f[i, k] = keep * row[k + near + one + one] + theta * row[k + near + one + one + one]
    else:
        if whole < n:
            f[i, whole] = keep * row[2]
        for k in range(count):
            f[i, k + near + one] = keep * row[k + one + one + one] + theta * row[k + one + one]
    gone = 0.0
    for j in range(max(n - whole - 1, 0), n):
        gone += (1.0 if j >= n - whole else theta) * (row[n + 1 - j] if J < 0.0 else row[j + 2])
    return gone * dxi


@routine()
def shift_pfc(row: Array, J: float, h: float, dxi: float, f: Array, i: int) -> float:
    """Shift by J/h with a limited parabola in each cell; returns the mass that left the window."""
    n, lost, peak, before = f.shape[1], 0.0, 0.0, 0.0
    whole, theta = split_shift(J, h, dxi, n)
    back = J < 0.0
    for j in range(n):
        peak = max(peak, row[j + 2])
        f[i, j] = 0.0
    for j in range(n + 1):
        if back:
            first, here, last = row[n + 2 - j], row[n + 1 - j], row[n - j]
        else:
            first, here, last = row[j + 1], row[j + 2], row[j + 3]
        flux = fraction_ahead(first, here, last, peak, theta)
        moved = here - flux + before
        before = flux
        if j + whole < n:
            f[i, n - 1 - j - whole if back else j + whole] = moved
        else:
            lost += moved
    return lost * dxi


@formula()
def fraction_ahead(before: float, here: float, after: float, peak: float, theta: float) -> float:
    """What the foremost `theta` of a cell holds by a parabola with the right averages, limited to stay in [0, peak]."""
    rise, fall = after - here, here - before
    if rise > 0.0:
        rise *= min(1.0, 2.0 * here / rise)
    elif rise < 0.0:
        rise *= min(1.0, -2.0 * (peak - here) / rise)
    if fall > 0.0:
        fall *= min(1.0, 2.0 * (peak - here) / fall)
    elif fall < 0.0:
        fall *= min(1.0, -2.0 * here / fall)
    return theta * (here + (1.0 - theta) * ((2.0 - theta) * rise + (1.0 + theta) * fall) / 6.0)


def moved(f: Array, offset: Array, dxi: float) -> Array:
    """Rows of f, shape (nx, n), moved by `offset` along xi by the linear remap."""
    out = np.zeros_like(f)
    row = np.zeros(f.shape[1] + 4)
    for i in range(f.shape[0]):
        row[2:-2] = f[i]
        push_linear(row, offset[i], dxi, out, i)
    return out


@kernel
def push_linear(row: Array, way: float, dxi: float, f: Array, i: int) -> None:
    """The linear remap of one padded row into f_i."""
    remap(row, way, 1.0, dxi, f, i)


FORCES: dict[ForceName, Any] = {
    "shift-linear": ShiftLinear(),
    "shift-exact": ShiftExact(),
    "shift-pfc": ShiftPFC(),
    "derivative-upwind": DerivativeUpwind(),
    "derivative-centred": DerivativeCentred(),
}
