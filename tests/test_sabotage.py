"""The validation turns red when something is broken on purpose."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from kinsim import printed
from kinsim.balance import schemes, stages
from kinsim.kinetic.wing import Density
from kinsim.macroscopic import wing

FOLDER = Path(__file__).parent.parent / "validation"


def load(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(FOLDER))
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module


def failing(monkeypatch: pytest.MonkeyPatch, out: Path) -> list[str]:
    """The claims of the canary that do not hold."""
    claims, canary = load("claims", monkeypatch), load("canary", monkeypatch)
    chapter = claims.Chapter("canary", canary.__doc__, False, out)
    canary.main(chapter)
    assert chapter.close(0.0) == all(claim.holds for claim in chapter.claims)
    return [claim.sentence for claim in chapter.claims if not claim.holds]


def printed_flux(hl: Any, ul: Any, hr: Any, ur: Any, beta: float, F1: np.ndarray, F2: np.ndarray) -> None:
    F1[:], F2[:] = printed.flux(hl, ul, hr, ur, beta)


def reversed_shift(self: Density, f: Any, M: Any, now: Any, out: Any) -> float:
    return self._force(f, M, -now.J, self.pulled(now), self.grid.dxi, out, self.offset)


def no_ghosts(boundary: object, h: np.ndarray, u: np.ndarray) -> None:
    h[0] = h[-1] = u[0] = u[-1] = 0.0


BREAKS: dict[str, tuple[Callable[[pytest.MonkeyPatch], None], str]] = {
    "the printed I3": (lambda patch: patch.setattr(wing, "flux_closed", printed_flux), "closed-form flux"),
    "a sign error in the shift": (lambda patch: patch.setattr(Density, "_push", reversed_shift), "momentum of f"),
    "a dropped ghost cell": (lambda patch: patch.setattr(stages, "extend", no_ghosts), "mass between walls"),
    "a coupling by cell called conservative": (
        lambda patch: patch.setattr(schemes, "Scheme3Face", schemes.Scheme3Cell), "one flux per face"
    ),
}  # fmt: skip


def test_unbroken_all_claims_hold(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert failing(monkeypatch, tmp_path) == []


@pytest.mark.parametrize("what", BREAKS)
def test_broken_the_report_turns_red(what: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    sabotage, claim = BREAKS[what]
    sabotage(monkeypatch)
    assert any(claim in sentence for sentence in failing(monkeypatch, tmp_path))
