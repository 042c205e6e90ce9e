"""Cell averages of solutions that are piecewise polynomials."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model.cells import Cells

GAUSS = 0.5 / math.sqrt(3.0)
"""The two Gauss points lie so far from the middle of a unit interval; they integrate cubics exactly."""


def cell_edges(cells: Cells) -> Array:
    """The walls between cells, shape (cells.count + 1,).

    Raises:
        InputError: `cells` is something else.
    """
    known(cells)
    return cells.left + (cells.right - cells.left) * np.arange(cells.count + 1) / cells.count


def known(cells: Cells) -> None:
    """Let `cells` be cells.

    Raises:
        InputError: It is something else.
    """
    if not isinstance(cells, Cells):
        raise InputError(f"averages: cells is of type {type(cells).__name__}; give kinsim.Cells(left, right, count)")


def averages(
    state: Callable[[Array], tuple[Array, Array]], kinks: Sequence[float], cells: Cells
) -> tuple[Array, Array]:
    """Averages of h and of q = h u over each of the `cells`, each of shape (cells.count,).

    Two Gauss points on each piece of a cell: exact but for rounding where h and h u are cubics between the `kinks`.

    Args:
        state: h, u at places.
        kinks: Where pieces meet, in any order; infinite ones are none.
        cells: The cells.
    """
    edges = cell_edges(cells)
    cuts = np.sort(np.concatenate([edges, np.clip(kinks, edges[0], edges[-1])]))
    cuts = cuts[np.append(np.diff(cuts) > 0.0, True)]
    begin, width = cuts[:-1], np.diff(cuts)
    owner = np.searchsorted(edges, begin, side="right") - 1
    share = width / np.diff(edges)[owner]
    h, q = np.zeros(cells.count), np.zeros(cells.count)
    for point in (0.5 - GAUSS, 0.5 + GAUSS):
        h_there, u_there = state(begin + point * width)
        h += np.bincount(owner, 0.5 * share * h_there, cells.count)
        q += np.bincount(owner, 0.5 * share * (h_there * u_there), cells.count)
    return h, q
