"""The same steps as a user of NumPy would write them at first: whole arrays, formula by formula."""

from __future__ import annotations

import numpy as np
from cases import Array, Case


def carried(case: Case, n: int) -> list[Array]:
    """One step of scheme 1 with f on `n` sampled nodes; returns h, q and f at level n + 1."""
    beta, s, R, dx, dt = case.force
    dxi = 2.0 * case.bound / n
    xi = (np.arange(n) - n // 2 + 0.5) * dxi
    h, q = np.pad(case.h, 1, mode="edge"), np.pad(case.q, 1, mode="edge")
    u = np.where(h > 0, q / h, 0.0)
    M = np.sqrt(np.maximum(2 * beta * h[:, None] - (xi - u[:, None]) ** 2, 0)) / (np.pi * beta)
    face = np.where(xi > 0, M[:-1], M[1:])
    F1, F2 = (face * xi).sum(axis=1) * dxi, (face * xi**2).sum(axis=1) * dxi
    f = M[1:-1] - dt / dx * xi * (face[1:] - face[:-1])
    h1 = h[1:-1] - dt / dx * (F1[1:] - F1[:-1])
    g = pull(h, u, beta, s, R, dx)
    q1 = q[1:-1] - dt / dx * (F2[1:] - F2[:-1]) + dt * g * h1
    return [h1, q1, shifted(f, dt * g / dxi)]


def pull(h: Array, u: Array, beta: float, s: float, R: float, dx: float) -> Array:
    """The total acceleration g (not gravity) of each cell."""
    still = np.clip(beta * (h[2:] - h[:-2]) / (2 * dx), s - R, s + R)
    return np.where(u[1:-1] == 0, still, s - np.sign(u[1:-1]) * R)


def shifted(f: Array, by: Array) -> Array:
    """Each row of f moved by so many velocity cells, linearly between two nodes, as an interpolation would do it."""
    n = f.shape[1]
    whole = np.trunc(by).astype(int)
    theta = np.abs(by - whole)[:, None]
    near = np.arange(n) - whole[:, None]
    far = near - np.where(by < 0, -1, 1)[:, None]
    row = np.arange(len(f))[:, None]
    inside = [np.where((at >= 0) & (at < n), f[row, np.clip(at, 0, n - 1)], 0.0) for at in (near, far)]
    moved: Array = (1 - theta) * inside[0] + theta * inside[1]
    return moved


def closed(case: Case) -> list[Array]:
    """One step of scheme 1 with I1 to I4 in the paper's form, its misprints mended; returns h and q at level n + 1."""
    beta, s, R, dx, dt = case.force
    h, q = np.pad(case.h, 1, mode="edge"), np.pad(case.q, 1, mode="edge")
    u = np.where(h > 0, q / h, 0.0)
    a = np.clip(-u / np.sqrt(2 * beta * h), -1, 1)
    cube = np.cos(np.arcsin(a)) ** 3
    lower, upper = np.pi / 4 - np.arcsin(a) / 2, np.pi / 4 + np.arcsin(a) / 2
    sine, fourth = np.sin(2 * np.arcsin(a)) / 4, np.sin(4 * np.arcsin(a)) / 32
    of_cos = np.sqrt(2 * beta) * h**1.5 * cube
    i1 = 2 / (3 * np.pi) * of_cos + 2 / np.pi * h * u * (lower - sine)
    i2 = -2 / (3 * np.pi) * of_cos + 2 / np.pi * h * u * (upper + sine)
    mixed = 4 / (3 * np.pi) * of_cos * u
    quarter = 4 / np.pi * beta * h**2
    i3 = quarter * (lower / 4 + fourth) + mixed + 2 / np.pi * h * u**2 * (lower - sine)
    i4 = quarter * (upper / 4 - fourth) - mixed + 2 / np.pi * h * u**2 * (upper + sine)
    F1, F2 = i1[:-1] + i2[1:], i3[:-1] + i4[1:]
    h1 = h[1:-1] - dt / dx * (F1[1:] - F1[:-1])
    q1 = q[1:-1] - dt / dx * (F2[1:] - F2[:-1]) + dt * pull(h, u, beta, s, R, dx) * h1
    return [h1, q1]
