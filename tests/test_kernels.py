"""Compiled code against the same formulas as plain Python, and what is compiled at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent

PROGRAM = """
import sys
import numpy as np
from kinsim import Arc, ConstantSlope, Coulomb, Fitted, Kinetic, Macroscopic, SmoothChute, Uniform
from kinsim.method import EquilibriumName, ForceName
from kinsim.solver.solver import Solver
from states import random_states, scene_with
from dataclasses import replace
from typing import get_args

def on_a_grid(**chosen):
    return Kinetic(velocity=Uniform(8, 4.0), **chosen)

methods = [Macroscopic(1), Macroscopic(2), Macroscopic(3), Macroscopic(3, "face"), Macroscopic(4),
           Macroscopic(4, order=2), Macroscopic(4, statics="reflect"), Kinetic(4, Fitted(3))]
methods += [on_a_grid(scheme=1, equilibrium=name) for name in get_args(EquilibriumName)]
methods += [on_a_grid(scheme=1, force=name, projection="re-summed") for name in get_args(ForceName)]
dense = [on_a_grid(scheme=3), on_a_grid(), on_a_grid(order=2), on_a_grid(statics="reflect")]
h, u = random_states(np.random.default_rng(5), 8, decades=0.5)
found = []
for method in methods + dense:
    for chute in (ConstantSlope(0.2), SmoothChute(Arc(9.0, 0.2), 1.0))[: 2 if method.scheme == 4 else 1]:
        scene = replace(scene_with(h, u, delta=0.3, boundary="wall"), chute=chute)
        stages = Solver(scene, method).stages(h, h * u, 4e-3)
        found += [stages[name] for name in ("F1", "F2", "h1", "qhat", "J", "q1")]
        if method in dense and chute.kind == "constant":
            found += [stages.density.M.ravel(), stages.density.transported.ravel(), stages.density.f.ravel()]
np.save(sys.argv[1], np.concatenate(found))
"""


def made(path: Path, **more: str) -> np.ndarray:
    """Stages of a step of all methods, from a process of its own."""
    env = {**os.environ, "PYTHONPATH": str(HERE), **more}
    done = subprocess.run([sys.executable, "-c", PROGRAM, path], env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    stages: np.ndarray = np.load(path)
    return stages


def test_compiled_steps_are_the_formulas_as_plain_python(tmp_path: Path) -> None:
    """All stages of a step, of every scheme, flux, force and bed, up to the rounding that the compiler may change."""
    compiled = made(tmp_path / "compiled.npy")
    plain = made(tmp_path / "plain.npy", NUMBA_DISABLE_JIT="1")
    assert np.isfinite(compiled).all()
    np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-13)


def test_what_nobody_chose_is_never_compiled() -> None:
    """A kinetic run with the defaults makes the parts of its own classes only, and no array of the density."""
    program = (
        "import kinsim\n"
        "from kinsim.compiled import apart\n"
        "scene = kinsim.load_scene('riemann')[0]\n"
        "kinsim.simulate(scene, kinsim.Kinetic(1, kinsim.Uniform(8, 3.0)), kinsim.Fixed(1e-3, 2))\n"
        "print(*{cls.__name__ for key in apart._apart for cls in key[2]})\n"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    used = set(found.stdout.split())
    assert used >= {"Upwind", "First", "Nodes", "CellAverage", "Plane"}
    assert not used & {"Balanced", "CoupledByCell", "CoupledByFace", "Held", "Reflecting", "Second", "GaussJacobi"}
    assert not used & {"Sampled", "Matched", "Entropic", "Curve", "Resummed", "ShiftLinear", "ShiftPFC", "Before"}
