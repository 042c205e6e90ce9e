"""The exact solution that a scene has, if one is known here."""

from __future__ import annotations

from ..errors import InputError
from ..model.boundary import streams
from ..model.ground import Flat
from ..model.heap import Blocks
from ..scene import Scene
from .accelerated import AcceleratedRiemann
from .riemann import Riemann
from .slide import UniformSlide


def exact_of(scene: Scene) -> Riemann | AcceleratedRiemann | UniformSlide | None:
    """Of two blocks that meet: the Riemann solution, in the accelerated frame where gravity outweighs friction.

    It knows no ends, and so only open ones will do. Of a layer that is the same everywhere, between open or periodic
    ends: the slide.
    """
    if not isinstance(scene.ground, Flat) or streams(scene.boundary):
        return None
    ground, heap = scene.ground, scene.heap
    h, u = heap(scene.cells.x)
    if h[0] > 0.0 and (h == h[0]).all() and (u == u[0]).all() and scene.boundary in ("open", "periodic"):
        return UniformSlide(float(u[0]), ground.pull, ground.hold, float(h[0]))
    if not isinstance(heap, Blocks) or len(heap.edges) != 1 or scene.boundary != "open":
        return None
    (h_left, h_right), (u_left, u_right) = heap.heights, heap.speeds
    frame = Riemann(h_left, u_left, h_right, u_right, beta=ground.beta, x0=heap.edges[0])
    if not scene.forced:
        return frame
    try:
        sliding = AcceleratedRiemann(frame, pull=ground.pull, resistance=ground.hold)
    except InputError:  # some of it slides the other way
        return None
    return sliding if sliding.until > 0.0 else None
