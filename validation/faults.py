"""Nothing lost when things go wrong: faults injected, strangers' files read, and what came of it.

*Lost* counts what must never happen: another exception than the one-line refusal, a file that can no longer be read, a
run that differs in one bit from what it would have been. Scene files and tables are mutated at random: bytes changed,
cut out, doubled, numbers and names of other lines put in; what is read is started, too, where it is small. Whole runs
are drawn from inputs as extreme as can be, in all schemes, orders, equilibria, forces, grids and clocks: each is
refused in one line, or stopped with a verdict that names its step, or sound: all of it finite, its mass in the books.
"""

from __future__ import annotations

import os
import random
import resource
import signal
import time
import tomllib
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from claims import Chapter, run
from laboratory.extremes import draw, wrong

from kinsim import Cells, Checkpoint, Fixed, InputError, Kinetic, Macroscopic, Run, Table, Uniform, load_scene, simulate
from kinsim import resume as go_on
from kinsim.read import built_in, check

SILO = replace(load_scene("silo")[0], cells=Cells(-8, 8, 100))
REQUEST = (SILO, Kinetic(velocity=Uniform(32)), Fixed(0.01, 200), 20)

Counted = tuple[int, int, int]
"""Injected, refused in one line, lost."""


def main(chapter: Chapter) -> None:
    """One row per kind of fault."""
    many = 100_000 if chapter.full else 200
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        found = {
            "whole runs over extreme inputs": extreme(many // 5),
            "scene files, mutated": scenes(many),
            "tables, mutated": tables(folder, many // 10),
            "checkpoints, truncated or with a byte changed": damaged(folder, many // 10),
            "kill -9 at a random moment, then resumed": killed(folder, 20 if chapter.full else 6),
            "disk full while a checkpoint and a run are written": full_disk(folder, 20 if chapter.full else 3),
            "two runs that write the same file": writers(folder, 20 if chapter.full else 3),
        }
    for what, (injected, _, lost) in found.items():
        chapter.claim(f"{what}: injected", injected, low=1)
        chapter.claim(f"{what}: lost", lost, high=0)
    chapter.table("Faults", ("fault", "injected", "refused in one line", "lost"),
                  [[what, *counted] for what, counted in found.items()])  # fmt: skip


def counted(many: int, attempt: Callable[[random.Random], object]) -> Counted:
    """Try `many` times; InputError in one line is a refusal, all else that is raised a loss."""
    refused = lost = 0
    for number in range(many):
        try:
            attempt(random.Random(number))
        except InputError as error:
            refused += 1
            lost += len(str(error).splitlines()) != 1
        except Exception as error:
            lost += 1
            print(f"attempt {number}: {type(error).__name__}: {error}"[:300])
    return many, refused, lost


def extreme(many: int) -> Counted:
    """Heights, velocities, slopes, steps and methods drawn as far out as numbers go; each run is looked over."""

    def attempt(dice: random.Random) -> None:
        asked = draw(dice)
        bad = wrong(asked, asked.run())
        if bad:
            raise RuntimeError(bad)

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return counted(many, attempt)


def mutated(text: bytes, dice: random.Random) -> bytes:
    """A few changes at random."""
    lines = text.splitlines()
    words = [*text.split(), b"1e400", b"-1", b"nan", b"inf", b"9" * 30, b"[[", b"'", b"\xff\xfe", b"10**10**10",
             b'"sin(x"', b"{}", b"true", b"1e-320"]  # fmt: skip
    for _ in range(dice.randint(1, 4)):
        at = dice.randrange(len(text) + 1)
        kind = dice.randrange(5)
        if kind == 0:
            text = text[:at] + bytes([dice.randrange(256)]) + text[at + 1 :]
        elif kind == 1:
            text = text[:at] + text[at + dice.randrange(40) :]
        elif kind == 2:
            text = text[:at] + dice.choice(lines) + b"\n" + text[at:]
        elif kind == 3:
            text = text.replace(dice.choice(words), dice.choice(words), 1)
        else:
            parts = text.split(b"= ")
            place = dice.randrange(1, len(parts)) if len(parts) > 1 else 0
            parts[place] = dice.choice(words) + b"\n" + parts[place].partition(b"\n")[2]
            text = b"= ".join(parts)
    return text


def scenes(many: int) -> Counted:
    """Read, and take two steps of what is small enough."""
    files = [path.read_bytes() for path in built_in().values()]

    def attempt(dice: random.Random) -> None:
        try:
            keys = tomllib.loads(mutated(dice.choice(files), dice).decode("utf-8"))
        except (UnicodeDecodeError, tomllib.TOMLDecodeError):
            raise InputError("no TOML") from None
        file = check(keys, "mutated")
        small = file.cells.count <= 2000 and not (
            isinstance(file.method, Kinetic) and getattr(file.method.velocity, "count", 1) > 256
        )
        if small and dice.random() < 0.05:
            simulate(file.scene, Macroscopic(file.method.scheme), Fixed(1e-6, 2), force=True)

    return counted(many, attempt)


def tables(folder: Path, many: int) -> Counted:
    """A CSV file as the initial mass."""
    path = folder / "table.csv"

    def attempt(dice: random.Random) -> None:
        path.write_bytes(mutated(b"x,h,u\n-1,0.5,0\n0,1.5,0.1\n1,0.25,0\n", dice))
        replace(SILO, heap=Table(str(path)))

    return counted(many, attempt)


def damaged(folder: Path, many: int) -> Counted:
    """Every change is seen."""
    path = folder / "damaged"
    simulate(SILO, Macroscopic(), Fixed(0.01, 10), 5, checkpoint=Checkpoint(str(path), every=0))
    whole = path.read_bytes()

    def attempt(dice: random.Random) -> None:
        at = dice.randrange(len(whole))
        other = whole[:at] + bytes([whole[at] ^ dice.randint(1, 255)]) + whole[at + 1 :]
        path.write_bytes(whole[:at] if dice.random() < 0.5 else other)
        go_on(path)
        raise RuntimeError("damage was not seen")

    return counted(many, attempt)


def killed(folder: Path, many: int) -> Counted:
    """kill -9, resumed, compared with a run that nobody touched."""
    whole, path, lost = simulate(*REQUEST), folder / "killed", 0
    for number in range(many):
        child = os.fork()
        if child == 0:
            if path.exists():
                go_on(path)
            else:
                simulate(*REQUEST, checkpoint=Checkpoint(str(path), every=0))
            os._exit(0)
        while not path.exists():
            time.sleep(0.001)
        time.sleep(random.Random(number).uniform(0.0, 0.1))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    ended = go_on(path)
    lost += not ((ended.h == whole.h).all() and (ended.q == whole.q).all() and (ended.dt == whole.dt).all())
    return many, 0, lost


def full_disk(folder: Path, many: int) -> Counted:
    """No file may grow beyond some kilobytes; the checkpoint before is still there, and the run goes on."""
    path, lost = folder / "full", 0
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    for number in range(many):
        simulate(SILO, Macroscopic(), Fixed(0.01, 5), checkpoint=Checkpoint(str(path), every=0))
        before = path.read_bytes()
        usual = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000 + 100 * number, hard))
        try:
            ended = simulate(SILO, Macroscopic(), Fixed(0.01, 5), checkpoint=Checkpoint(str(path), every=0))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
            signal.signal(signal.SIGXFSZ, usual)
        said = "cannot be written" in str(ended.verdict)
        lost += not (ended.steps == 5 and said and path.read_bytes() == before)
        lost += not refused_when_full(ended, folder / "full.nc", 1000 + 100 * number)
    return many, 0, lost


def refused_when_full(ended: Run, path: Path, most: int) -> bool:
    """A run that does not fit: one line, nothing left there, and no crash."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    usual = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, hard))
    try:
        ended.to_netcdf(path)
    except InputError as error:
        return "cannot be written" in str(error) and not path.exists()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, usual)
    return False


def writers(folder: Path, many: int) -> Counted:
    """Two processes write runs to one file, again and again, while it is read."""
    import xarray

    path, lost = folder / "both.nc", 0
    one = simulate(SILO, Macroscopic(), Fixed(0.01, 10), 1)
    one.to_netcdf(path)
    for _ in range(many):
        children = []
        for _ in range(2):
            child = os.fork()
            if child == 0:
                for _ in range(3):
                    one.to_netcdf(path)
                os._exit(0)
            children.append(child)
        while children:
            try:
                with xarray.open_dataset(path, engine="h5netcdf") as read:
                    lost += not bool((read["h"].to_numpy() == one.h).all())
            except OSError:
                lost += 1
            children = [child for child in children if os.waitpid(child, os.WNOHANG) == (0, 0)]
    return many, 0, lost


if __name__ == "__main__":
    run(main, __doc__)
