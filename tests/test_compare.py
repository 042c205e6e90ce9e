"""Several methods on one scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import SCENES

from kinsim import Courant, Fixed, InputError, Kinetic, Macroscopic, Uniform, compare, simulate

SILO = SCENES["silo"][0]
KINETIC = Kinetic(3, Uniform(32))


def test_differences_are_those_of_the_runs():
    clock = Fixed(1e-2, 40)
    measured = compare(SILO, [KINETIC, KINETIC.twin], clock, save_every=10)
    one, other = (simulate(SILO, method, clock, save_every=10) for method in (KINETIC, KINETIC.twin))
    assert measured.sizes == {"method": 2, "t": 5}
    assert measured["method"].to_numpy().tolist() == ["kinetic, scheme 3, 32 nodes", "macroscopic, scheme 3"]
    np.testing.assert_array_equal(measured["t"], one.t)
    for name in ("h", "q"):
        off = np.abs(getattr(one, name) - getattr(other, name))
        np.testing.assert_allclose(measured[f"{name}_l1"][1], off.sum(axis=1) * SILO.cells.dx, rtol=1e-13)
        np.testing.assert_array_equal(measured[f"{name}_max"][1], off.max(axis=1))
        assert float(abs(measured[f"{name}_l1"][0]).max()) == 0.0
    assert 1e-6 < float(measured["h_l1"][1, -1]) < 1e-2
    assert (measured["wall_time"] > 0).all()
    assert measured["verdict_kind"].to_numpy().tolist() == ["finished", "finished"]


@pytest.mark.parametrize("first", [KINETIC, KINETIC.twin])
def test_with_a_courant_clock_all_meet_at_the_times_of_the_first(first):
    clock = Courant(number=0.7, end=0.5)
    measured = compare(SILO, [first, Macroscopic(scheme=1), KINETIC], clock, save_every=3)
    alone = simulate(SILO, first, clock, save_every=3)
    np.testing.assert_array_equal(measured["t"], alone.t)
    assert float(measured["t"][-1]) == 0.5
    assert measured["steps"].to_numpy().tolist() == [alone.steps] * 3


def test_alike_methods_are_numbered():
    measured = compare(SILO, [KINETIC, KINETIC, KINETIC.twin], Fixed(1e-2, 2))
    names = measured["method"].to_numpy().tolist()
    assert names == ["kinetic, scheme 3, 32 nodes (1)", "kinetic, scheme 3, 32 nodes (2)", "macroscopic, scheme 3"]
    assert float(measured["h_max"][1].max()) == 0.0


@pytest.mark.parametrize("clock", [Fixed(1e-2, 30), Courant(number=0.7, end=1.0)])
@pytest.mark.parametrize("narrow_first", [True, False])
def test_of_stopped_runs_the_common_rows_are_kept(clock, narrow_first):
    probe = simulate(SILO, KINETIC.twin, clock, save_every=1)
    reached = (np.abs(probe.u) + np.sqrt(2 * SILO.beta * probe.h)).max(axis=1)
    narrow = KINETIC.within(float(reached[0] + 0.3 * (reached.max() - reached[0])))
    methods = [narrow, KINETIC.twin] if narrow_first else [KINETIC.twin, narrow]
    measured = compare(SILO, methods, clock, save_every=2)
    kinds = dict(zip(measured["method"].to_numpy().tolist(), measured["verdict_kind"].to_numpy().tolist(), strict=True))
    assert kinds == {"kinetic, scheme 3, 32 nodes": "window-too-small", "macroscopic, scheme 3": "finished"}
    assert "outside the window" in str(measured["verdict"].to_numpy().tolist())
    assert 1 <= measured.sizes["t"] < probe.t.size // 2
    assert narrow_first or np.isin(measured["t"], probe.t).all()


def test_progress_goes_from_0_to_1_over_all_methods():
    shares: list[float] = []
    compare(SILO, [KINETIC, KINETIC.twin], Fixed(1e-3, 64), progress=shares.append)
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < 0.5
    assert 0.5 in shares
    assert shares[-1] == 1.0


def test_bad_requests():
    with pytest.raises(InputError, match="compare: no methods; give"):
        compare(SILO, [], Fixed(1e-2, 2))
    with pytest.raises(InputError, match="CFL"):
        compare(SILO, [KINETIC.twin], Fixed(1.0, 2))


def test_the_result_can_be_kept(tmp_path):
    measured = compare(replace(SILO, title="silo"), [KINETIC, KINETIC.twin], Fixed(1e-2, 2))
    measured.to_netcdf(tmp_path / "compared.nc", engine="h5netcdf")
    assert measured.attrs["title"] == "silo"
