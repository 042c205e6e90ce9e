"""Parts from a file of somebody else's, with kinsim as it is installed and not as it stands here."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

MINE = """
import math
from typing import NamedTuple

import numpy as np


class Wet(NamedTuple):
    mu: float
    pore: float

    def resistance(law, h, v, n):
        return (1.0 - law.pore) * law.mu * n


def rusanov(h_left, u_left, h_right, u_right, beta):
    fastest = max(abs(u_left) + math.sqrt(2.0 * beta * h_left), abs(u_right) + math.sqrt(2.0 * beta * h_right))
    q_left, q_right = h_left * u_left, h_right * u_right
    F1 = 0.5 * (q_left + q_right - fastest * (h_right - h_left))
    push = q_left * u_left + q_right * u_right + 0.5 * beta * (h_left * h_left + h_right * h_right)
    return F1, 0.5 * (push - fastest * (q_right - q_left))


def hump(x):
    return np.exp(-4.0 * x * x), 0.2 * x


class Highest:
    name, every = "highest", 1

    def __init__(self):
        self.seen = []

    def look(self, block):
        self.seen.append(float(block.h.max()))
        return "low enough" if self.seen[-1] < 0.8 else None

    def result(self):
        return self.seen
"""

USE = """
import json, kinsim, mine
scene = kinsim.Scene(kinsim.Cells(-2, 2, 40), mine.hump, kinsim.ConstantSlope(0.3), mine.Wet(0.3, 0.5), epsilon=0.4)
run = kinsim.simulate(
    scene, kinsim.Macroscopic(scheme=1, flux=mine.rusanov), kinsim.Fixed(0.005, 400), observers=[mine.Highest()]
)
print(json.dumps([kinsim.__file__, run.verdict.kind, run.mass_drift, run.steps, run.observed["highest"]]))
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the wheel of this checkout is installed, without what it depends on."""
    source, wheels, folder = (tmp_path_factory.mktemp(name) for name in ("source", "wheels", "installed"))
    shutil.copytree(ROOT / "kinsim", source / "kinsim", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", str(wheels), str(source)], check=True)
    (wheel,) = wheels.glob("kinsim-*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--no-index", "--target", str(folder), str(wheel)], check=True)
    return folder


def test_parts_of_ones_own_run_in_an_installed_package(installed: Path, tmp_path: Path) -> None:
    """A law, a flux, an initial state and an observer that ends the run."""
    (tmp_path / "mine.py").write_text(MINE)
    path = os.pathsep.join([str(installed), str(tmp_path)])
    code = "import sys; sys.path[:0] = " + repr(path.split(os.pathsep)) + "\n" + USE
    out = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    where, verdict, drift, steps, highest = json.loads(out.stdout)
    assert Path(where).is_relative_to(installed)
    assert verdict == "stopped"
    assert drift <= 1e-14
    assert len(highest) == steps < 400
    assert highest[-1] < 0.8 <= highest[-2]
