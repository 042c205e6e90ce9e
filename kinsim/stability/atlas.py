"""The atlas: a method along extreme axes, each point run, disturbed and judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..kinetic.velocity import Uniform
from ..measure.compare import method_name
from ..method import Kinetic, Macroscopic
from ..studies.engine import Tell
from ..studies.member import Member, Request
from ..studies.record import Record, failed
from ..studies.study import collect
from .axes import USUAL, Axis, axis
from .judge import MEASURES, judge
from .setting import Setting

if TYPE_CHECKING:
    import xarray

Found = dict[str, Any]


def atlas(
    method: Kinetic | Macroscopic = Macroscopic(),  # noqa: B008
    axes: Sequence[str | tuple[str, str]] = USUAL,
    *,
    steps: int = 200,
    keep: str | Path | None = None,
    resume: bool = False,
    workers: int = 0,
    tell: Tell | None = None,
) -> xarray.Dataset:
    """Run a method where everything is as extreme as can be, and say what became of each point.

    Args:
        method: How it is computed.
        axes: Names of axes, see `kinsim.stability.axes.AXES`, or pairs of them for a plane. The axis "steps", up to
            5000 times as many, takes long and is run when it is named.
        steps: About so many steps are taken at each point.
        keep, resume, workers: As in `study`.
        tell: Called with what is under way and the share that is done.

    Returns:
        A dimension "point" with axis, across (the second axis of a plane, or nothing), value and across_value as they
        are written, class, verdict, and the measures drift, least, rise, growth and variation, all dimensionless;
        see `kinsim.stability.judge`.

    Raises:
        InputError: An axis is unknown.
    """
    asked = [(name, "") if isinstance(name, str) else name for name in axes]
    lines = [(axis(one), axis(two) if two else None) for one, two in asked]
    rows: list[dict[str, Any]] = []
    for number, ((name, across), (first, second)) in enumerate(zip(asked, lines, strict=True)):

        def share(what: str, part: float, at: int = number, of: str = name) -> None:
            if tell:
                tell(f"{of}: {what}", (at + part) / len(asked))

        if first.field == "nodes" and not _counts_nodes(method):
            continue
        places = _places(Setting(method, steps=steps), first, second)
        options = {"keep": keep, "resume": resume, "workers": workers}
        for place, (run, nudged) in zip(places, _run(places, first.forced, share, options), strict=True):
            word, measured = judge(place.setting, run, nudged)
            rows.append({"axis": name, "across": across, "value": place.value, "across_value": place.across_value,
                         "class": word, "verdict": run["verdict"], **measured})  # fmt: skip
    return _dataset(rows, method)


@dataclass(frozen=True)
class Place:
    """A point with its labels; the setting is built when it is needed, for some cannot be."""

    value: str
    across_value: str
    setting: Callable[[], Setting]


def _places(setting: Setting, first: Axis, second: Axis | None) -> list[Place]:
    """Every point."""
    if second is None:
        return [
            Place(first.label(i), "", cache(partial(first.at, setting, value))) for i, value in enumerate(first.values)
        ]
    return [
        Place(first.label(i), second.label(j), cache(lambda a=a, b=b: second.at(first.at(setting, a), b)))
        for (i, a), (j, b) in product(enumerate(first.values), enumerate(second.values))
    ]


def _run(places: Sequence[Place], forced: bool, tell: Tell, options: dict[str, Any]) -> list[tuple[Found, Found]]:
    """What each setting and its disturbed twin leave behind; those that cannot be built are refused."""
    asked = Request(fields=("h", "q", "dt"), force=forced)
    members: dict[str, Member] = {}
    keys: list[str] = []
    found: dict[str, Record] = {}
    for number, place in enumerate(places):
        try:
            setting = place.setting()
            often = replace(asked, save_every=setting.every)
            member = Member(setting.scene, setting.way, setting.clock, often)
        except InputError as error:
            found[f"{number}"] = failed("refused", str(error))
            keys.append(f"{number}")
            continue
        members[member.key] = member
        keys.append(member.key)
    first = collect(list(members.values()), tell=lambda what, part: tell(what, 0.5 * part), **options)
    found |= dict(zip(members, first, strict=True))
    twins = {}
    for place, key in zip(places, keys, strict=True):
        record = found[key]
        same = record.replay
        if same and record.figures["verdict_kind"] != "refused":
            member, heap = members[key], place.setting().nudged
            forced_too = replace(member.request, force=True)
            twins[key] = Member(replace(member.scene, heap=heap), member.method, same, forced_too)
    second = collect(list(twins.values()), tell=lambda what, part: tell(what, 0.5 + 0.5 * part), **options)
    again = dict(zip(twins, second, strict=True))
    return [(_row(found[key]), _row(again.get(key, failed("refused", "")))) for key in keys]


def _row(record: Record) -> Found:
    return {**record.figures, **record.arrays}


def _counts_nodes(method: Kinetic | Macroscopic) -> bool:
    return isinstance(method, Kinetic) and isinstance(method.velocity, Uniform)


def _dataset(rows: Sequence[dict[str, Any]], method: Kinetic | Macroscopic) -> xarray.Dataset:
    import xarray

    words = ("axis", "across", "value", "across_value", "class", "verdict")
    columns = {name: ("point", np.array([row[name] for row in rows], dtype=str)) for name in words}
    numbers = {name: ("point", np.array([row[name] for row in rows]), {"units": "1"}) for name in MEASURES}
    return xarray.Dataset(
        columns | numbers,
        attrs={"title": "kinsim atlas", "method": method_name(method)},
    )
