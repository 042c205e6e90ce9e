"""Random piles inside, on and outside the Coulomb bound of Definition 1."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..model.cells import Cells
from ..model.heap import Profile
from ..value import Number, Whole, checked
from .domain import TOO_FAR, NonNegative, Positive, held, numbers

Per = Literal["face", "cell"]
Fill = Annotated[Number, Field(ge=0, le=1e6)]
Seed = Annotated[Whole, Field(ge=0)]


def random_pile(
    cells: Cells, *, pull: float, resistance: float, beta: float, fill: float, per: Per, rng: np.random.Generator | int,
    lowest: float = 1.0,
) -> Profile:  # fmt: skip
    """A random pile at rest whose steepest place takes the share `fill` of the Coulomb bound.

    With differences D that read beta D h = pull + theta R, theta is drawn evenly from [-fill, fill], and one of them is
    set to -fill or fill. So the pile is admissible inside the bound for fill < 1, on it for fill = 1, outside for
    fill > 1. `coulomb_fill` measures it again; it finds `fill` but for the rounding of heights, about
    eps max(h) beta/(R dx).

    per = "face": one-sided differences, D h = (h_{i+1} - h_i)/dx at the faces between cells. Neighbours differ little.
    per = "cell": those of (22), D h = (h_{i+1} - h_{i-1})/(2 dx) in every cell, ghosts copied at both ends. They see no
    zigzag, so that faces of such a pile may be far steeper than the bound. The differences of n cells obey one
    condition, sum (-1)^i D_i = 0, to which the thetas not set are pulled within their bounds.

    Args:
        cells: The cells.
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta > 0 (dimensionless).
        beta: As in (1), > 0.
        fill: Largest |theta|, >= 0 and at most a million.
        per: "face" or "cell".
        rng: Random numbers, or a seed for them.
        lowest: The smallest height, >= 0.

    Returns:
        The heights, at rest.

    Raises:
        InputError: A number is outside its range; or no pile per cell has this fill (few cells on steep ground).
    """
    pull, resistance, beta = _ground(pull, resistance, beta, per)
    fill, lowest = checked("pile: fill", Fill, fill), checked("pile: lowest", NonNegative, lowest)
    dice = rng if isinstance(rng, np.random.Generator) else np.random.default_rng(checked("pile: rng", Seed, rng))
    count = cells.count if per == "cell" else cells.count - 1
    theta = dice.uniform(-fill, fill, count)
    fixed = int(dice.integers(count))
    theta[fixed] = fill * dice.choice([-1.0, 1.0])
    if per == "cell":
        theta = _balance(theta, fixed, fill, pull / resistance)
    with np.errstate(over="ignore", invalid="ignore"):
        rise = (pull + theta * resistance) / beta * cells.dx
        h = np.zeros(cells.count)
        if per == "face":
            h[1:] = np.cumsum(rise)
        else:
            h[1] = 2.0 * rise[0]
            h[2::2] = 2.0 * np.cumsum(rise[1:-1:2])
            h[3::2] = h[1] + 2.0 * np.cumsum(rise[2:-1:2])
        h = h - h.min() + lowest
    if not held(h):
        raise InputError(f"pile: {TOO_FAR}")
    return Profile(h)


def coulomb_fill(h: ArrayLike, dx: float, *, pull: float, resistance: float, beta: float, per: Per) -> float:
    """The largest |beta D h - pull|/R of a pile of heights `h` at rest, D per face or per cell as in `random_pile`.

    Definition 1 holds where it is at most 1.

    Raises:
        InputError: A number is outside its range, or a height is none.
    """
    dx = checked("pile: dx", Positive, dx)
    pull, resistance, beta = _ground(pull, resistance, beta, per)
    heights = numbers("pile: h", h)
    if heights.ndim != 1 or heights.size < 2:
        raise InputError(f"pile: h has the shape {heights.shape}; give two heights or more in a row")
    with np.errstate(over="ignore"):
        if per == "face":
            slope = np.diff(heights) / dx
        else:
            ghosted = np.pad(heights, 1, mode="edge")
            slope = (ghosted[2:] - ghosted[:-2]) / (2.0 * dx)
        found = float(np.max(np.abs(beta * slope - pull)) / resistance)
    if not held(found):
        raise InputError(f"pile: {TOO_FAR}")
    return found


def _ground(pull: float, resistance: float, beta: float, per: Per) -> tuple[float, float, float]:
    if per not in get_args(Per):
        raise InputError(f"pile: per = {per!r} is unknown; take {' or '.join(map(repr, get_args(Per)))}")
    return (
        checked("pile: pull", Number, pull),
        checked("pile: resistance", Positive, resistance),
        checked("pile: beta", Positive, beta),
    )


def _balance(theta: Array, fixed: int, fill: float, tilt: float) -> Array:
    """Pull all but the `fixed` theta towards a bound, so that sum (-1)^i (tilt + theta_i) = 0."""
    sign = 1.0 - 2.0 * (np.arange(theta.size) % 2)
    excess = float(np.sum(sign * theta)) + tilt * (theta.size % 2)
    signed = sign * theta
    bound = -fill if excess > 0.0 else fill
    room = bound - signed
    room[fixed] = 0.0
    if abs(excess) > abs(float(room.sum())) * (1.0 + 1e-12):
        raise InputError(
            f"random_pile: {theta.size} cells with copied ghosts on this slope have no fill of {fill:g}; "
            f"take an even number of cells, more of them, or a larger fill"
        )
    if excess != 0.0:
        signed -= excess / room.sum() * room
    return np.clip(sign * signed, -fill, fill)
