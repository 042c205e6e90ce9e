"""The rows of a density in a step: f after transport, and f after the force, made from the stages of a tile.

M, the densities at faces and f are not stored: three rows of M and two of faces roll through the first-level cache, and
what is written is what somebody asked for.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import Apart, greatest, kernel, perform, question, routine, short_question
from ..schemes.bed import beta_of
from ..schemes.questions import (
    acts_before,
    beta_shown,
    comes_back,
    has_own_density,
    own_states,
    takes_own,
)  # fmt: skip
from ..schemes.tile import H1, Q1, QHAT, TILE, H, J, Model, Place, U
from .equilibrium.questions import both_sides
from .force import lay_equilibrium, push
from .nodes import leaving

CHUNK = 32
"""Cells whose rows after transport wait for the force."""


@routine()
def cell_rows(flux: Any, bed: Any, place: Place, k: int, room: Array, rows: Array, r: int) -> None:
    """M of cell k on both sides of xi = 0, into the rows r and r + 1."""
    beta = beta_of(bed, place.begin + k)
    both_sides(flux.equilibrium, room[H + k], room[U + k], beta, flux.dxi, rows[r], rows[r + 1])


@routine()
def face_rows(
    scheme: Any, order: Any, flux: Any, bed: Any, place: Place, k: int, lam: float, room: Array, rows: Array, r: int
) -> None:
    """The density that stands at face k itself: of its left state for xi > 0, of its right one for xi < 0."""
    i = place.begin + k
    h, u, g, v = own_states(scheme, order, k, room)
    by = beta_shown(order, bed, i, i)
    leaving(flux, scheme, order, h, u, by, room[H + k], room[U + k], beta_of(bed, i), lam, rows[r])
    by = beta_shown(order, bed, i + 1, i)
    beta = beta_of(bed, i + 1)
    leaving(flux, scheme, order, g, -v, by, room[H + k + 1], -room[U + k + 1], beta, lam, rows[r + 1])


@routine()
def transport_rows(
    scheme: Any, order: Any, flux: Any, bed: Any, lam: float, place: Place, first: int, last: int, room: Array,
    work: Array, xi: Array, T: Array, M: Array, B: Array, into: int,
) -> None:  # fmt: skip
    """f_i = M_i - lam xi (M_{i+1/2} - M_{i-1/2}), (23) before the shift, of the cells `first` to below `last`.

    T gets one row for each, from the row `into` on, and so do M and B (of the face right of the cell) if they are
    wanted. The density at a face is upwind, (19), or one of its own.
    """
    before, here, after, at_left, at_right = 0, 2, 4, 6, 8
    cell_rows(flux, bed, place, first - 1, room, work, before)
    cell_rows(flux, bed, place, first, room, work, here)
    if has_own_density(scheme, order, first - 1, room):
        face_rows(scheme, order, flux, bed, place, first - 1, lam, room, work, at_left)
    for k in range(first, last):
        cell_rows(flux, bed, place, k + 1, room, work, after)
        own = has_own_density(scheme, order, k, room)
        if own:
            face_rows(scheme, order, flux, bed, place, k, lam, room, work, at_right)
        own_left, own_right = takes_own(scheme, order, k, 0, room), takes_own(scheme, order, k, 1, room)
        leaves_right, leaves_left = at_right if own_right else here, (at_left if own_left else here) + 1
        comes_left, comes_right = at_left if own_left else before, (at_right if own_right else after) + 1
        if comes_back(scheme, k - 1, room):
            comes_left = here + 1
        if comes_back(scheme, k, room):
            comes_right = here
        row = into + k - first
        step_side(work, here, leaves_right, comes_left, xi, lam, T, row, True)
        step_side(work, here + 1, leaves_left, comes_right, xi, lam, T, row, False)
        if M.shape[0] > 0:
            put_sides(work, here, here + 1, M, row)
        if B.shape[0] > 0:
            put_sides(work, at_right if own else here, (at_right if own else after) + 1, B, row)
        before, here, after = here, after, before
        at_left, at_right = at_right, at_left


@routine()
def step_side(
    work: Array, here: int, leaves: int, comes: int, xi: Array, lam: float, T: Array, row: int, ahead: bool
) -> None:  # fmt: skip
    """M - lam |xi| (M_leaving - M_coming) on one side of xi = 0."""
    half = np.uint64(xi.size)
    a, b, c = np.uint64(here), np.uint64(leaves), np.uint64(comes)
    if ahead:
        for k in range(half):
            share = lam * xi[k]
            T[row, half + k] = (work[a, k] - share * work[b, k]) + share * work[c, k]
    else:
        for k in range(half):
            share = lam * xi[k]
            T[row, half - np.uint64(1) - k] = (work[a, k] - share * work[b, k]) + share * work[c, k]


@routine()
def put_sides(work: Array, p: int, n: int, out: Array, row: int) -> None:
    """Both sides as an ascending row."""
    half = out.shape[1] // 2
    for k in range(half):
        out[row, half + k] = work[p, k]
    for k in range(half):
        out[row, half - 1 - k] = work[n, k]


@question
def beta_at(bed: Any, i: int) -> float:
    """beta of cell i, 0 where nobody needs it."""
    return beta_of(bed, i)


@routine()
def push_rows(
    force: Any, flux: Any, bed: Any, place: Place, first: int, last: int, room: Array, work: Array, padded: Array,
    T: Array, at: int, f: Array, offset: Array, into: int,
) -> float:  # fmt: skip
    """Hand J over to the rows T of the cells `first` to below `last`; returns the mass that leaves, per dx."""
    n, gone = T.shape[1], 0.0
    for k in range(first, last):
        for j in range(n):
            padded[0, j + 2] = T[at + k - first, j]
        height = room[H1 + k]
        if acts_before(force):
            height = room[H + k]
            lay_equilibrium(force, flux, beta_at(bed, place.begin + k), height, room[U + k], work, padded)
        row = into + k - first
        offset[row], lost = push(force, padded[0], padded[1], room[J + k], height, flux.dxi, f, row)
        gone += lost
    return gone


class Wanted(NamedTuple):
    """What a sweep over the cells makes, and rows to work in.

    `span` is the first cell of a chunk, one past the last, and the rows of `T` and of `f` for the first; `f` is f after
    the force, `T` after transport, `M` and `B` the equilibrium and the density at right faces, all of shape (nx, n) or
    without rows if nobody wants them, but that `T` then is room for a chunk; `offset` is how far nodes moved.
    """

    span: Array
    xi: Array
    work: Array
    padded: Array
    T: Array
    f: Array
    M: Array
    B: Array
    offset: Array


@routine()
def transported(
    scheme: Any, order: Any, flux: Any, bed: Any, dx: float, wanted: Wanted, dt: float, place: Place, room: Array
) -> float:
    """f after transport, of a chunk."""
    first, last, into = int(wanted.span[0]), int(wanted.span[1]), int(wanted.span[2])
    rows = wanted.work, wanted.xi, wanted.T, wanted.M, wanted.B
    transport_rows(scheme, order, flux, bed, dt / dx, place, first, last, room, *rows, into)
    return 0.0


@routine()
def pushed(force: Any, flux: Any, bed: Any, wanted: Wanted, dt: float, place: Place, room: Array) -> float:
    """f after the force, of a chunk; returns the mass that left the window, per dx."""
    first, last, at, into = int(wanted.span[0]), int(wanted.span[1]), int(wanted.span[2]), int(wanted.span[3])
    work, padded = wanted.work, wanted.padded
    return push_rows(
        force, flux, bed, place, first, last, room, work, padded, wanted.T, at, wanted.f, wanted.offset, into
    )


class Watch(NamedTuple):
    """Where the least entry of f of a step is found, chunk by chunk.

    Attributes:
        parts: The two parts that make f, as `Apart.row`; none where f is stored.
        span: Where they work.
        f: Room for a chunk, f itself where it is stored, or without rows if nobody asks.
    """

    parts: NDArray[np.int64]
    span: Array
    f: Array


@routine()
def least_entry(watch: Watch, dt: float, place: Place, room: Array) -> float:
    """The least entry of f after the force in a tile, 0 if nobody asks."""
    least, span, f = 0.0, watch.span, watch.f
    if f.shape[0] == 0:
        return least
    if watch.parts.shape[0] == 0:
        for k in range(place.n):
            least = min(least, least_of_row(f, place.begin - 2 + k))
        return least
    for first in range(0, place.n, CHUNK):
        span[0], span[1], span[2], span[3] = first, min(first + CHUNK, place.n), 0.0, 0.0
        for part in range(2):
            perform(watch.parts, part, dt, place.begin, place.n, place.first, place.last, room)
        for k in range(int(span[1]) - first):
            least = min(least, least_of_row(f, k))
    return least


@routine()
def least_of_row(f: Array, i: int) -> float:
    """The least entry of a row."""
    most = -f[i, 0]
    for j in range(f.shape[1]):
        most = greatest(most, -f[i, j])
    return -most


@kernel
def carry(
    parts: NDArray[np.int64], dt: float, rooms: Array, nx: int, span: Array, stored: bool, moves: bool, pushes: bool
) -> float:  # fmt: skip
    """The density of all cells of a step whose stages stand in `rooms`; returns the mass that left the window, per dx.

    `stored` says that T is kept for all cells, `moves` that it is to be made, `pushes` that f is.
    """
    gone = 0.0
    for tile in range(rooms.shape[0]):
        begin = tile * TILE
        n, at_left, at_right = min(TILE, nx - begin), tile == 0, tile == rooms.shape[0] - 1
        for first in range(0, n, CHUNK):
            span[0], span[1] = first, min(first + CHUNK, n)
            span[2], span[3] = begin + first if stored else 0, begin + first
            if moves:
                perform(parts, 0, dt, 2 + begin, n, at_left, at_right, rooms[tile])
            if pushes:
                gone += perform(parts, 1, dt, 2 + begin, n, at_left, at_right, rooms[tile])
    return gone


def wanted_of(nx: int, xi: Array, *names: str) -> Wanted:
    """New arrays for what is asked for, by the names T, f, M and B."""
    half = xi.size
    none = np.zeros((0, 2 * half))
    made = {name: np.zeros((nx, 2 * half)) if name in names else none for name in ("f", "M", "B")}
    T = np.zeros((nx if "T" in names else CHUNK, 2 * half))
    work, padded = np.zeros((10, half)), np.zeros((2, 2 * half + 4))
    return Wanted(np.zeros(4), xi, work, padded, T, made["f"], made["M"], made["B"], np.zeros(nx))


class Carrier:
    """Makes the density of steps of one model, whose parts are compiled apart."""

    def __init__(self, model: Model, nx: int, xi: Array) -> None:
        self._model, self._nx, self._xi = model, nx, xi
        self._made: tuple[Apart, Apart] | None = None

    def __call__(self, dt: float, rooms: Array, *names: str) -> tuple[Wanted, float]:
        """What is asked for, by the names T, f, M and B, and the mass that left the window, per dx."""
        wanted = wanted_of(self._nx, self._xi, *names)
        lost = carry(self._parts(wanted), dt, rooms, self._nx, wanted.span, "T" in names, True, "f" in names)
        return wanted, float(lost)

    def watch(self) -> Watch:
        """What finds the least entry of f of a step, in room for a chunk."""
        self._watched = wanted_of(CHUNK, self._xi, "f")
        return Watch(self._parts(self._watched), self._watched.span, self._watched.f)

    def push(self, rooms: Array, T: Array) -> Wanted:
        """f after the force, of what stands after transport, shape (nx, n)."""
        wanted = wanted_of(self._nx, self._xi, "T", "f")
        wanted.T[:] = T
        carry(self._parts(wanted), 0.0, rooms, self._nx, wanted.span, True, False, True)
        return wanted

    def _parts(self, wanted: Wanted) -> NDArray[np.int64]:
        scheme, order, flux, force, _, ground = self._model
        transports = (scheme, order, flux, ground.bed, ground.dx, wanted)
        pushes = (force, *read_by(force, flux, ground.bed), wanted)
        if self._made is None:
            self._made = Apart(transported, transports, Place), Apart(pushed, pushes, Place)
        else:
            self._made[0].point_at(transports)
            self._made[1].point_at(pushes)
        return np.array([part.row for part in self._made], dtype=np.int64)


class Width(NamedTuple):
    """Of velocity cells, all that a shift asks of a flux."""

    dxi: float


class Level(NamedTuple):
    """Of a bed, all that a shift asks: nothing."""

    def beta_at(bed, i):
        return 0.0


def read_by(force: Any, flux: Any, bed: Any) -> tuple[Any, Any]:
    """What a force reads of a flux and of a bed: velocity cells, and M too if it acts on M."""
    return (flux, bed) if acts_before(force) else (Width(flux.dxi), Level())


class FluxDifference(NamedTuple):
    """U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J), (24)."""


class Resummed(NamedTuple):
    """Sums of f taken anew, the letter of (20); repeats the sampling defect in every step.

    `T` and `f`, shape (nx, n), are f after transport and after the force, `offset` how far its nodes moved, `xi` the
    nodes > 0; the others are to work in.
    """

    T: Array
    f: Array
    offset: Array
    xi: Array
    work: Array
    padded: Array

    def is_summed(projection: Any) -> bool:  # type: ignore[misc]
        return True


@short_question
def is_summed(projection: Any) -> bool:
    """Whether U^{n+1} is summed anew from f, which then has to be stored."""
    return False


@routine()
def sum_transported(
    scheme: Any, order: Any, flux: Any, bed: Any, dx: float, own: Resummed, dt: float, place: Place, room: Array
) -> float:
    """Sum h^{n+1} and qhat anew after transport; returns the mass this makes, per dx."""
    none, at, made = own.T[:0], place.begin - 2, 0.0
    rows = own.work, own.xi, own.T, none, none
    transport_rows(scheme, order, flux, bed, dt / dx, place, 0, place.n, room, *rows, at)
    for k in range(place.n):
        m0, m1 = sum_row(own.T, at + k, own.xi, flux.dxi)
        made += m0 - room[H1 + k]
        room[H1 + k], room[QHAT + k] = m0, m1
    return made


@routine()
def sum_forced(force: Any, flux: Any, bed: Any, own: Resummed, dt: float, place: Place, room: Array) -> float:
    """Sum h^{n+1} and q^{n+1} anew after the force; returns the mass this makes, per dx."""
    at, made = place.begin - 2, 0.0
    push_rows(force, flux, bed, place, 0, place.n, room, own.work, own.padded, own.T, at, own.f, own.offset, at)
    for k in range(place.n):
        m0, m1 = sum_row(own.f, at + k, own.xi, flux.dxi)
        made += m0 - room[H1 + k]
        room[H1 + k], room[Q1 + k] = m0, m1 + own.offset[at + k] * m0
    return made


@routine()
def sum_row(f: Array, i: int, xi: Array, dxi: float) -> tuple[float, float]:
    """Sums of f and xi f over a row, (20), outward from xi = 0 in pairs, so that mirrored sums are mirrored."""
    half, m0, m1 = xi.size, 0.0, 0.0
    for k in range(half):
        p, n = f[i, half + k], f[i, half - 1 - k]
        m0 += p + n
        m1 += (p - n) * xi[k]
    return m0 * dxi, m1 * dxi
