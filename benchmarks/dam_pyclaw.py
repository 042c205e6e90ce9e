"""The same dam in PyClaw: order 1, the Roe solver of its Fortran library."""

from __future__ import annotations

import logging
from typing import Any

from cases import Call, Case


def pyclaw_step(case: Case) -> Call | None:
    """One step of the homogeneous equations, or None where PyClaw is not installed."""
    try:
        from clawpack import pyclaw, riemann  # type: ignore[import-not-found]
    except ImportError:
        return None
    logging.getLogger("pyclaw").setLevel(logging.ERROR)
    cells = case.scene.cells
    solver: Any = pyclaw.ClawSolver1D(riemann.shallow_roe_with_efix_1D)
    solver.order, solver.limiters, solver.dt_variable = 1, [0], False
    solver.bc_lower[0] = solver.bc_upper[0] = pyclaw.BC.extrap
    domain = pyclaw.Domain([pyclaw.Dimension(cells.left, cells.right, cells.count, name="x")])
    state = pyclaw.State(domain, solver.num_eqn)
    state.problem_data |= {"grav": case.scene.beta, "dry_tolerance": 1e-12, "sea_level": 0.0}
    state.q[0], state.q[1] = case.h, case.q
    solver.dt = solver.dt_initial = 1e-9 * case.dt  # the state stays what it is
    solution = pyclaw.Solution(state, domain)
    solver.setup(solution)
    return lambda: solver.step_hyperbolic(solution)
