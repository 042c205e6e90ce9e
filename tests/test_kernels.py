"""Compiled kernels against themselves as plain Python."""

from __future__ import annotations

import inspect
import subprocess
import sys
from importlib import import_module

import numba
import numpy as np
import pytest
from numba.core.registry import CPUDispatcher

from kinsim.kinetic.fitted import gauss_jacobi


def kernels() -> list[object]:
    """Every kernel of the kinetic and macroscopic wings, found by its dispatcher."""
    names = ("kinetic.transport", "kinetic.shift", "kinetic.derivative", "kinetic.fitted", "macroscopic.half_moments",
             "balance.interface", "balance.sides", "balance.impulse", "balance.update", "balance.stages",
             "balance.schemes", "watch.survey", "watch.causes")  # fmt: skip
    modules = [import_module(f"kinsim.{name}") for name in names]
    modules += [
        import_module(f"kinsim.kinetic.equilibrium.{m}")
        for m in ("rows", "averages", "few_nodes", "matched", "entropic")
    ]
    found = {id(v): v for m in modules for v in vars(m).values() if hasattr(v, "py_func")}
    return sorted(found.values(), key=lambda v: (v.__module__, v.__name__))


def example(kernel: object) -> list[object]:
    """Arguments by name and annotation: arrays of matching shapes, flags, scalars."""
    dice = np.random.default_rng(7)
    nx, n = 6, 8
    two = {"rows", "f", "M", "B", "out"}
    ghosted = {"h", "u", "h_ghosted", "u_ghosted"}
    arguments: list[object] = []
    names = list(inspect.signature(kernel.py_func).parameters.items())
    name_of = kernel.py_func.__name__
    for name, parameter in names:
        kind = parameter.annotation
        if name in two and kind == "Array":
            arguments.append(
                dice.uniform(
                    0.1, 1.0, (nx + (2 if name == "M" and name_of.startswith("transport") else 0) + (name == "B"), n)
                )
            )
        elif name == "xi":
            arguments.append(np.linspace(-0.7, 0.7, n))
        elif name in ("P", "N", "side", "w1", "w2"):
            arguments.append(dice.uniform(0.1, 1.0, n // 2))
        elif name == "room":
            arguments.append(np.zeros((5, 4) if name_of == "look_over" else 4))
        elif name == "row":
            arguments.append(np.zeros(n))
        elif name in ("s", "W") and kind == "Array":
            arguments.append(gauss_jacobi(4)[0 if name == "s" else 1].copy())
        elif kind == "Array" and name in ("F1", "F2", "B1", "B2", "F1_then", "F2_then"):
            arguments.append(dice.uniform(-1.0, 1.0, nx + 1))
        elif (
            kind == "Array"
            and name in ghosted
            and name_of
            in ("balanced", "sliding", "keep_dry", "stopping", "update", "move", "mean_of_stages", "candidate")
            and not (name == "h" and name_of == "split")
        ):
            arguments.append(dice.uniform(0.1, 1.0, nx + 2))
        elif kind == "Array" and name in ("h_ghosted", "u_ghosted"):
            arguments.append(np.zeros(nx + 2))
        elif kind == "Array" and name == "sums":
            arguments.append(dice.uniform(0.1, 1.0, (4, nx + 2)))
        elif kind == "Array" and name == "m":
            arguments.append(dice.uniform(0.1, 1.0, (5, nx + (1 if "h_left" in dict(names) else 2))))
        elif kind == "Array" and name in ("h", "u", "m1", "m2") and name_of.endswith("of_cells"):
            arguments.append(dice.uniform(0.1, 1.0, nx + 2))
        elif kind == "Array" and name == "out" and name_of == "half_moments_of_cells":
            arguments.append(np.zeros((4, nx + 2)))
        elif (
            kind == "Array"
            and name in ("h_left", "u_left", "h_right", "u_right")
            and name_of in ("balanced", "flux_closed", "flux_fitted", "faces_of_states")
        ):
            arguments.append(dice.uniform(0.1, 1.0, nx + 1))
        elif kind == "Array":
            arguments.append(dice.uniform(0.1, 1.0, nx))
        elif kind == "Flags":
            arguments.append(dice.random(nx + (name == "static")) < 0.5)
        elif kind == "NDArray[np.int64]":
            arguments.append(np.zeros(nx, dtype=np.int64))
        elif kind == "bool":
            arguments.append(True)
        elif kind == "int":
            arguments.append({"half": 4, "low": 0, "high": 1, "begin": 1, "end": n, "i": 2, "n": n, "flux": 1}[name])
        else:
            arguments.append(float(dice.uniform(0.2, 0.6)))
    return arguments


def with_a_door(kernel: object) -> object:
    """A kernel that only kernels call, compiled once more so that Python can call it."""
    options = {name: v for name, v in kernel.targetoptions.items() if name in ("error_model", "fastmath")}
    return kernel if type(kernel) is CPUDispatcher else numba.njit(**options)(kernel.py_func)


@pytest.mark.parametrize("kernel", kernels(), ids=lambda k: f"{k.__module__.removeprefix('kinsim.')}.{k.__name__}")
def test_kernel_equals_its_own_python_function(kernel: object) -> None:
    """Compiled and interpreted, the same arguments give the same results, up to the library's last digit of arcsin."""
    one, other = example(kernel), example(kernel)
    first = with_a_door(kernel)(*one)
    with np.errstate(all="ignore"):
        second = kernel.py_func(*other)
    for a, b in zip([*one, first], [*other, second], strict=True):
        if a is not None:
            np.testing.assert_allclose(np.asarray(a, dtype=float), np.asarray(b, dtype=float), rtol=1e-13, atol=1e-15)


def test_rooms_nobody_chose_are_never_compiled() -> None:
    """A kinetic run with the defaults loads the kernels of its own rooms only."""
    program = (
        "import kinsim, importlib\n"
        "scene = kinsim.load_scene('riemann')[0]\n"
        "kinsim.simulate(scene, kinsim.Kinetic(scheme=1, velocity=kinsim.Uniform(8)), kinsim.Fixed(1e-3, 2))\n"
        "from kinsim.kinetic import carry, derivative, fitted, occupied, shift, transport\n"
        "from kinsim.kinetic.equilibrium import averages, entropic, matched\n"
        "from kinsim.balance import impulse, interface, slide\n"
        "used = [averages.cell_average, occupied.sum_cells, carry.carry, slide.slide]\n"
        "unused = [averages.sampled, matched.matched, entropic.entropic, fitted.flux_fitted, shift.shift_pfc,\n"
        "          shift.shift_linear, derivative.derivative_upwind, derivative.derivative_centred,\n"
        "          interface.balanced, impulse.stopping, transport.transport]\n"
        "print(all(k.signatures for k in used), any(k.signatures for k in unused))\n"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["True", "False"]
