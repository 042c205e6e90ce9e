"""The whole validation turns red when something is broken on purpose: claim, page, terminal and exit code."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import kinsim

HERE = Path(__file__).parent

BREAKS = {
    "printed_flux": "closed-form flux against quadrature",
    "reversed_shift": "momentum of f after the shift",
    "dropped_ghosts": "mass between walls",
    "coupled_by_cell": "mass with one flux per face",
    "halved_threshold": "slow cells of scheme 3",
}
"""Function of sabotage.py, and the claim that has to fail."""

ROW = re.compile(r"<tr><td>([^<]+)</td>(?:<td class=\"number\">[^<]*</td>\s*){2}<td class=\"(good|bad)\">")


def validated(tmp_path: Path, sabotage: str = "") -> tuple[int, str, str]:
    """``kinsim validate --only canary`` in this checkout: exit code, what it printed, the page.

    Python imports a module called sitecustomize when it starts, so that every process finds the package broken.
    """
    path = tmp_path / "path"
    path.mkdir()
    (path / "sitecustomize.py").write_text(f"import sabotage\nsabotage.{sabotage}()\n" if sabotage else "")
    paths = (path, HERE, Path(kinsim.__file__).parents[1])
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths)), "COLUMNS": "200"}
    command = [sys.executable, "-P", "-m", "kinsim", "validate", "--only", "canary", "--out", str(tmp_path / "out")]
    done = subprocess.run(command, cwd=HERE.parent, env=env, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 1), f"ended with {done.returncode}: {done.stdout}{done.stderr}"
    return done.returncode, done.stdout, (tmp_path / "out" / "index.html").read_text(encoding="utf-8")


def test_unbroken_it_is_green(tmp_path: Path) -> None:
    code, told, page = validated(tmp_path)
    claims = dict(ROW.findall(page))
    assert len(claims) >= len(BREAKS)
    assert set(claims.values()) == {"good"}
    assert all(any(claim in sentence for sentence in claims) for claim in BREAKS.values())
    assert "Every claim holds." in page
    assert "fails" not in told
    assert code == 0


@pytest.mark.parametrize("sabotage", BREAKS)
def test_broken_it_turns_red(sabotage: str, tmp_path: Path) -> None:
    """The claim that guards the broken part fails by its number, and nothing crashed instead."""
    code, told, page = validated(tmp_path, sabotage)
    failed = [sentence for sentence, mark in ROW.findall(page) if mark == "bad"]
    assert any(BREAKS[sabotage] in sentence for sentence in failed), failed
    assert "Not every claim holds." in page
    assert "broke:" not in page + told
    assert any(BREAKS[sabotage] in line and "fails" in line for line in told.splitlines())
    assert code == 1
