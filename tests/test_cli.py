"""The commands: what they print, write and return."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest
import xarray
from test_read import BAD, GOOD
from typer.testing import CliRunner

from kinsim import __version__, simulate
from kinsim.cli import app

SMALL = ["--set", "clock.steps=40", "--set", "cells.count=80", "--set", "method.velocity.count=16"]
"""What makes a built-in scene quick."""


def kinsim(*words: str, code: int = 0):
    """The command, run in this process."""
    result = CliRunner().invoke(app, list(words), env={"COLUMNS": "200"})
    assert result.exit_code == code, result.output
    assert "Traceback" not in result.output
    return result


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to stand in, with a scene file."""
    (tmp_path / "small.toml").write_text(GOOD)
    (tmp_path / "zigzag.csv").write_text("x,h\n-2,1\n1,2\n0,1\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {"small.toml", "zigzag.csv"}


def figure(output: str, label: str) -> str:
    """What a table says in the row `label`."""
    found = re.search(rf"^{re.escape(label)}  +(.*?) *$", output, re.MULTILINE)
    assert found, output
    return found[1]


def test_version():
    assert kinsim("--version").output == f"kinsim {__version__}\n"


def test_scenes_lists_all_with_their_figures():
    lines = kinsim("scenes").output.splitlines()
    names = ["riemann", "silo", "silo-incline", "parabola", "sine"]
    names += ["bend", "bend-pressed", "exponential", "jump", "crest", "rest-gallery"]
    assert [line.split()[0] for line in lines] == ["scene", *names]
    assert "2, 3" in lines[2]
    assert "breaking grain silo" in lines[2]


def test_run_tells_what_it_did(folder):
    output = kinsim("run", "silo", *SMALL).output
    assert "breaking grain silo: kinetic, scheme 3, 16 nodes" in output
    assert figure(output, "steps") == "40, to t = 0.04"
    assert figure(output, "dt") == "0.001"
    assert 0.006 < float(figure(output, "Courant number").removeprefix("at most ")) < 0.009
    assert abs(float(figure(output, "mass drift").split()[0])) < 1e-3
    assert float(figure(output, "min h")) == pytest.approx(0.3, abs=1e-3)
    assert 0.0 < float(figure(output, "max |u|")) < 0.6
    assert figure(output, "fronts").startswith("x = -1.1 and 1.1, ")
    assert "from a run of the closed-form twin" in figure(output, "velocity window")
    assert figure(output, "verdict").startswith("finished at t = 0.04 after 40 steps")
    per_cell, per_node = (
        float(figure(output, label).removesuffix(" ns")) for label in ("per cell and step", "per (cell, node)")
    )
    assert per_cell / per_node == pytest.approx(16, rel=0.01)
    assert "run: not written; --out silo.nc would put it there" in output
    assert "picture: not written; --plot silo.png would put it there" in output
    assert written(folder) == set()


def test_run_says_nothing_of_a_window_that_was_given():
    output = kinsim("run", "silo", *SMALL, "--set", "method.velocity.bound=2").output
    assert figure(output, "velocity window") == "|xi| <= 2"


def test_run_writes_run_and_picture(folder):
    output = kinsim("run", "small.toml", "--out", "run.nc", "--plot", "run.svg").output
    assert "run: written to run.nc" in output
    assert written(folder) == {"run.nc", "run.svg"}
    with xarray.open_dataset("run.nc", engine="h5netcdf") as dataset:
        assert dataset["h"].shape == (21, 20)
        assert dataset["f"].shape == (2, 20, 16)
        assert float(dataset["t"][-1]) == pytest.approx(0.02)
        assert dataset.attrs["title"] == "small"


def test_run_takes_the_other_wing_quietly(folder):
    assert kinsim("run", "silo", "--method", "macroscopic", *SMALL[:4], "--quiet", "--out", "run.nc").output == ""
    with xarray.open_dataset("run.nc", engine="h5netcdf") as dataset:
        assert '"kind": "macroscopic"' in dataset.attrs["method"]
        assert "f" not in dataset


@pytest.mark.parametrize("name", BAD)
def test_bad_files_leave_one_line_and_nothing_else(folder, name):
    old, new, wanted = BAD[name]
    (folder / "small.toml").write_text(GOOD.replace(old, new, 1))
    result = kinsim("run", "small.toml", "--out", "run.nc", "--plot", "run.png", code=2)
    assert wanted in result.stderr
    assert result.stderr.startswith("small.toml: ")
    assert result.stderr.count("\n") == 1
    assert result.stdout == ""
    assert written(folder) == set()


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["run", "no.toml"], "no.toml: cannot be read: No such file"),
        (["check", "no.toml"], "no.toml: cannot be read: No such file"),
        (["compare", "sillo"], "sillo: no such scene; did you mean silo?"),
        (["run", "small.toml", "--out", "no/run.nc"], "no/run.nc: the folder no does not exist; create it first"),
        (["run", "small.toml", "--plot", "no/run.png"], "no/run.png: the folder no does not exist; create it first"),
        (["run", "small.toml", "--out", "."], ".: is a folder; name a file in it"),
        (["run", "small.toml", "--plot", "run.gif"], "run.gif: is no picture; end its name in .png, .pdf, .svg"),
        (["run", "small.toml", "--plot", "run"], "run: is no picture; end its name in .png, .pdf, .svg"),
        (["run", "small.toml", "--set", "delta"], "--set delta: is not key=value; write for example"),
        (
            ["run", "small.toml", "--set", "friction.delt=1"],
            "small.toml: friction.delt: unknown key; did you mean delta?",
        ),
        (["run", "small.toml", "--set", "clock.dt=0.5"], "dt = 0.5 breaks the CFL bound (28)"),
        (["check", "small.toml", "--set", "a=1"], "No such option"),
        (["run", "small.toml", "--method", "kinetik"], "'kinetik' is not one of 'kinetic', 'macroscopic'"),
    ],
)
def test_bad_words_leave_nothing(folder, words, wanted, monkeypatch):
    if "CFL" not in wanted:
        import_module("kinsim.measure.compare")  # or it would take over what stands there now, for good
        monkeypatch.setattr(import_module("kinsim.simulate"), "simulate", lambda *_, **__: pytest.fail("it ran"))
    asked = words + [word for option in ("--out", "--plot") if words[0] == "run" and option not in words
                     for word in (option, f"run{'.nc' if option == '--out' else '.png'}")]  # fmt: skip
    result = kinsim(*asked, code=2)
    assert wanted in result.stderr
    assert result.stdout == ""
    assert written(folder) == set()


def test_a_folder_that_cannot_be_written(folder, monkeypatch):
    def refuse(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    result = kinsim("run", "small.toml", "--out", "run.nc", code=2)
    assert result.stderr == "run.nc: cannot write into . (Permission denied); choose another folder\n"
    assert written(folder) == set()


def test_a_forced_run_over_the_bound_says_so(folder):
    words = ("run", "small.toml", "--method", "macroscopic", "--set", "clock.dt=0.16", "--set", "clock.steps=1")
    assert "take dt <= " in kinsim(*words, code=2).stderr
    assert "the CFL bound was broken on demand" in figure(kinsim(*words, "--force").output, "verdict")


def test_a_stopped_run_is_kept_and_returns_1(folder):
    words = ("run", "small.toml", "--set", "method.velocity.bound=0.5", "--out", "run.nc")
    assert "take a bound of" in figure(kinsim(*words, code=1).output, "verdict")
    assert "outside the window" in kinsim(*words, "--quiet", code=1).stderr
    with xarray.open_dataset("run.nc", engine="h5netcdf") as dataset:
        assert dataset.attrs["verdict"] == "window-too-small"


def test_an_interrupted_run_is_kept_and_returns_130(folder, monkeypatch):
    def interrupted(*given, progress, **options):
        def stop(share: float) -> None:
            if share > 0.5:
                raise KeyboardInterrupt

        return simulate(*given, progress=stop, **options)

    monkeypatch.setattr(import_module("kinsim.simulate"), "simulate", interrupted)
    output = kinsim("run", "silo", *SMALL, "--out", "run.nc", "--plot", "run.png", code=130).output
    assert "interrupted at t = 0.0" in output
    assert written(folder) == {"run.nc", "run.png"}
    with xarray.open_dataset("run.nc", engine="h5netcdf") as dataset:
        assert 0.02 <= float(dataset["t"][-1]) < 0.04


def test_an_interrupt_before_the_first_step_is_told(folder, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(import_module("kinsim.simulate"), "find_bound", interrupted)
    assert kinsim("run", "small.toml", "--out", "run.nc", code=130).stderr == "interrupted; nothing was written\n"
    assert written(folder) == set()


def test_compare_prints_how_far_apart_the_wings_are():
    output = kinsim("compare", "small.toml").output
    assert "small, against kinetic, scheme 3, 16 nodes" in output
    assert "difference of macroscopic, scheme 3" in output
    last = next(line for line in output.splitlines() if line.split()[0] == "0.02").split()
    assert all(0.0 < float(number) < 0.1 for number in last[1:])
    assert output.count("finished at t = 0.02 after 20 steps") == 2


def test_check_prints_what_was_filled_in():
    output = kinsim("check", "small.toml").output
    assert figure(output, "friction.delta") == "0.3141592653589793  file"
    assert figure(output, "clock.kind").split() == ['"fixed"', "filled", "in"]
    assert figure(output, "method.equilibrium").split() == ['"cell-average"', "filled", "in"]
    assert figure(output, "dx").split() == ["0.2", "follows"]
    assert float(figure(output, "Courant number of the first step").split()[0]) == pytest.approx(0.00678, abs=1e-5)


def test_check_refuses_a_first_step_over_the_bound(folder):
    (folder / "small.toml").write_text(GOOD.replace("dt = 0.001", "dt = 1.0"))
    assert kinsim("check", "small.toml", code=2).stderr.startswith(
        "small.toml: clock: the first step breaks the CFL bound"
    )


def test_help_answers_at_once_and_loads_nothing_heavy():
    heavy = {"numpy", "numba", "pydantic", "matplotlib", "xarray"}
    code = f"import sys, kinsim.cli; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
    took = []
    for _ in range(3):
        began = time.perf_counter()
        answer = subprocess.run([sys.executable, "-m", "kinsim", "--help"], capture_output=True, text=True, check=True)
        took.append(time.perf_counter() - began)
    assert "compare" in answer.stdout
    assert min(took) < 1.0


def test_a_pipe_gets_no_colours():
    answer = subprocess.run(
        [sys.executable, "-m", "kinsim", "run", "small.toml", "--method", "macroscopic"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "\x1b" not in answer.stdout + answer.stderr
    assert answer.stderr == ""
    assert max(map(len, answer.stdout.splitlines())) <= 80


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("words", [["scenes"], ["--help"], ["check", "silo"]])
def test_an_output_that_is_full_is_told_in_one_line(words):
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "kinsim", *words]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert "No space left on device" in done.stderr
