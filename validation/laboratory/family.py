"""Runs of a family as a study: each scene, method and clock side by side, or one of them for all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinsim import Kinetic, Macroscopic, Scene
from kinsim.clock import AnyClock
from kinsim.run import ENDED
from kinsim.studies.member import Member, Request
from kinsim.studies.record import Record
from kinsim.studies.study import collect

Method = Kinetic | Macroscopic


def family(
    scenes: Scene | Sequence[Scene],
    methods: Method | Sequence[Method],
    clocks: AnyClock | Sequence[AnyClock],
    force: bool = False,
) -> list[Record]:
    """The record of each member, with its last h and u, the rows of q and all dt.

    Raises:
        RuntimeError: One did not come to its end.
    """
    lists = [list(each) if isinstance(each, Sequence) else [each] for each in (scenes, methods, clocks)]
    count = max(map(len, lists))
    each = zip(*(one * count if len(one) == 1 else one for one in lists), strict=True)
    found = collect([Member(*one, Request(("q", "dt"), force=force)) for one in each])
    for record in found:
        if record.figures["verdict_kind"] not in ENDED:
            raise RuntimeError(f"a run that did not come to its end has no error: {record.figures['verdict']}")
    return found


def distance(one: Record, other: Record, scene: Scene) -> float:
    """L1(h) at the end."""
    return float(np.abs(one.arrays["h"] - other.arrays["h"]).sum() * scene.cells.dx)
