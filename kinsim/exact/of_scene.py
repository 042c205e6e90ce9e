"""The exact solution that a scene has, if one is known here."""

from __future__ import annotations

from ..model.heap import Blocks
from ..scene import Scene
from .accelerated import AcceleratedRiemann
from .riemann import Riemann


def exact_of(scene: Scene) -> Riemann | AcceleratedRiemann | None:
    """Of two blocks that meet: the Riemann solution, in the accelerated frame where gravity outweighs friction.

    It knows no ends, and so only open ones will do.
    """
    heap = scene.heap
    if not isinstance(heap, Blocks) or len(heap.edges) != 1 or scene.boundary != "open":
        return None
    frame = Riemann(heap.heights[0], 0.0, heap.heights[1], 0.0, beta=scene.beta, x0=heap.edges[0])
    if not scene.forced:
        return frame
    sliding = AcceleratedRiemann(frame, pull=scene.chute.sin, resistance=scene.resistance)
    return sliding if sliding.until > 0.0 else None
