"""What the tests share: the five scenes of the paper as values, and hypothesis without dice."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fixed, Parabola, Scene, Sine

settings.register_profile("kinsim", derandomize=True, deadline=None, print_blob=True)
settings.load_profile("kinsim")

EPS = float(np.finfo(float).eps)

SILO = Blocks(edges=(-1, 1), heights=(0.3, 2.3, 0.3))

SCENES: dict[str, tuple[Scene, Fixed]] = {
    "riemann": (
        Scene(cells=Cells(-6, 6, 240), heap=Blocks((0,), (1, 0.5)), friction=Coulomb(0.0), epsilon=0.4),
        Fixed(1e-3, 5000),
    ),
    "silo": (
        Scene(cells=Cells(-8, 8, 320), heap=SILO, friction=Coulomb(math.pi / 10), epsilon=0.4),
        Fixed(1e-3, 10_000),
    ),
    "silo-incline": (
        Scene(
            cells=Cells(-8, 8, 320), heap=SILO, chute=ConstantSlope(math.pi / 15),
            friction=Coulomb(math.pi / 5), epsilon=0.4,
        ),
        Fixed(1e-3, 8000),
    ),
    "parabola": (
        Scene(
            cells=Cells(-4, 4, 160), heap=Parabola(peak=1.0, steepness=4.0),
            friction=Coulomb(math.pi / 15), epsilon=0.4,
        ),
        Fixed(1e-3, 6000),
    ),
    "sine": (
        Scene(
            cells=Cells(-3, 11, 280), heap=Sine(start=0.6), chute=ConstantSlope(math.pi / 6),
            friction=Coulomb(math.pi / 18), epsilon=0.3218,
        ),
        Fixed(1e-3, 4000),
    ),
}  # fmt: skip
"""theory.md, section 2, as values: what the built-in scene files have to say."""


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers, the same in every run."""
    return np.random.default_rng(20240229)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """The Chromium that `.ci/browser.py` found, for tests in the browser alone."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=os.environ["KINSIM_CHROMIUM"], args=["--no-sandbox"])
        yield browser
        browser.close()


def random_states(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Heights over five decades and velocities on both sides of the sound barrier of beta = 0.4, some at rest."""
    h = 10.0 ** rng.uniform(-4, 1, count)
    u = rng.uniform(-1.5, 1.5, count) * np.sqrt(0.8 * h)
    u[::7] = 0.0
    return h, u
