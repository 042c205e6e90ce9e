"""Whether velocity cells resolve M."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..kinetic.velocity import Uniform, Window

WIDEST, THINNEST = 8.0, 2.0
"""Velocity cells that the widest M should cover, and that of the thinnest layer that matters."""

SHARE = 0.01
"""Of the mass, that layers thinner than the thinnest one that matters hold together."""


def unresolved(cells: Uniform | Window | None, bound: float, beta: float | Array, h: Array) -> str:
    """That the velocity cells are too wide for a state, and which would do; empty if they do, or if there are none.

    M(h, .) stands on |xi - u| < c = sqrt(2 beta h), (12).

    Args:
        cells: The velocity cells of a method.
        bound: Their outer edge, of `Uniform`; its cells are 2 bound/count wide.
        beta: beta of (1), a number or of each cell.
        h: Heights, shape (nx,).
    """
    if cells is None or not np.any(h > 0.0):
        return ""
    dxi = cells.dxi if isinstance(cells, Window) else 2.0 * bound / cells.count
    width = np.sort(2.0 * np.sqrt(2.0 * np.broadcast_to(beta, h.shape) * np.maximum(h, 0.0)))
    mass = np.cumsum(width**2)  # as h, where beta is one number
    thin = float(width[np.searchsorted(mass, SHARE * mass[-1])])
    for covered, wanted, where in ((float(width[-1]), WIDEST, "at its widest"), (thin, THINNEST, "in thin layers")):
        if covered < wanted * dxi:
            fine = 0.95 * min(float(width[-1]) / WIDEST, thin / THINNEST)  # so that it may be told in two digits
            remedy = f"dxi <= {fine:.2g}" if isinstance(cells, Window) else f"{2 * math.ceil(bound / fine)} cells"
            return f"M covers {covered / dxi:.2g} velocity cells {where}; take {remedy}"
    return ""
