"""Take up a run that was put down."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from .checkpoint import Checkpoint, Keeper, Kept, read_checkpoint
from .clock import Courant, Fixed, Replay
from .errors import InputError
from .method import Kinetic, Macroscopic
from .run import Run
from .scene import Scene
from .simulate import Loop, Progress, go
from .watch.dump import Dump

KINDS: dict[str, Any] = {
    "scene": Scene, "method": Kinetic | Macroscopic, "clock": Fixed | Courant | Replay, "dumps": list[Dump],
    "save_every": int, "force": bool, "causes": bool, "every": float,
}  # fmt: skip


@np.errstate(all="ignore")
def resume(path: str | Path, *, progress: Progress | None = None) -> Run:
    """Go on with a run that was put down in the file `path`, to the very bits it would have come to without a stop.

    It is put down in the same file again, as often as before.

    Args:
        path: A file that `simulate` with a `Checkpoint` has written.
        progress: As in `simulate`.

    Returns:
        The whole run, as if it had not been stopped; `wall_time` counts the steps whose results it has.

    Raises:
        InputError: The file is not there, is damaged or no checkpoint, or was written by another version.
    """
    request, kept = _read(path)
    try:
        loop = Loop(request["scene"], request["method"], request["clock"], request["save_every"], request["force"])
        loop.watch(request["dumps"], request["causes"])
        loop.restore(kept)
    except (KeyError, ValueError, TypeError, IndexError):
        raise InputError(f"{path}: is no checkpoint that kinsim wrote; run from the start") from None
    loop.keeper = Keeper(Checkpoint(str(path), request["every"]), loop.about())
    return go(loop, progress)


def read_request(path: str | Path) -> dict[str, Any]:
    """What the run in the file `path` is, by the names in `KINDS`.

    Raises:
        InputError: As in `resume`.
    """
    return _read(path)[0]


def _read(path: str | Path) -> tuple[dict[str, Any], Kept]:
    about, kept = read_checkpoint(path)
    if about.get("version") != version("kinsim"):
        raise InputError(
            f"{path}: was written by kinsim {about.get('version')}, this is {version('kinsim')}; take that version"
        )
    try:
        return {name: TypeAdapter(kind).validate_python(about[name]) for name, kind in KINDS.items()}, kept
    except ValidationError as error:
        raise InputError(f"{path}: {error.errors()[0]['msg']}") from None
    except KeyError as missing:
        raise InputError(
            f"{path}: is no checkpoint that kinsim wrote, it has no {missing}; run from the start"
        ) from None
