"""Studies: every combination once, failures as rows, nothing computed twice, nothing lost."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
import xarray
from typer.testing import CliRunner

from kinsim import (
    Cells,
    Courant,
    Fitted,
    Fixed,
    InputError,
    Kinetic,
    Macroscopic,
    Uniform,
    load_scene,
    simulate,
    study,
)  # fmt: skip
from kinsim.cli import app
from kinsim.studies import engine, record
from kinsim.studies.member import Member
from kinsim.studies.record import Folder, perform
from kinsim.studies.vary import read_over

SCENE, _, _ = load_scene("silo")
CLOCK = Fixed(1e-3, 20)
OVER = {"chute.zeta": [0.0, "pi/20", 0.3], "cells.count": [40, 80]}


def test_every_combination_is_the_run_that_it_names() -> None:
    found = study(SCENE, Macroscopic(), CLOCK, {"chute.zeta": [0.0, "pi/20"], "method.order": [1, 2]}, fields=["mass"])
    assert found["h"].dims == ("chute.zeta", "method.order", "x")
    np.testing.assert_allclose(found["chute.zeta"], [0.0, np.pi / 20])
    keys = {"cells": SCENE.cells, "heap": SCENE.heap, "friction": SCENE.friction, "epsilon": SCENE.epsilon}
    one = simulate(type(SCENE)(**keys, chute={"zeta": "pi/20"}), Macroscopic(order=2), CLOCK, 20)
    at = found.isel({"chute.zeta": 1, "method.order": 1})
    np.testing.assert_array_equal(at["h"], one.h[-1])
    np.testing.assert_array_equal(at["history_mass"], one.entries["mass"])
    assert (int(at["cell_steps"]), float(at["mass_drift"])) == (20 * 320, one.mass_drift)
    assert float(at["u_max"]) == one.entries["u_max"].max()


def test_paired_members_of_unlike_sizes_are_padded() -> None:
    over = {
        "method": [Kinetic(velocity=Uniform(8)), Kinetic(velocity=Fitted(3)), Macroscopic()],
        "cells.count": [40, 80, 20],
    }
    found = study(SCENE, Kinetic(), Courant(0.5, 0.1), over, paired=True, fields=["h"], save_every=2)
    assert found["method"].values.tolist() == [
        "kinetic, scheme 4, 8 nodes", "kinetic, scheme 4, 3 fitted nodes", "macroscopic, scheme 4"]  # fmt: skip
    assert (found["h"].notnull().sum("cell") == found["cells.count"]).all()
    for member in range(3):
        last = int(found["history_t"][member].notnull().sum()) - 1
        np.testing.assert_array_equal(found["history_h"][member, last], found["h"][member])


def test_a_member_that_fails_is_a_row_with_its_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    over = {"method.scheme": [4, 1], "method.order": [1, 2], "clock.dt": [1e-3, 1.0]}
    found = study(SCENE, Macroscopic(), CLOCK, over)
    kinds = found["verdict_kind"].values
    assert kinds[:, :, 0].tolist() == [["finished", "finished"], ["finished", "refused"]]
    assert (kinds[:, :, 1] == "refused").all()
    assert "breaks the CFL bound" in found["verdict"].values[0, 0, 1]
    assert "belongs to scheme 4" in found["verdict"].values[1, 1, 0]
    assert np.isnan(found["h"].values[1, 1]).all()

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("on purpose")

    monkeypatch.setattr(record, "simulate", broken)
    assert study(SCENE, Macroscopic(), CLOCK, {"chute.zeta": [0, 1]})["verdict"].values.tolist() == [
        "ZeroDivisionError: on purpose"] * 2  # fmt: skip


def test_repeats_are_rounds_that_time_and_traced_members_know_their_memory() -> None:
    found = study(SCENE, Kinetic(), CLOCK, {"method.velocity.count": [8, 512]}, repeats=3, traced=True)
    assert found["wall_time"].dims == ("method.velocity.count", "repeat")
    assert len(set(found["wall_time"].values.ravel().tolist())) == 6
    assert found["memory"].values[1] > found["memory"].values[0] > 320 * 8


def test_an_interrupt_costs_only_the_member_under_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = study(SCENE, Macroscopic(), CLOCK, OVER)
    done: list[Member] = []

    def counted(member: Member, progress: object = None) -> record.Record:
        done.append(member)
        return perform(member)

    def stop(what: str, share: float) -> None:
        if what == "member 4 of 6":
            raise KeyboardInterrupt

    monkeypatch.setattr(engine, "perform", counted)
    with pytest.raises(KeyboardInterrupt, match=r"3 of 6 members are done, kept in .*; --resume"):
        study(SCENE, Macroscopic(), CLOCK, OVER, keep=tmp_path / "kept", tell=stop)
    assert len(list((tmp_path / "kept").iterdir())) == len(done) == 3
    (tmp_path / "kept" / f"{done[0].key}.npz").write_bytes(b"half a file")
    rest = study(SCENE, Macroscopic(), CLOCK, OVER, keep=tmp_path / "kept", resume=True)
    assert len(done) == 3 + 4
    xarray.testing.assert_identical(*(one.drop_vars(["wall_time", "total_time"]) for one in (whole, rest)))
    study(SCENE, Macroscopic(), CLOCK, OVER, keep=tmp_path / "kept", resume=True)
    assert len(done) == 7
    study(SCENE, Macroscopic(), Fixed(1e-3, 21), OVER, keep=tmp_path / "kept", resume=True)
    assert len(done) == 13


def test_a_run_that_was_interrupted_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(member: Member, progress: object = None) -> record.Record:
        return record.failed("interrupted", "interrupted")

    monkeypatch.setattr(engine, "perform", interrupted)
    with pytest.raises(KeyboardInterrupt, match="0 of 6"):
        study(SCENE, Macroscopic(), CLOCK, OVER, keep=tmp_path / "kept")
    assert not list((tmp_path / "kept").iterdir())


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"over": {}}, "nothing varies"),
        ({"over": {"chute.zeta": []}}, "the list is empty"),
        ({"over": {"chute.zeta": 3}}, "should be a list of values, got a int"),
        ({"over": {"chute.zta": [1]}}, "did you mean zeta"),
        ({"over": {"chute.zeta.deep": [1]}}, "zeta is not a table of keys"),
        ({"over": {"chute.zeta": [0, 1], "clock.dt": [1e-3]}, "paired": True}, "2 of chute.zeta, 1 of clock.dt"),
        ({"over": OVER, "fields": ["hight"]}, "no field 'hight'"),
        ({"over": OVER, "repeats": 0}, "repeats = 0 is below 1"),
        ({"over": OVER, "workers": -1}, "workers = -1"),
        ({"over": OVER, "workers": 1, "scheduler": "tcp://127.0.0.1:1"}, "leave out"),
        ({"over": OVER, "keep": "/dev/null/kept"}, "no folder can be made there"),
        ({"over": OVER, "keep": 3}, "keep = 3 names no folder"),
        ({"over": OVER, "resume": True}, "none is named; write keep="),
        ({"over": OVER, "repeats": 1.5}, "repeats = 1.5 is no whole number"),
        ({"over": OVER, "save_every": "x"}, "save_every = 'x' is no whole number"),
        ({"over": OVER, "save_every": 0}, "save_every = 0 is below 1"),
        ({"over": OVER, "scheduler": 5}, "scheduler = 5 is no address"),
        ({"over": OVER, "fields": 3}, "fields = 3 is no list of names"),
        ({"over": OVER, "fields": "hight"}, "no field 'hight'"),
        ({"over": {3: [1]}}, "over 3: is no key"),
        ({"over": {"chute.zeta": np.array(0.1)}}, "over chute.zeta: should be a list"),
        ({"over": {"chute.zeta": range(2000), "clock.dt": range(2000)}}, "4000000 members are more .* at most 1000000"),
    ],
)
def test_bad_requests_get_one_line(options: dict[str, object], line: str) -> None:
    with pytest.raises(InputError, match=line) as told:
        study(SCENE, Macroscopic(), CLOCK, **options)
    assert "\n" not in str(told.value)


def test_what_is_no_scene_is_refused() -> None:
    for given in (("silo", Macroscopic(), CLOCK), (SCENE, "kinetic", CLOCK), (SCENE, Macroscopic(), 0.1)):
        with pytest.raises(InputError, match=r"study: (scene|method|clock) is a (str|float); give "):
            study(*given, OVER)  # type: ignore[arg-type]


def test_one_field_and_a_kept_file_without_a_verdict(tmp_path: Path) -> None:
    found = study(SCENE, Macroscopic(), CLOCK, OVER, fields="mass", keep=tmp_path)
    assert "history_mass" in found
    file = next(tmp_path.iterdir())
    np.savez(file, figures=np.array("{}"))
    again = study(SCENE, Macroscopic(), CLOCK, OVER, fields="mass", keep=tmp_path, resume=True)
    np.testing.assert_array_equal(again["h"], found["h"])


def test_a_quiet_sweep_tells_its_faults(tmp_path: Path) -> None:
    words = ["sweep", "riemann", "--set", "cells.count=20", "--set", "clock.steps=2", "--quiet",
             "--over", "cells.count=20,-1,-2", "--out", str(tmp_path / "s.nc")]  # fmt: skip
    done = CliRunner().invoke(app, words)
    assert done.exit_code
    assert done.stdout == ""
    assert done.stderr.startswith("2 of 3 members ended refused: ")
    assert done.stderr.count("\n") == 1
    many = CliRunner().invoke(app, [*words, "--over", "chute.zeta=0:1:1000000000"])
    assert "1000000000 values are more than a table in memory holds; take at most 1000000" in many.stderr
    assert many.stderr.count("\n") == 1


def test_lists_from_the_command_line() -> None:
    tables = 'e={kind="fitted"},{kind="uniform"}'
    assert read_over(["a=0:4:3", "b=0:pi:2", "c=1,2.5", "d=pi/4,pi/5", tables, "f=hold"]) == {
        "a": [0, 2, 4], "b": [0.0, np.pi], "c": [1, 2.5], "d": ["pi/4", "pi/5"],
        "e": [{"kind": "fitted"}, {"kind": "uniform"}], "f": ["hold"],
    }  # fmt: skip
    for bad in ("a", "a=", "=1", "a=0:1:1", "a=0:x:3", "a=0:1:x"):
        with pytest.raises(InputError, match="--over"):
            read_over([bad])
    with pytest.raises(InputError, match="named twice"):
        read_over(["a=1", "a=2"])


def test_the_command_writes_one_file_and_resumes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "silo", "--over", "method.kind=kinetic,macroscopic", "--over", "clock.dt=0.001,1",
             "--set", "clock.steps=20", "--set", "cells.count=40", "--field", "h"]  # fmt: skip
    done = CliRunner().invoke(app, words, env={"COLUMNS": "200"})
    assert done.exit_code == 1
    assert "study: written to sweep.nc" in done.stdout
    assert done.stdout.count("breaks the CFL bound") == 2
    assert done.stdout.count("finished at t = 0.02 after 20 steps") == 2
    with xarray.open_dataset("sweep.nc", engine="h5netcdf") as kept:
        assert kept["history_h"].dims == ("method.kind", "clock.dt", "row", "x")

    def never(member: Member, progress: object = None) -> record.Record:
        raise AssertionError(member)

    monkeypatch.setattr(engine, "perform", never)
    assert CliRunner().invoke(app, [*words, "--resume"]).exit_code == 1


WAIT = 60.0
"""Seconds after which a process that should have said something is given up."""


def test_a_worker_killed_in_the_middle_loses_nothing_and_doubles_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A real scheduler and two worker processes on loopback; one is killed when the first member is in."""
    over = {"chute.zeta": [0.01 * k for k in range(8)]}
    clock = Fixed(1e-4, 1500)
    saved: list[str] = []
    save = Folder.save
    monkeypatch.setattr(Folder, "save", lambda self, key, kept: (saved.append(key), save(self, key, kept))[1])
    with ExitStack() as stack:

        def start(*words: str) -> subprocess.Popen[bytes]:
            command = [sys.executable, "-m", "dask", *words]
            process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", "at.json")
        given_up = time.monotonic() + WAIT
        while not (tmp_path / "at.json").exists():
            assert time.monotonic() < given_up
            time.sleep(0.05)
        address = json.loads((tmp_path / "at.json").read_text())["address"]
        alone = ("--no-nanny", "--no-dashboard", "--nthreads", "1", "--host", "127.0.0.1")
        first, second = (start("worker", address, *alone) for _ in range(2))
        import distributed

        with distributed.Client(address, timeout=WAIT) as client:
            client.wait_for_workers(2, timeout=WAIT)

        def kill(what: str, share: float) -> None:
            if what == "1 of 8 members":
                os.kill(first.pid, signal.SIGKILL)

        found = study(SCENE, Macroscopic(), clock, over, scheduler=address, keep=tmp_path / "kept", tell=kill)
        assert first.wait(WAIT) == -signal.SIGKILL
        assert second.poll() is None
    assert len(saved) == len(set(saved)) == len(list((tmp_path / "kept").iterdir())) == 8
    here = study(SCENE, Macroscopic(), clock, over)
    xarray.testing.assert_identical(*(one.drop_vars(["wall_time", "total_time"]) for one in (found, here)))


def test_many_members(tmp_path: Path) -> None:
    """300 of them: none lost, none twice, each the run that it would be alone; a second study runs nothing."""
    scene, method = replace(SCENE, cells=Cells(-8, 8, 16)), Macroscopic(4)
    angles = np.linspace(0.0, 0.3, 300).tolist()
    found = study(scene, method, Fixed(0.05, 2), {"chute.zeta": angles}, keep=tmp_path)
    assert len(list(tmp_path.iterdir())) == 300
    assert (found["verdict_kind"] == "finished").all()
    for at in (0, 137, 299):
        alone = simulate(replace(scene, chute={"zeta": angles[at]}), method, Fixed(0.05, 2))
        np.testing.assert_array_equal(found["h"][at], alone.h[-1])
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = study(scene, method, Fixed(0.05, 2), {"chute.zeta": angles}, keep=tmp_path, resume=True)
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert again.equals(found)


def test_a_sweep_as_a_table(tmp_path: Path) -> None:
    """A row per member; other names are refused before anything runs."""
    words = ["sweep", "silo", "--over", "clock.dt=0.001,0.002", "--set", "clock.steps=3"]
    words += ["--set", "method.kind=macroscopic", "--quiet", "--out"]
    done = CliRunner().invoke(app, [*words, str(tmp_path / "x.csv")])
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader((tmp_path / "x.csv").read_text().splitlines()))
    assert [float(row["clock.dt"]) for row in rows] == [0.001, 0.002]
    assert {row["verdict_kind"] for row in rows} == {"finished"}
    assert all(float(row["mass"]) > 0 for row in rows)
    refused = CliRunner().invoke(app, [*words, str(tmp_path / "x.txt")])
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert ".nc" in refused.stderr
    unkept = CliRunner().invoke(app, [*words, str(tmp_path / "y.csv"), "--field", "h", "--field", "mass"])
    assert (unkept.exit_code, unkept.stderr.count("\n")) == (2, 1)
    assert "no room for --field h --field mass; write" in unkept.stderr
    assert "y.nc" in unkept.stderr
    assert not list(tmp_path.glob("y*"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["sweep", "silo", "--over", "chute.zeta=0,0.1,0.2"],
            "1 of 3 members are done, kept in out.nc.members; --resume",
        ),
        (["trade", "silo", "--line", "fitted"], "1 of 2 members are done, kept in out.nc.members; --resume"),
        (["atlas", "--axis", "zeta", "--keep", "kept"], "members are done, kept in kept; --resume"),
    ],
    ids=lambda one: one[0] if isinstance(one, list) else "",
)
def test_sigterm_ends_a_command_as_ctrl_c_does(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between two members, where no time loop waits for it: what is finished is kept, and a line says so."""
    monkeypatch.chdir(tmp_path)
    done: list[str] = []

    def second_is_ended(member: Member, progress: object = None) -> record.Record:
        if done:
            signal.raise_signal(signal.SIGTERM)
        done.append(member.key)
        return perform(member)

    monkeypatch.setattr(engine, "perform", second_is_ended)
    size = ["--set", "cells.count=40", "--set", "clock.steps=3", "--set", "method.kind=macroscopic"]
    ended = CliRunner().invoke(app, [*words, *([] if words[0] == "atlas" else size), "--out", "out.nc", "--quiet"])
    assert (ended.exit_code, ended.stderr.count("\n")) == (130, 1), ended.stderr
    assert said in ended.stderr
    assert [kept.stem for kept in tmp_path.glob("*/*.npz")] == done
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_sigterm_stops_the_workers_too(tmp_path: Path) -> None:
    """A sweep in processes of its own: those are gone, and what they finished is taken by --resume."""
    words = ["sweep", "silo", "--over", "chute.zeta=0:0.3:8", "--set", "clock.dt=1e-4", "--set", "clock.steps=2000"]
    words += ["--set", "method.kind=macroscopic", "--workers", "1", "--quiet"]
    command = [sys.executable, "-m", "kinsim", *words]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as one:
        given_up = time.monotonic() + WAIT
        while not list(tmp_path.glob("sweep.nc.members/*.npz")) and one.poll() is None:
            assert time.monotonic() < given_up
            time.sleep(0.02)
        workers = psutil.Process(one.pid).children(recursive=True)
        one.send_signal(signal.SIGTERM)
        said = one.communicate(timeout=WAIT)[1]
    assert one.returncode == 130, said
    assert "of 8 members are done, kept in sweep.nc.members; --resume" in said
    assert workers
    while any(each.is_running() and each.status() != psutil.STATUS_ZOMBIE for each in workers):
        assert time.monotonic() < given_up, workers
        time.sleep(0.02)


def test_ctrl_c_while_workers_start_waits_for_them(monkeypatch: pytest.MonkeyPatch, capfd: object) -> None:
    """It reaches them, too, and what they cry then nobody sees; they are stopped, and it is an interrupt."""
    stopped = []

    class Workers:
        def __init__(self, **given: object) -> None:
            os.kill(os.getpid(), signal.SIGINT)
            os.write(2, b"Traceback (most recent call last):\n")

        def __enter__(self) -> object:
            return self

        def __exit__(self, *given: object) -> None:
            stopped.append(True)

    monkeypatch.setattr("distributed.LocalCluster", Workers)
    with pytest.raises(KeyboardInterrupt):
        study(SCENE, Macroscopic(), CLOCK, {"chute.zeta": [0.0, 0.1]}, workers=1)
    assert stopped == [True]
    assert capfd.readouterr().err == ""
