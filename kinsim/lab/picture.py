"""A density as a picture: rows of pixels, and what the axes must hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..kinetic.velocity import Grid
from .play import Moment, Play


def image_of(moment: Moment, grid: Grid) -> NDArray[np.float32]:
    """f as rows of pixels, lowest velocity first, shape (n, nx); rows whose nodes moved are drawn where they are."""
    if not moment.offset.any():
        return np.ascontiguousarray(moment.f.T, dtype=np.float32)
    places = np.rint((moment.xi - moment.offset[:, None] - moment.xi[0]) / grid.dxi).astype(np.intp)
    inside = (places >= 0) & (places < moment.xi.size)
    f = np.take_along_axis(moment.f, np.clip(places, 0, moment.xi.size - 1), axis=1)
    return np.ascontiguousarray(np.where(inside, f, 0.0).T, dtype=np.float32)


def peak_of(play: Play, moment: Moment) -> float:
    """The largest M of a moment, c/(pi beta)."""
    beta = play.scene.beta
    return float(np.max(np.sqrt(2.0 * beta * moment.h) / (np.pi * beta)))


def span(values: Array, least: float = 0.0) -> tuple[float, float]:
    """From the lowest to the highest value and 0 with a margin, at least so wide."""
    low, high = (float(v) for v in (np.nanmin(values, initial=0.0), np.nanmax(values, initial=0.0)))
    wide = max(high - low, least)
    return low - 0.08 * wide * (low < 0.0), max(high, low + wide) + 0.08 * wide


def steepest(moment: Moment) -> int:
    """The cell at whose right wall the height jumps most; its neighbour there where it is dry."""
    cell = int(np.argmax(np.abs(np.diff(moment.h))))
    return cell if moment.h[cell] > 0.0 else cell + 1
