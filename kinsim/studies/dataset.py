"""All members of a study as one labelled dataset."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..diagnostics.ledger import EVERY_COLUMN
from ..expression import evaluate
from ..measure.compare import method_name
from ..method import Kinetic, Macroscopic
from .record import Record

if TYPE_CHECKING:
    import xarray

WORDS = {
    "verdict_kind": "how it ended, in a word",
    "verdict": "how it ended",
    "wall_time": "time in the time loop",
    "total_time": "time of the run, set-up included",
    "memory": "most memory taken at once",
    "steps": "steps taken",
    "cell_steps": "cells times steps",
    "awake": "share of them that was stepped, the others slept",
    "t": "time at the end",
    "mass_drift": "relative change of mass that no inflow accounts for",
    "x": "cell centre along the chute",
    "h": "height at the end",
    "u": "velocity at the end",
    "history_t": "time of a row",
}
UNITS = {"wall_time": "s", "total_time": "s", "memory": "byte"}
TEXT = ("verdict_kind", "verdict")


def to_dataset(
    over: Mapping[str, list[Any]], paired: bool, repeats: Sequence[Sequence[Record]], attrs: Mapping[str, Any]
) -> xarray.Dataset:
    """Rows of members, the first run of each and the times of all its `repeats`, as variables over what varied."""
    import xarray

    rows = repeats[0]
    shape = (len(rows),) if paired else tuple(len(values) for values in over.values())
    dims = ("member",) if paired else tuple(over)
    variables: dict[str, Any] = {}
    for name in _names([row.figures for row in rows]):
        column = [row.figures.get(name, "" if name in TEXT else np.nan) for row in rows]
        variables[name] = (dims, np.array(column).reshape(shape), _attrs(name))
    for name in _names([row.arrays for row in rows]):
        padded, inner = _padded([row.arrays.get(name) for row in rows], name)
        variables[name] = ((*dims, *inner), padded.reshape(*shape, *padded.shape[1:]), _attrs(name))
    if len(repeats) > 1:
        for name in ("wall_time", "total_time"):
            each = [[row.figures.get(name, np.nan) for row in again] for again in repeats]
            variables[name] = ((*dims, "repeat"), np.array(each).T.reshape(*shape, len(repeats)), _attrs(name))
    coords = {path: ("member" if paired else path, labels(values)) for path, values in over.items()}
    made = xarray.Dataset(variables, coords=coords, attrs=dict(attrs))
    return _shared_places(made, dims)


def labels(values: Sequence[Any]) -> np.ndarray:
    """Numbers as they are, formulas as theirs, anything else in a few words."""
    numbers = [_number(value) for value in values]
    if all(number is not None for number in numbers):
        return np.array(numbers)
    return np.array([_label(value) for value in values], dtype=str)


def _number(value: Any) -> Any:
    if isinstance(value, str):
        try:
            return evaluate(value)
        except ValueError:
            return None
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _label(value: Any) -> str:
    if isinstance(value, (Kinetic, Macroscopic)):
        return method_name(value)
    if hasattr(value, "words"):
        return str(value.words)
    if is_dataclass(value):
        return repr(value)
    return value if isinstance(value, str) else json.dumps(value, default=str)


def _names(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row))


def _padded(arrays: Sequence[np.ndarray | None], name: str) -> tuple[np.ndarray, tuple[str, ...]]:
    """Arrays of unlike lengths as one, NaN where there is nothing."""
    rank = max(array.ndim for array in arrays if array is not None)
    inner = ("row", "cell")[:rank] if name.startswith("history") else ("cell",)
    sizes = [max(array.shape[axis] for array in arrays if array is not None) for axis in range(rank)]
    whole = np.full((len(arrays), *sizes), np.nan)
    for at, array in enumerate(arrays):
        if array is not None:
            whole[at][tuple(slice(0, size) for size in array.shape)] = array
    return whole, inner


def _shared_places(made: xarray.Dataset, dims: tuple[str, ...]) -> xarray.Dataset:
    """x as one axis, where all members have the same."""
    if "x" not in made:
        return made
    x = made["x"].to_numpy().reshape(-1, made.sizes["cell"])
    good = x[~np.isnan(x).all(axis=1)]
    if not (good == good[0]).all():
        return made.set_coords("x")
    return made.drop_vars("x").rename(cell="x").assign_coords(x=("x", good[0], _attrs("x")))


def _attrs(name: str) -> dict[str, str]:
    words = WORDS | EVERY_COLUMN
    plain = name.removeprefix("history_")
    said = words.get(name) or f"{words.get(plain, {'q': 'momentum h u'}.get(plain, plain))}, row by row"
    return {"long_name": said} if name in TEXT else {"long_name": said, "units": UNITS.get(name, "1")}
