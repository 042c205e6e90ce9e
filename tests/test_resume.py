"""A run that is put down and taken up again comes to the very same bits; what is put down survives what goes wrong."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import kinsim.checkpoint
from kinsim import (
    Cells,
    Checkpoint,
    Courant,
    Dump,
    Fitted,
    Fixed,
    InputError,
    Kinetic,
    Macroscopic,
    Run,
    Table,
    Uniform,
    Window,
    load_scene,
    resume,
    simulate,
)
from kinsim.checkpoint import read_checkpoint, write_checkpoint
from kinsim.cli import app

SILO = replace(load_scene("silo")[0], cells=Cells(-8, 8, 60))

CASES = {
    "closed": (Macroscopic(), Fixed(0.01, 60), {}),
    "closed, second, Courant": (Macroscopic(order=2), Courant(0.4, 0.5), {}),
    "fitted": (Kinetic(1, Fitted(3)), Fixed(0.01, 60), {}),
    "grid, dumps, causes": (
        Kinetic(velocity=Uniform(16)),
        Courant(0.8, 0.5),
        {"dumps": [Dump(every=7)], "causes": True},
    ),
    "window, a dump": (Kinetic(3, Window(0.3)), Fixed(0.01, 60), {"dumps": [Dump(every=7, xi=(-1, 1))]}),
    "entropic, re-summed": (Kinetic(1, Uniform(32), "entropic", projection="re-summed"), Fixed(0.01, 30), {}),
    "shift-exact": (Kinetic(1, Window(0.2), force="shift-exact"), Fixed(0.01, 60), {"dumps": [Dump(every=9)]}),
    "reflecting": (Kinetic(velocity=Uniform(16), statics="reflect"), Fixed(0.01, 60), {}),
    "jump": (Kinetic(velocity=Uniform(16), statics="reflect"), Courant(0.9, 8.0), {"scene": "jump"}),
    "crest, second": (Macroscopic(order=2), Courant(0.4, 2.0), {"scene": "crest"}),
}


def same(one: Run, other: Run) -> None:
    """Whether two runs agree to the bit, all but their wall time."""
    left, right = one.to_xarray(), other.to_xarray()
    for name in {*left.variables} | {*right.variables}:
        np.testing.assert_array_equal(left[name].to_numpy(), right[name].to_numpy(), err_msg=name)
    np.testing.assert_array_equal(one.dt, other.dt)
    assert one.verdict == other.verdict
    assert left.attrs["hash"] == right.attrs["hash"]


@pytest.mark.parametrize("name", CASES)
def test_it_goes_on_bit_for_bit(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From states between blocks of each kind of run, taken up in a folder of its own."""
    method, clock, asked = CASES[name]
    asked = dict(asked)
    built_in = asked.pop("scene", None)
    scene = replace(load_scene(built_in)[0], cells=Cells(0, 12, 60)) if built_in else SILO
    taken: list[Path] = []

    def write(path: Path, *rest: object) -> None:
        write_checkpoint(path, *rest)  # type: ignore[arg-type]
        taken.append(tmp_path / f"{len(taken)}")
        shutil.copy(path, taken[-1])

    monkeypatch.setattr(kinsim.checkpoint, "write_checkpoint", write)
    whole = simulate(scene, method, clock, 7, checkpoint=Checkpoint(str(tmp_path / "c"), every=0), **asked)
    monkeypatch.undo()
    assert len(taken) >= (whole.steps - 1) // 7
    for path in taken[:: max(len(taken) // 4, 1)]:
        same(resume(path), whole)


def test_a_run_that_was_interrupted_goes_on(tmp_path: Path) -> None:
    """SIGTERM puts it down between two blocks; tiles at rest do not change the bits."""
    long = replace(SILO, cells=Cells(-40, 40, 1000))
    clock = Fixed(0.02, 400, stop_at_rest=True)
    whole = simulate(long, Macroscopic(), clock, 50)
    shares = iter(range(100))

    def stop(share: float) -> None:
        if next(shares) == 2:
            signal.raise_signal(signal.SIGTERM)

    put_down = Checkpoint(str(tmp_path / "c"), every=3600)
    first = simulate(long, Macroscopic(), clock, 50, checkpoint=put_down, progress=stop)
    assert first.verdict.kind == "interrupted"
    assert first.steps < whole.steps
    on = resume(tmp_path / "c")
    np.testing.assert_array_equal(on.h, whole.h)
    assert on.verdict == whole.verdict


DRIVER = """
import os, signal, sys, time, random
import numpy as np
from dataclasses import replace
from kinsim import *
scene = replace(load_scene("silo")[0], cells=Cells(-8, 8, 100))
request = (scene, Kinetic(velocity=Uniform(32)), Fixed(0.01, 400), 20)
whole = simulate(*request)
path, dice, killed = sys.argv[1], random.Random(7), 0
while killed < 20:
    child = os.fork()
    if child == 0:
        resume(path) if os.path.exists(path) else simulate(*request, checkpoint=Checkpoint(path, every=0))
        os._exit(0)
    time.sleep(dice.uniform(0.02, 0.1))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    killed += os.path.exists(path)
run = resume(path)
assert (run.h == whole.h).all() and (run.q == whole.q).all() and (run.t == whole.t).all()
assert all((run.entries[name] == whole.entries[name]).all() for name in whole.entries)
print(killed)
"""


def test_it_survives_being_killed_twenty_times(tmp_path: Path) -> None:
    """kill -9 at random moments, also while it writes; in the end the bits are those of a run that nobody touched."""
    done = subprocess.run(
        [sys.executable, "-c", DRIVER, str(tmp_path / "c")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == 20


@pytest.fixture(scope="module")
def put_down(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A checkpoint."""
    path = tmp_path_factory.mktemp("whole") / "c"
    simulate(SILO, Macroscopic(), Fixed(0.01, 20), 5, checkpoint=Checkpoint(str(path), every=0))
    return path.read_bytes()


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_damage_is_seen(put_down: bytes, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Truncated anywhere, or with any byte changed: one line, no traceback of another kind."""
    at = data.draw(st.integers(0, len(put_down) - 1))
    cut = data.draw(st.booleans())
    other = bytes([put_down[at] ^ data.draw(st.integers(1, 255))])
    path = tmp_path_factory.getbasetemp() / "damaged"
    path.write_bytes(put_down[:at] if cut else put_down[:at] + other + put_down[at + 1 :])
    with pytest.raises(InputError, match=r"damaged|no checkpoint"):
        resume(path)


@pytest.mark.parametrize("change", [{"version": "0.0"}, {"scene": {}}, {"clock": None}, {"dumps": 3}, {"method": "x"}])
def test_a_forged_file_is_refused(put_down: bytes, tmp_path: Path, change: dict[str, object]) -> None:
    """Its checksum is right, its content is not."""
    path = tmp_path / "c"
    path.write_bytes(put_down)
    about, kept = read_checkpoint(path)
    write_checkpoint(path, about | change, kept)
    with pytest.raises(InputError, match=str(path)):
        resume(path)


def test_arrays_of_another_run_are_refused(put_down: bytes, tmp_path: Path) -> None:
    """Nor is anything unpickled."""
    path = tmp_path / "c"
    path.write_bytes(put_down)
    about, kept = read_checkpoint(path)
    for broken in (kept | {"loop/state": np.ones((2, 7))}, {}, kept | {"loop/seen": np.ones(2)}):
        write_checkpoint(path, about, broken)
        with pytest.raises(InputError, match="no checkpoint"):
            resume(path)
    write_checkpoint(path, about, kept | {"loop/dts": np.array([print], dtype=object)})
    with pytest.raises(InputError, match="no checkpoint"):
        resume(path)


FULL = """
import resource, sys
from kinsim import *
scene = load_scene("silo")[0]
checkpoint = Checkpoint(sys.argv[1], every=0)
simulate(scene, Macroscopic(), Fixed(0.01, 20), checkpoint=checkpoint)
resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))
print(simulate(scene, Macroscopic(), Fixed(0.01, 20), checkpoint=checkpoint).verdict)
"""


def test_a_full_disk_costs_the_new_file_alone(tmp_path: Path) -> None:
    """The run goes on, says so, and the older checkpoint is still there."""
    path = tmp_path / "c"
    done = subprocess.run([sys.executable, "-c", FULL, str(path)], capture_output=True, text=True, check=True)
    assert "finished" in done.stdout
    assert "cannot be written" in done.stdout
    assert resume(path).steps == 20
    assert [file.name for file in tmp_path.iterdir()] == ["c"]


def test_bad_places_are_refused_at_once(tmp_path: Path) -> None:
    """Before the run."""
    with pytest.raises(InputError, match="does not exist"):
        simulate(SILO, Macroscopic(), Fixed(0.01, 20), checkpoint=Checkpoint(str(tmp_path / "no" / "c")))
    with pytest.raises(InputError, match="cannot be read"):
        resume(tmp_path / "none")
    with pytest.raises(InputError, match="every"):
        Checkpoint("c", every=-1)


def test_from_the_shell(tmp_path: Path) -> None:
    """SIGTERM puts a run down; --resume goes on, writes what the whole run would have, and removes the checkpoint."""
    held, whole, taken_up = (str(tmp_path / name) for name in ("c", "whole.nc", "taken_up.nc"))
    scene = ["silo", "--method", "macroscopic", "--set", "cells.count=200", "--quiet"]
    request = [sys.executable, "-m", "kinsim", "run", *scene, "--checkpoint", held, "--every", "0.05"]
    with subprocess.Popen(request, stderr=subprocess.PIPE, text=True) as one:
        while one.poll() is None and not Path(held).exists():
            time.sleep(0.005)
        one.send_signal(signal.SIGTERM)
        said = one.communicate()[1]
    assert one.returncode == 130, said
    assert f"go on with: kinsim run --resume {held}" in said
    mixed = CliRunner().invoke(app, ["run", "--resume", held, "--set", "clock.steps=3"])
    assert mixed.exit_code == 2
    assert "goes on with what" in mixed.stderr
    assert CliRunner().invoke(app, ["run", "--resume", held, "--quiet", "--out", taken_up]).exit_code == 0
    assert CliRunner().invoke(app, ["run", *scene, "--out", whole]).exit_code == 0
    with xarray.open_dataset(taken_up) as one_run, xarray.open_dataset(whole) as other:
        xarray.testing.assert_identical(one_run.drop_attrs(), other.drop_attrs())
        assert one_run.attrs["hash"] == other.attrs["hash"]
    assert not Path(held).exists()
    nothing = CliRunner().invoke(app, ["run"])
    assert nothing.exit_code == 2
    assert "--resume" in nothing.stderr


def test_nothing_of_somebody_elses_is_touched(tmp_path: Path) -> None:
    """A file that is no checkpoint of this run is neither written nor removed; without --out a checkpoint stays."""
    file = tmp_path / "thesis.tex"
    file.write_text("precious")
    small = ["run", "silo", "--method", "macroscopic", "--set", "clock.steps=40", "--quiet", "--checkpoint", str(file)]
    refused = CliRunner().invoke(app, small)
    assert refused.exit_code == 2
    assert "is no checkpoint of this run" in refused.stderr
    assert file.read_text() == "precious"
    file.unlink()
    assert CliRunner().invoke(app, [*small, "--every", "0"]).exit_code == 0
    assert file.exists()
    other = [*small, "--every", "0", "--set", "clock.steps=50"]
    assert CliRunner().invoke(app, other).exit_code == 2
    assert CliRunner().invoke(app, [*small, "--every", "0", "--out", str(tmp_path / "a.nc")]).exit_code == 0
    assert not file.exists()


def test_a_table_is_needed_no_more(tmp_path: Path) -> None:
    """What was read from a file is in the checkpoint."""
    table = tmp_path / "t.csv"
    table.write_text("x,h\n-8,0.3\n0,2.0\n8,0.3\n")
    scene = replace(SILO, heap=Table(str(table)))
    whole = simulate(scene, Macroscopic(), Fixed(0.01, 20), 5, checkpoint=Checkpoint(str(tmp_path / "c"), every=0))
    table.unlink()
    np.testing.assert_array_equal(resume(tmp_path / "c").h, whole.h)


def test_strange_places_get_one_line(tmp_path: Path) -> None:
    """Devices, and names that are too long."""
    for path in ("/dev/zero", str(tmp_path / ("x" * 300))):
        with pytest.raises(InputError):
            resume(path)
        with pytest.raises(InputError):
            simulate(SILO, Macroscopic(), Fixed(0.01, 5), checkpoint=Checkpoint(path))


ROOM = """
import resource, signal, sys
from kinsim import *
run = simulate(load_scene("silo")[0], Macroscopic(), Fixed(0.01, 50), 1)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    run.to_netcdf(sys.argv[1])
except InputError as error:
    print(error)
"""


def test_a_full_disk_for_a_run_is_one_line_and_no_crash(tmp_path: Path) -> None:
    """HDF5 itself would end the process with a fault of memory."""
    done = subprocess.run(
        [sys.executable, "-c", ROOM, str(tmp_path / "a.nc")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "cannot be written" in done.stdout
    assert not done.stderr
    assert not list(tmp_path.iterdir())
