"""The clock: when the states are.

The march asks every clock for `dt`, the length of all steps, or NaN; `number`, the Courant number of all steps, or 0;
`planned`, the lengths of the steps, or nothing; `ticks`, how many are planned, `until`, the time that steps are
shortened to meet, and `most`, after how many steps the run is stopped, or infinity.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from .value import Number, Whole, kind, value

if TYPE_CHECKING:
    from .scene import Scene

Positive = Annotated[Number, Field(gt=0)]


@value
class Fixed:
    """`steps` steps of length `dt` (dimensionless time); fewer with `stop_at_rest`, if the mass came to rest before."""

    dt: Positive
    steps: Annotated[Whole, Field(ge=1)]
    stop_at_rest: bool = False
    kind: Literal["fixed"] = kind("fixed")
    number: ClassVar[float] = 0.0
    until: ClassVar[float] = math.inf
    most: ClassVar[float] = math.inf
    planned: ClassVar[NDArray[np.float64]] = np.empty(0)

    def __post_init__(self) -> None:
        if not self.end < math.inf:
            raise ValueError(f"{self.steps} steps of dt = {self.dt:g} have no finite end; take fewer or shorter ones")

    @property
    def end(self) -> float:
        """The time after the last step."""
        return self.steps * self.dt

    @property
    def ticks(self) -> int:
        """Planned steps."""
        return self.steps

    def steps_at(self, speed: float, dx: float) -> int:
        """All."""
        return self.steps


@value
class Courant:
    """Steps with speed dt/dx = `number`, speed as in (28); the last one lands on the time `end`.

    On ground steeper than the friction angle a step is no longer than the one in which a grain slides from rest through
    `number` cells, however slow all still is.
    With `stop_at_rest` the run ends before, if the mass came to rest; after `most` steps it is stopped, so that it ends
    even if velocities grow without bound.
    """

    number: Positive
    end: Positive
    stop_at_rest: bool = False
    most: Annotated[Whole, Field(ge=1)] = 10_000_000
    kind: Literal["courant"] = kind("courant")
    dt: ClassVar[float] = math.nan
    ticks: ClassVar[float] = math.inf
    planned: ClassVar[NDArray[np.float64]] = np.empty(0)

    @property
    def until(self) -> float:
        """The time after the last step."""
        return self.end

    def steps_at(self, speed: float, dx: float) -> int:
        """The time over the length of a step, at most `most`."""
        dt = min(self.number * dx / speed, self.end) if speed > 0.0 else self.end
        return math.ceil(min(self.end / dt, self.most)) if dt > 0.0 else self.most


@value
class Replay:
    """The steps of another run, so that two runs meet at the same times; `end` is the time after the last one."""

    dts: tuple[Positive, ...]
    end: Annotated[Number, Field(ge=0)]
    kind: Literal["replay"] = kind("replay")
    stop_at_rest: ClassVar[bool] = False
    dt: ClassVar[float] = math.nan
    number: ClassVar[float] = 0.0
    until: ClassVar[float] = math.inf
    most: ClassVar[float] = math.inf

    @property
    def planned(self) -> NDArray[np.float64]:
        """Lengths of the steps."""
        return np.array(self.dts)

    @property
    def ticks(self) -> int:
        """Planned steps."""
        return len(self.dts)

    def steps_at(self, speed: float, dx: float) -> int:
        """All."""
        return len(self.dts)


AnyClock = Fixed | Courant | Replay


def first_courant(scene: Scene, clock: Fixed | Courant) -> float:
    """The Courant number of the first step, in closed form."""
    return clock.number or scene.fastest * clock.dt / scene.cells.dx
