"""The textbook formulas in plain NumPy, with explicit pseudoinverses, as a reference for the library."""

from __future__ import annotations

import numpy as np

from fpbm_cpp._types import Array


def forward(lengths: Array, q: Array) -> Array:
    angle = np.cumsum(q)
    return np.array([lengths @ np.cos(angle), lengths @ np.sin(angle)])


def jacobian(lengths: Array, q: Array) -> Array:
    angle = np.cumsum(q)
    links = np.array([-lengths * np.sin(angle), lengths * np.cos(angle)])
    return np.cumsum(links[:, ::-1], axis=1)[:, ::-1]


def jacobian_dot(lengths: Array, q: Array, qd: Array) -> Array:
    angle, rate = np.cumsum(q), np.cumsum(qd)
    links = np.array([-lengths * np.cos(angle) * rate, -lengths * np.sin(angle) * rate])
    return np.cumsum(links[:, ::-1], axis=1)[:, ::-1]


def weighted_pinv(J: Array, W: Array) -> Array:
    """J_W+ = W^-1 J' (J W^-1 J')^-1."""
    WinvJt = np.linalg.inv(W) @ J.T
    return WinvJt @ np.linalg.inv(J @ WinvJt)


def velocity(J: Array, W: Array, v: Array, z: Array) -> Array:
    """(3), (6), (7)."""
    P = weighted_pinv(J, W)
    return P @ v + (np.eye(len(z)) - P @ J) @ z


def acceleration(alpha: float, J: Array, Jd: Array, W: Array, b: Array, xd: Array, z: Array) -> Array:
    """(5), (8), (9), (13), (16), with z projected by N_W."""
    n = J.shape[1]
    P, PW = np.linalg.pinv(J), weighted_pinv(J, W)
    N_W = np.eye(n) - PW @ J
    Winv = np.linalg.inv(W)
    man = P @ b
    wmvn = PW @ b + N_W @ Winv @ Jd.T @ np.linalg.inv(J @ Winv @ J.T) @ xd
    return (1 - alpha) * man + alpha * wmvn + N_W @ z
