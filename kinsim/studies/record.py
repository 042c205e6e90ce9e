"""What a member leaves behind, and the folder that keeps it: written at once, all of it or nothing."""

from __future__ import annotations

import json
import os
import time
import tracemalloc
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..clock import Replay
from ..diagnostics.ledger import EVERY_COLUMN
from ..errors import InputError
from ..run import Run
from ..simulate import simulate
from ..simulation import Progress
from ..store import replacing
from .member import ONCE, Member

LARGEST = {"u_max", "courant", "iterations", "residual"}
LEAST = {"h_min", "f_min"}
"""Columns of the ledger that are extremes since the row before; the others are sums so far, or of the last state."""


@dataclass(frozen=True, eq=False)
class Record:
    """Numbers and words of a member, and its arrays by name."""

    figures: dict[str, Any]
    arrays: dict[str, Array]

    @property
    def replay(self) -> Replay | None:
        """The clock of the same steps once more; None if none were taken, or "dt" was not asked for."""
        dts = self.arrays.get("history_dt", np.empty(0))
        return Replay(tuple(dts.tolist()), end=self.figures["t"]) if dts.size else None


def perform(member: Member, progress: Progress | None = None) -> Record:
    """Run a member; whatever goes wrong becomes its verdict."""
    asked = member.request
    began = time.perf_counter()
    try:
        if asked.traced:
            simulate(member.scene, member.method, member.clock, ONCE, force=asked.force)  # compiling takes memory, too
            tracemalloc.start()
        run = simulate(
            member.scene, member.method, member.clock, asked.save_every, force=asked.force, progress=progress
        )
        found = record_of(run, asked.fields)
        if asked.traced:
            found.figures["memory"] = float(tracemalloc.get_traced_memory()[1])
    except InputError as error:
        return failed("refused", str(error))
    except Exception as error:
        return failed("error", f"{type(error).__name__}: {error}")
    finally:
        if asked.traced:
            tracemalloc.stop()
    found.figures["total_time"] = time.perf_counter() - began
    return found


def failed(kind: str, message: str) -> Record:
    """Of a member that left nothing but a verdict."""
    return Record({"verdict_kind": kind, "verdict": " ".join(message.split())}, {})


def record_of(run: Run, fields: tuple[str, ...]) -> Record:
    """Final state, totals of the ledger, and the histories asked for."""
    arrays = {"x": run.x, "h": run.h[-1], "u": run.u[-1]}
    states = {"h": run.h, "q": run.q, "u": run.u, "dt": run.dt}
    for name in fields:
        arrays[f"history_{name}"] = states[name] if name in states else run.entries.get(name, np.empty(0))
    if fields:
        arrays["history_t"] = run.t
    figures = {
        "verdict_kind": run.verdict.kind, "verdict": str(run.verdict),
        "wall_time": run.wall_time, "steps": run.steps, "cell_steps": run.steps * run.x.size,
        "awake": run.awake, "t": float(run.t[-1]),
        "mass_drift": run.mass_drift, **{name: _total(name, column) for name, column in run.entries.items()},
    }  # fmt: skip
    return Record(figures, arrays)


def check_fields(fields: Sequence[str] | str) -> tuple[str, ...]:
    """`fields`, or the one, if each is known.

    Raises:
        InputError: One is not, or they are no names.
    """
    if not isinstance(fields, (Sequence, np.ndarray)):
        raise InputError(f"study: fields = {fields!r} is no list of names; write fields=['mass'], for example")
    fields = (fields,) if isinstance(fields, str) else tuple(fields)
    known = ("h", "q", "u", *EVERY_COLUMN)
    for name in fields:
        if name not in known:
            raise InputError(f"study: no field {name!r}; choose from {', '.join(known)}")
    return fields


def _total(name: str, column: Array) -> float:
    return float(column.max() if name in LARGEST else column.min() if name in LEAST else column[-1])


class Nowhere:
    """Keeps nothing."""

    words = "none was kept"

    def load(self, key: str) -> Record | None:
        return None

    def save(self, key: str, record: Record) -> None:
        pass


class Folder:
    """Keeps each finished member in a file of its own, named by its key."""

    def __init__(self, path: str | Path, resume: bool) -> None:
        self.path, self._resume = Path(path), resume
        self.words = f"kept in {path}; --resume (resume=True) does the rest"
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{path}: no folder can be made there ({error.strerror}); name another") from None

    def load(self, key: str) -> Record | None:
        """What was kept under `key`, if one resumes and it can be read."""
        file = self.path / f"{key}.npz"
        if not self._resume or not file.exists():
            return None
        try:
            with np.load(file, allow_pickle=False) as kept:
                arrays = {name: kept[name] for name in kept.files}
            figures = json.loads(str(arrays.pop("figures")))
            return Record(figures, arrays) if {"verdict", "verdict_kind"} <= set(figures) else None
        except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
            return None

    def save(self, key: str, record: Record) -> None:
        """Keep `record`."""
        with replacing(self.path / f"{key}.npz") as name, open(name, "wb") as file:
            np.savez(file, allow_pickle=False, figures=np.array(json.dumps(record.figures)), **record.arrays)


Keep = Nowhere | Folder


def kept_in(path: str | Path | None, resume: bool) -> Keep:
    """The folder at `path`, or nowhere.

    Raises:
        InputError: It is no folder, or there is none to resume from.
    """
    if path is not None and not isinstance(path, (str, os.PathLike)):
        raise InputError(f"study: keep = {path!r} names no folder; write keep='FOLDER'")
    if resume and path is None:
        raise InputError("study: resume takes members from a folder, and none is named; write keep='FOLDER', too")
    return Folder(path, resume) if path is not None else Nowhere()
