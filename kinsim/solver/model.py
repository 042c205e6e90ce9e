"""A scene and a method as kernels see them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..compiled import Apart, answers, plain, routine
from ..errors import InputError
from ..kinetic.equilibrium import EQUILIBRIA, weights
from ..kinetic.force import FORCES, After, Before, Unforced
from ..kinetic.gauss_jacobi import gauss_jacobi
from ..kinetic.nodes import Nodes, Spread, rim
from ..kinetic.rows import FluxDifference, Resummed, is_summed, read_by, sum_forced, sum_transported
from ..kinetic.velocity import Fitted, Grid
from ..macroscopic.closed_form import ClosedForm
from ..macroscopic.outside import outside
from ..method import LIMITERS, Kinetic, Macroscopic
from ..model.boundary import Boundary, Inflow, ends
from ..model.ground import Flat, Smooth
from ..scene import Scene
from ..schemes.bed import Curve, Plane, beta_of
from ..schemes.friction import law_of
from ..schemes.order import First, Second
from ..schemes.questions import acts_before, face_states, has_two_fluxes, is_sloped, judge, show
from ..schemes.reflecting import Reflecting
from ..schemes.scheme1 import Upwind
from ..schemes.scheme4 import Held
from ..schemes.scheme23 import Balanced, CoupledByCell, CoupledByFace
from ..schemes.tile import OPEN, RING, STREAM, WALL, End, Ground, Model, Place
from .sweep import Shape, judged, looked, met, sent, settled, shown

KINDS = {"open": OPEN, "wall": WALL, "periodic": RING}


def model_of(scene: Scene, method: Kinetic | Macroscopic, grid: Grid | None) -> Model:
    """What the march takes; `grid` are the velocity cells of a method that has some.

    Raises:
        InputError: The scheme is not made for the scene.
    """
    force, projection = Unforced(), FluxDifference()
    if grid is not None and isinstance(method, Kinetic):
        force = FORCES[method.force] if scene.forced else Unforced()
        if method.projection == "re-summed":
            half, n = grid.half, grid.count
            arrays = (np.zeros((scene.cells.count, n)), np.zeros((scene.cells.count, n)), np.zeros(scene.cells.count))
            projection = Resummed(*arrays, grid.side, np.zeros((10, half)), np.zeros((2, n + 4)))  # type: ignore[assignment]
    order = Second(LIMITERS[method.limiter]) if method.order == 2 else First()
    parts = scheme_of(method, scene), order, flux_of(method, grid), force, projection, ground_of(scene)
    return plain(Model(*parts))  # type: ignore[no-any-return]


def scheme_of(method: Kinetic | Macroscopic, scene: Scene) -> Any:
    """The scheme of a method; without any force no cell is slow, so that scheme 3 is scheme 1.

    Raises:
        InputError: A scheme of the paper on a smooth chute.
    """
    if method.scheme == 4:
        return Reflecting() if method.statics == "reflect" else Held()
    if not isinstance(scene.ground, Flat):
        raise InputError(f"scheme {method.scheme} is made for a constant slope; on a smooth chute take scheme 4")
    if method.scheme == 1 or (method.scheme == 3 and not scene.forced):
        return Upwind()
    if method.scheme == 2:
        return Balanced()
    return CoupledByCell() if method.coupling == "cell" else CoupledByFace()


def flux_of(method: Kinetic | Macroscopic, grid: Grid | None) -> Any:
    """The numerical flux of a method."""
    if isinstance(method, Macroscopic):
        return ClosedForm() if method.flux is None else outside(method.flux)
    if isinstance(method.velocity, Fitted):
        return gauss_jacobi(method.velocity.count)
    assert grid is not None
    rows = (np.zeros(grid.half) for _ in range(4))
    return Nodes(EQUILIBRIA[method.equilibrium], grid.dxi, *weights(method.equilibrium, grid), *rows, np.zeros(6))


def ground_of(scene: Scene) -> Ground:
    """Law, bed and ends of a scene."""
    left, right = (_end(end) for end in ends(scene.boundary))
    return Ground(law_of(scene.friction), _bed(scene.ground, scene.boundary), left, right, scene.cells.dx)


def _end(end: str | Inflow) -> End:
    return End(STREAM, end.h, end.u) if isinstance(end, Inflow) else End(KINDS[end], 0.0, 0.0)


def _bed(ground: Flat | Smooth, boundary: Boundary) -> Plane | Curve:
    if isinstance(ground, Flat):
        return Plane(ground.pull, ground.cos, ground.beta)
    mode: Any = "wrap" if boundary == "periodic" else "edge"
    beta = np.pad(ground.ghosted, 1, mode="edge")
    if boundary == "periodic":
        beta[0], beta[-1] = beta[-5], beta[4]

    def cells(values: Array) -> Array:
        return np.pad(values, 2, mode=mode)

    def faces(values: Array) -> Array:  # face i at place i, between the cells i and i + 1; the last place is no face
        padded = np.concatenate([values[:1], values, values[-1:], values[-1:]])
        if boundary == "periodic":
            padded[0], padded[-2], padded[-1] = values[-2], values[1], values[2 % values.size]
        return padded

    face_beta, left, right = ground.beta_face, ground.ghosted[:-1], ground.ghosted[1:]
    tilt = faces((right - left) / (4.0 * face_beta))
    uneven = faces(np.cbrt(right / left) - 1.0), faces(np.cbrt(left / right) - 1.0)
    return Curve(
        cells(ground.pull), cells(ground.cos), cells(ground.bend), beta,
        faces(ground.pull_face), faces(ground.cos_face), faces(face_beta), tilt, *uneven,
    )  # fmt: skip


@routine()
def nothing(dt: float, place: Place, room: Array) -> float:
    """Of what a scheme has no need."""
    return 0.0


def parts_of(model: Model) -> list[Apart]:
    """The parts of a step, compiled for the classes that each of them reads."""
    scheme, order, flux, force, projection, ground = model
    reads = Before() if acts_before(force) else After()

    def part(function: Any, *values: Any) -> Apart:
        return Apart(function, values, Place)

    none = part(nothing)
    summed = is_summed(projection)
    return [
        part(judged, scheme, ground) if answers(scheme, judge) else none,
        part(shown, order, ground) if answers(order, show) else none,
        part(met, scheme, order, ground) if answers(scheme, face_states) else none,
        part(sent, scheme, order, flux, ground),
        part(sum_transported, scheme, order, flux, ground.bed, ground.dx, projection) if summed else none,
        part(settled, scheme, order, reads, _extent_of(flux), ground),
        part(sum_forced, force, *read_by(force, flux, ground.bed), projection) if summed else none,
        part(looked, ground.bed),
    ]


def _extent_of(flux: Any) -> Any:
    """A flux that has the same extent, and no more to be compiled for than that."""
    return Spread(flux.dxi, *rim(flux.equilibrium, flux.dxi)) if isinstance(flux, Nodes) else ClosedForm()


def shape_of(model: Model) -> Shape:
    """What the march itself asks of a model."""
    ground, flux, nx = model.ground, model.flux, np.size(getattr(model.ground.bed, "s", 0.0))
    dxi = shift = wide = outermost = 0.0
    if isinstance(flux, Nodes):
        dxi, outermost = flux.dxi, (flux.w1.size - 0.5) * flux.dxi
        shift, wide = rim(flux.equilibrium, flux.dxi)
    betas = (beta_of(ground.bed, 1), beta_of(ground.bed, nx - 2)) if nx > 1 else (ground.bed.beta, ground.bed.beta)
    two, sloped, summed = has_two_fluxes(model.scheme), is_sloped(model.order), is_summed(model.projection)
    return Shape(
        ground.dx, ground.left, ground.right, float(two), float(sloped), float(summed), dxi, shift, wide, outermost,
        *map(float, betas),
    )  # fmt: skip
