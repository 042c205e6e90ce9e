"""What errors are measured against: the exact solution that a scene has, or the second order on much finer cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..exact.of_scene import exact_of
from ..macroscopic.closed_form import half_moments_closed
from ..method import Macroscopic
from ..model.boundary import Inflow, ends
from ..model.cells import Cells
from ..run import ENDED
from ..scene import Scene
from ..studies.study import study
from .pace import finer, steady, varied

if TYPE_CHECKING:
    import xarray

FINER = 4
"""The reference has so many times the cells of the finest method that it judges."""

SECOND = Macroscopic(4, order=2)
COURANT = 0.4


@dataclass(frozen=True, eq=False)
class Judge:
    """Heights at the end of a run.

    Attributes:
        what: What they are, in words.
        edges: Edges of cells, shape (n + 1,).
        content: Mass to the left of each edge, shape (n + 1,).
        error: L1(h) of a reference to the one on half its cells, over the mass; 0 for an exact solution.
    """

    what: str
    edges: Array
    content: Array
    error: float

    def averages(self, cells: Cells) -> Array:
        """Heights averaged over `cells`."""
        edges = np.linspace(cells.left, cells.right, cells.count + 1)
        averages: Array = np.diff(np.interp(edges, self.edges, self.content)) / cells.dx
        return averages


def judge(scene: Scene, end: float, finest: float, **options: Any) -> Judge:
    """The judge of methods on at most `finest` times the cells of `scene`; `options` are those of a study."""
    exact = exact_of(scene)
    if exact is not None:
        cells = finer(scene, finest).cells
        try:
            return _judge("the exact solution", cells, exact.averages(cells, end)[0], 0.0)
        except InputError:  # it ends before
            pass
    scenes = [finer(scene, finest * factor) for factor in (FINER // 2, FINER)]
    over: dict[str, list[Any]] = {
        **varied(scenes),
        "clock": [steady(one, SECOND, COURANT, end) for one in scenes],
    }
    found = study(scene, SECOND, over["clock"][0], over, paired=True, **options)
    if not np.isclose(found["t"].to_numpy(), end).all():
        raise InputError(f"trade: the reference stops: {found['verdict'].values[-1]}; take a scene that ends well")
    half, whole = (found["h"].values[k, : one.cells.count] for k, one in enumerate(scenes))
    made = _judge(f"second order on {scenes[1].cells.count} cells", scenes[1].cells, whole, 0.0)
    apart = float(np.abs(made.averages(scenes[0].cells) - half).sum() * scenes[0].cells.dx)
    return _judge(made.what, scenes[1].cells, whole, apart / mass_of(scene, end))


def _judge(what: str, cells: Cells, h: Array, error: float) -> Judge:
    edges = np.linspace(cells.left, cells.right, cells.count + 1)
    return Judge(what, edges, np.concatenate([[0.0], np.cumsum(h) * cells.dx]), error)


def mass_of(scene: Scene, end: float) -> float:
    """The unit of errors: the mass at the start, and what streams at the ends send in until `end`.

    Raises:
        InputError: There is none.
    """
    mass = float(scene.initial()[0].sum() * scene.cells.dx) + end * _coming(scene)
    if not mass > 0.0:
        raise InputError("errors are measured in the mass, and none is there and none comes; take a heap, or a stream")
    return mass


def check_ended(found: xarray.Dataset, what: str, remedy: str) -> None:
    """All runs of a study came to the end.

    Raises:
        InputError: One was stopped; with its verdict and the remedy.
    """
    for kind, verdict in zip(found["verdict_kind"].values, found["verdict"].values, strict=True):
        if kind not in ENDED:
            raise InputError(f"{what} stops: {verdict}; {remedy}")


def _coming(scene: Scene) -> float:
    """Mass per time that streams send through the two ends: their half-range moments of xi M."""
    found, beta = 0.0, np.broadcast_to(scene.beta, scene.x.shape)
    for at, (end, side) in enumerate(zip(ends(scene.boundary), (0, 2), strict=True)):
        if isinstance(end, Inflow):
            found += abs(half_moments_closed(end.h, end.u, float(beta[-at]))[side])
    return found
