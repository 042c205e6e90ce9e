"""A run put down in a file: all that its next steps depend on, and all that it has kept so far."""

from __future__ import annotations

import hashlib
import io
import json
import time
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from .errors import InputError
from .store import check_destination, write_bytes
from .value import Number, value

MAGIC = b"kinsim checkpoint 1\n"

Kept = dict[str, NDArray[Any]]
"""Arrays by name; a part of a run says `part/name`."""


@value
class Checkpoint:
    """Where a run is put down, and how often.

    Attributes:
        path: The file; each new state of it replaces the one before, all at once.
        every: Seconds of work from one to the next, >= 0. Ctrl-C and SIGTERM put it down in any case.
    """

    path: str
    every: Annotated[Number, Field(ge=0)] = 60.0


class Keeper:
    """Puts a run down when it is due.

    Attributes:
        trouble: Why it could not be put down the last time, or nothing.
    """

    def __init__(self, checkpoint: Checkpoint, about: Mapping[str, Any]) -> None:
        self._path, self._every = check_destination(checkpoint.path), checkpoint.every
        self._about = {**about, "every": checkpoint.every}
        if self._path.exists() and not _of_this_run(self._path, self._about):
            raise InputError(
                f"{checkpoint.path}: exists, and is no checkpoint of this run; name another file, or remove it"
            )
        self._next = time.monotonic() + self._every
        self.trouble = ""

    def look(self, kept: Callable[[], Kept]) -> None:
        """A block of steps was taken, after which the run is as `kept()` says."""
        if time.monotonic() >= self._next:
            self.put_down(kept())
            self._next = time.monotonic() + self._every

    def put_down(self, kept: Kept) -> None:
        """Write the file; if that fails the older one stays, and the run goes on."""
        try:
            write_checkpoint(self._path, self._about, kept)
            self.trouble = ""
        except InputError as error:
            self.trouble = f"checkpoint {error}"


def _of_this_run(path: Path, about: Mapping[str, Any]) -> bool:
    try:
        kept, _ = read_checkpoint(path)
        return bool({**kept, "every": None} == json.loads(json.dumps({**about, "every": None})))
    except InputError:
        return False


def write_checkpoint(path: Path, about: Mapping[str, Any], kept: Kept) -> None:
    """Write what a run is, and how it stands, with a checksum in front.

    Raises:
        InputError: The file cannot be written.
    """
    packed = io.BytesIO()
    np.savez(packed, about=np.array(json.dumps(about)), **kept)  # type: ignore[arg-type]
    content = packed.getvalue()
    write_bytes(MAGIC + hashlib.sha256(content).hexdigest().encode() + b"\n" + content, path)


def read_checkpoint(path: str | Path) -> tuple[dict[str, Any], Kept]:
    """What the run is, and how it stood.

    Raises:
        InputError: The file is not there, is no checkpoint, or is damaged.
    """
    try:
        if Path(path).exists() and not Path(path).is_file():
            raise InputError(f"{path}: is no ordinary file; name a checkpoint file")
        whole = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"{str(path)[:80]}: cannot be read ({error.strerror}); name a checkpoint file") from None
    if not whole.startswith(MAGIC):
        raise InputError(f"{path}: is no checkpoint of this version of kinsim; name the file given to --checkpoint")
    digest, _, content = whole[len(MAGIC) :].partition(b"\n")
    if hashlib.sha256(content).hexdigest().encode() != digest:
        raise InputError(f"{path}: is damaged, its checksum is wrong; take an older copy, or run from the start")
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            kept = {name: file[name] for name in file.files}
        about = json.loads(str(kept.pop("about")))
    except (ValueError, KeyError, EOFError, MemoryError, zipfile.BadZipFile):
        raise InputError(f"{path}: is no checkpoint that kinsim wrote; run from the start") from None
    return about, kept


def under(name: str, kept: Kept) -> Kept:
    """`kept` as those of the part `name`."""
    return {f"{name}/{key}": array for key, array in kept.items()}


def part(name: str, kept: Kept) -> Kept:
    """Those of the part `name`."""
    return {key[len(name) + 1 :]: array for key, array in kept.items() if key.startswith(f"{name}/")}
