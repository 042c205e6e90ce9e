"""What can be turned in the lab: keys of a scene file with a label, a range and a sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..kinetic.equilibrium import EQUILIBRIA
from ..kinetic.force import FORCES
from ..model.chute import ConstantSlope
from ..model.heap import Blocks, Parabola, Profile, Sine
from ..read import SceneFile

DEGREES = 180.0 / math.pi


@dataclass(frozen=True)
class Slider:
    """A number.

    Attributes:
        key: Its dotted name in a scene file; a number names an entry of a list.
        label: For the page.
        low, high, step: Of the slider, in the unit that the page shows.
        told: A sentence about it.
        scale: Shown value over the value in the file; angles are shown in degrees.
        whole: Whether only whole numbers will do.
    """

    key: str
    label: str
    low: float
    high: float
    step: float
    told: str
    scale: float = 1.0
    whole: bool = False

    def given(self, shown: float) -> float | int:
        """What a scene file says for what the slider shows."""
        return round(shown) if self.whole else float(shown) if self.scale == 1.0 else math.radians(shown)

    def shown(self, given: float) -> float:
        """What the slider shows for what a scene file says."""
        return given if self.whole else float(f"{given * self.scale:.12g}")


@dataclass(frozen=True)
class Choice:
    """One of a few: `options` maps what the page says to what a scene file says."""

    key: str
    label: str
    options: dict[str, str | int]
    told: str


Knob = Slider | Choice

EPSILON = Slider("epsilon", "flatness ε", 0.05, 1.0, 0.01, "Height over length of the mass; β = ε k cos ζ.")
ZETA = Slider("chute.zeta", "slope ζ (degrees)", -45, 45, 1, "Of the ground; downhill is to the right.", DEGREES)
DELTA = Slider("friction.delta", "friction angle δ (degrees)", 0, 60, 1, "Friction holds up to this slope.", DEGREES)
BOUNDARY = Choice(
    "boundary", "ends", {"open": "open", "walls": "wall", "periodic": "periodic"}, "What is beyond the two ends."
)
SCHEME = Choice(
    "method.scheme", "scheme",
    {"1  upwind, sliding": 1, "2  balanced, stopping": 2, "3  both, coupled": 3, "4  ours: conservative, at rest": 4},
    "1 to 3 are the paper's; 4 keeps mass, rest and dry ground.",
)  # fmt: skip
COUPLING = Choice(
    "method.coupling", "coupling of scheme 3", {"cell, the paper's": "cell", "face, conservative": "face"},
    "Each cell with fluxes of its own, or one flux for each face.",
)  # fmt: skip
ORDER = Choice("method.order", "order of scheme 4", {"first": 1, "second": 2}, "In space and time.")
EQUILIBRIUM = Choice(
    "method.equilibrium", "equilibrium M on the nodes", {name: name for name in EQUILIBRIA},
    "How the semicircle M stands on the velocity nodes.",
)  # fmt: skip
FORCE = Choice(
    "method.force", "force step", {name: name for name in FORCES}, "The shift of (23), or the derivative of (18)."
)
NODES = Slider("method.velocity.count", "velocity nodes", 8, 256, 2, "Velocity cells between both edges.", whole=True)
COURANT = Slider("clock.number", "Courant number", 0.01, 1.2, 0.01, "Cells that the fastest particle passes in a step.")
END = Slider("clock.end", "end of time", 0.5, 20, 0.5, "When the run is over.")


def knobs_of(file: SceneFile) -> dict[str, list[Knob]]:
    """What can be turned in a scene, by group; what its heap and its method do not read is left out."""
    method = file.method
    scheme: list[Knob] = [SCHEME]
    scheme += [COUPLING] if method.scheme == 3 else [ORDER] if method.scheme == 4 else []
    ground: list[Knob] = [ZETA] if isinstance(file.chute, ConstantSlope) else []
    ground += [DELTA, EPSILON, *([BOUNDARY] if isinstance(file.boundary, str) else [])]
    kinetic: list[Knob] = [NODES, EQUILIBRIUM, FORCE]
    grid: list[Knob] = [] if isinstance(file.heap, Profile) else [_cells(file)]
    return {"The mass": _of_heap(file), "The ground": ground, "The method": [*scheme, *kinetic],
            "Steps": [COURANT, *grid, END]}  # fmt: skip


def _cells(file: SceneFile) -> Slider:
    step = 10 if file.cells.count % 10 == 0 else 1
    return Slider("cells.count", "cells", 40, 640, step, "Equal cells of the x-axis.", whole=True)


def _of_heap(file: SceneFile) -> list[Knob]:
    heap = file.heap
    if isinstance(heap, Blocks):
        return [*_of_blocks(len(heap.heights))]
    speed = Slider("heap.velocity", "velocity", -3, 3, 0.05, "Of all of it, at the start.")
    if isinstance(heap, Parabola):
        return [
            Slider("heap.peak", "height", 0.1, 4, 0.05, "Of the cap; a tenth of it lies around."),
            Slider("heap.steepness", "steepness", 0.2, 10, 0.1, "How fast the cap falls off."),
            speed,
        ]
    if isinstance(heap, Sine):
        return [Slider("heap.start", "where it begins", file.cells.left, file.cells.right, 0.1, "Of the hump."), speed]
    return []


def _of_blocks(count: int) -> list[Knob]:
    names = {1: [""], 2: [" left", " right"], 3: [" left", " middle", " right"]}.get(
        count, [f" {k + 1}" for k in range(count)]
    )
    heights = [
        Slider(f"heap.heights.{k}", f"height{name}", 0, 4, 0.05, "At the start.") for k, name in enumerate(names)
    ]
    speeds = [
        Slider(f"heap.velocities.{k}", f"velocity{name}", -3, 3, 0.05, "At the start; to the right is positive.")
        for k, name in enumerate(names)
    ]
    return [*heights, *speeds]
