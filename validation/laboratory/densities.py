"""The two stages of a density alone: transport of rows between neighbours, and one force on every row."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinsim.compiled import generic
from kinsim.kinetic.force import FORCES, push
from kinsim.method import ForceName

Array = NDArray[np.float64]


def transport(f: Array, xi: Array, lam: float) -> Array:
    """f - lam xi (f_{i+1/2} - f_{i-1/2}) with upwind faces, (19); what is outside looks like the outermost cells."""
    wide = np.pad(f, ((1, 1), (0, 0)), mode="edge")
    faces = np.where(xi > 0.0, wide[:-1], wide[1:])
    moved: Array = f - lam * xi * np.diff(faces, axis=0)
    return moved


def force(name: ForceName, f: Array, J: Array, h: Array, dxi: float) -> tuple[Array, Array]:
    """f, shape (cells, nodes), after a force has handed J over to h, and by how much the nodes of each row moved.

    A force that acts on M takes f for it.
    """
    out, offset = np.empty_like(f), np.zeros(f.shape[0])
    _push_rows(FORCES[name], np.pad(f, ((0, 0), (2, 2))), J, h, dxi, out, offset)
    return out, offset


def is_derivative(name: ForceName) -> bool:
    """Whether a force is the derivative (18) of M^n."""
    return hasattr(FORCES[name], "acts_before")


@generic
def _push_rows(force: object, padded: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> None:
    for i in range(out.shape[0]):
        offset[i], _ = push(force, padded[i], padded[i], J[i], h[i], dxi, out, i)
