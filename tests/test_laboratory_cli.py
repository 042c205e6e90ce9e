"""The laboratory from the shell: rooms, dumps and their picture, causes, seams."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from kinsim import Dump, Fixed, InputError, Kinetic, Macroscopic, Uniform, compare, load_scene, simulate
from kinsim.cli import app
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.measure.seams import STAGES
from kinsim.method import ProjectionName
from kinsim.plot import plot_density, plot_seams
from kinsim.progress import COMPILING, KEPT, STEP

SMALL = ["--set", "cells.count=40", "--set", "clock.steps=40", "--set", "method.velocity.count=16"]


def call(*words: str) -> tuple[int, str, str]:
    done = CliRunner().invoke(app, list(words))
    return done.exit_code, done.stdout, done.stderr


def test_rooms_lists_every_variant() -> None:
    code, said, _ = call("rooms")
    assert code == 0
    for name in (
        *EQUILIBRIA,
        *FORCES,
        *get_args(ProjectionName),
        "uniform",
        "window",
        "fitted",
        "coulomb",
        "periodic",
        "profile",
    ):
        assert name in said
    for equation in ("(12)", "(18)", "(19)", "(20)", "(23)", "(24)", "(25)"):
        assert equation in said


def test_dumps_go_into_the_file_and_onto_the_picture(tmp_path: Path) -> None:
    file, picture = tmp_path / "run.nc", tmp_path / "f.png"
    code, said, complaint = call(
        "run", "silo", *SMALL, "--out", str(file), "--density", str(picture), "--cut", "0.5", "--causes",
        "--dump", "stage=transport,every=10,x=-2:2,xi=-1:1", "--dump", "name=M,stage=equilibrium,every=20",
    )  # fmt: skip
    assert code == 0
    assert complaint in ("", COMPILING.format(what=STEP) + KEPT + "\n")
    assert "what each stage did" in said
    assert picture.read_bytes().startswith(b"\x89PNG")
    with xarray.open_dataset(file, engine="h5netcdf") as kept:
        assert kept["transport"].dims == ("t_transport", "x_transport", "xi_transport")
        np.testing.assert_allclose(kept["t_transport"], [0.001, 0.01, 0.02, 0.03, 0.04])
        assert np.abs(kept["x_transport"]).max() <= 2
        assert np.abs(kept["xi_transport"]).max() <= 1
        np.testing.assert_allclose(kept["t_M"], [0.0, 0.019, 0.039])
        gap = kept["cause_sum"].sum("stage") - kept["cause_total"]
        assert float(np.abs(gap).max()) <= 1e-12


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (["--dump", "every"], "'every' is not KEY=VALUE"),
        (["--dump", "evry=3"], "evry: unknown key; did you mean every?"),
        (["--dump", "stage=middle"], "stage: should be"),
        (["--density", "f.png"], "--density draws a dump"),
        (["--dump", "name=mass"], "name = 'mass' is taken"),
        (["--dump", "x=50:60"], "no cell centre lies in its window of x"),
        (["--dump", "x=1:0"], "x = 1:0 is no window"),
        (["--dump", "xi=30:40", "--density", "f.png"], "is empty; widen its windows"),
        (["--out", "run.nc", "--plot", "run.nc.png", "--density", "run.nc.png", "--dump", "every=9"], "is named twice"),
        (["--set", 'method.velocity={kind="window",dxi=1e-9}'], "take dxi well above 1e-09"),
        (["--dump", "every=10", "--density", "f.png", "--cut", "99"], "no cut at x = 99"),
    ],
)
def test_bad_requests_get_one_line(
    words: list[str], place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, complaint = call("run", "silo", *SMALL, *words)
    assert code == 2
    assert place in complaint
    assert complaint.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_dump_called_f_goes_with_the_last_density(tmp_path: Path) -> None:
    """The command keeps the last density for its picture; it makes way for a dump of that name."""
    file = tmp_path / "run.nc"
    code, _, complaint = call("run", "silo", *SMALL, "--out", str(file), "--dump", "name=f,stage=transport,every=20")
    assert (code, complaint) == (0, "")
    with xarray.open_dataset(file, engine="h5netcdf") as kept:
        assert kept["f"].dims == ("t_f", "x", "xi")
        assert kept["f_end"].dims == ("t_f_end", "x", "xi")


def test_densities_need_a_grid() -> None:
    scene, _, _ = load_scene("riemann")
    with pytest.raises(InputError, match="need a density on a velocity grid"):
        simulate(scene, Macroscopic(), Fixed(1e-3, 2), dumps=[Dump()])
    with pytest.raises(InputError, match="two dumps are called 'f'"):
        simulate(scene, Kinetic(velocity=Uniform(8)), Fixed(1e-3, 2), dumps=[Dump(), Dump(stage="transport")])


def test_seams_are_differences_of_the_same_step(tmp_path: Path) -> None:
    """Every stage is there, and the state differs by no more than the fluxes let it; the picture is made."""
    scene, _, _ = load_scene("silo")
    method = Kinetic(3, Uniform(64))
    measured = compare(scene, [method, method.twin], Fixed(1e-3, 60), 20, seams=True)
    assert all(f"seam_{stage}" in measured for stage in STAGES)
    half = float(np.abs(measured["seam_half"]).max())
    after = float(np.abs(measured["seam_projection"]).max())
    assert 1e-6 < half < 1e-3
    assert after <= 1e-3 / scene.cells.dx * 4 * half
    assert float(np.abs(measured["seam_projection"]).max()) > 0
    with pytest.raises(InputError, match="seams need a second method"):
        compare(scene, [method], Fixed(1e-3, 20), 20, seams=True)
    same = compare(scene, [method.twin, method.twin], Fixed(1e-3, 20), 20, seams=True)
    assert all(float(np.abs(same[f"seam_{stage}"]).max()) == 0.0 for stage in STAGES)
    assert plot_seams(measured, tmp_path / "seams.png").stat().st_size > 10_000
    code, said, _ = call("compare", "silo", *SMALL, "--seams", "--plot", str(tmp_path / "again.png"))
    assert code == 0
    assert "half-range moments of M" in said


def test_density_picture_of_moved_nodes(tmp_path: Path) -> None:
    """A dump of exactly shifted nodes carries its offset and can be drawn."""
    scene, _, _ = load_scene("sine")
    run = simulate(
        scene, Kinetic(velocity=Uniform(32), force="shift-exact"), Fixed(1e-3, 20), 20, dumps=[Dump(every=10)]
    )
    assert float(np.abs(run.dumps["f"]["offset"]).max()) > 0
    assert plot_density(run, tmp_path / "f.svg", places=[1.0]).exists()
    run.to_netcdf(tmp_path / "run.nc")
    with pytest.raises(InputError, match="no dump 'g'"):
        plot_density(run, tmp_path / "g.png", "g")
