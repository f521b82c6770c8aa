"""Times of the paper's circle from Python: fpbm_cpp, NumPy and SciPy, in one run.

10 s at 1 kHz require 40,000 evaluations of FPBM. NumPy computes the same RK4 steps with the same law as fpbm_cpp. The
tolerance of SciPy's DOP853 gives the accuracy of these steps.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import fpbm_cpp as fp

Array = NDArray[np.float64]

T, STEPS, RADIUS = 10.0, 10_000, 0.45
ALPHA, W, K1, K2 = 0.6, np.array([1.0, 2.0, 3.0, 4.0]), 1.0, 1.0
LENGTHS = np.ones(4)
Q0 = np.pi / np.array([12, 12, 15, 15])
QD_FINAL = np.array([-0.0093120960, 0.0309612098, -0.0232966450, -0.0102744949])  # Independent reference solution.


def fpbm_numpy(t: float, state: Array, anchor: Array) -> Array:
    """FPBM (13) in typical NumPy code, by solving 2 x 2 systems."""
    q, qd = state[:4], state[4:]
    s, sd, sdd = (
        math.sin(math.pi * t / (2 * T)) ** 2,
        math.pi / (2 * T) * math.sin(math.pi * t / T),
        math.pi**2 / (2 * T**2) * math.cos(math.pi * t / T),
    )
    phi, rate, rate2 = 2 * math.pi * s, 2 * math.pi * sd, 2 * math.pi * sdd
    c, n = math.cos(phi), math.sin(phi)
    x = anchor + RADIUS * np.array([c - 1, n])
    xd = RADIUS * rate * np.array([-n, c])
    xdd = RADIUS * (rate2 * np.array([-n, c]) - rate**2 * np.array([c, n]))

    angle = np.cumsum(q)
    links = np.array([LENGTHS * np.cos(angle), LENGTHS * np.sin(angle)])
    sums = np.cumsum(links[:, ::-1], axis=1)[:, ::-1]
    J = np.array([-sums[1], sums[0]])
    Jd = -np.cumsum((links * np.cumsum(qd))[:, ::-1], axis=1)[:, ::-1]

    b = xdd - Jd @ qd + K1 * (xd - J @ qd) + K2 * (x - sums[:, 0])
    WinvJt = J.T / W[:, None]
    gram = J @ WinvJt
    u = Jd.T @ np.linalg.solve(gram, ALPHA * xd) / W
    qdd = (1 - ALPHA) * J.T @ np.linalg.solve(J @ J.T, b) + u + WinvJt @ np.linalg.solve(gram, ALPHA * b - J @ u)
    return np.concatenate([qd, qdd])


def start() -> tuple[Array, Array]:
    angle = np.cumsum(Q0)
    return np.concatenate([Q0, np.zeros(4)]), np.array([LENGTHS @ np.cos(angle), LENGTHS @ np.sin(angle)])


def by_numpy() -> Array:
    state, anchor = start()
    h = T / STEPS
    for i in range(STEPS):
        t = i * h
        k1 = fpbm_numpy(t, state, anchor)
        k2 = fpbm_numpy(t + h / 2, state + h / 2 * k1, anchor)
        k3 = fpbm_numpy(t + h / 2, state + h / 2 * k2, anchor)
        k4 = fpbm_numpy(t + h, state + h * k3, anchor)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state[4:]


def by_scipy() -> Array:
    state, anchor = start()
    y: Array = solve_ivp(fpbm_numpy, (0, T), state, "DOP853", rtol=1e-12, atol=1e-14, args=(anchor,)).y
    return y[4:, -1]


def by_fpbm() -> Array:
    arm, path = fp.PlanarArm(LENGTHS), fp.Circle(RADIUS, T)
    qd: Array = fp.simulate(arm, path, fp.FPBM(ALPHA, W, K1, K2), Q0, dt=T / STEPS).qd[-1]
    return qd


def timed(solve: Callable[[], Array], runs: int) -> tuple[list[float], float]:
    seconds = []
    for _ in range(runs):
        begin = time.perf_counter()
        qd = solve()
        seconds.append(time.perf_counter() - begin)
    return sorted(seconds), float(np.abs(qd - QD_FINAL).max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="also write the times to this JSON file")
    options = parser.parse_args()

    # fpbm_cpp is timed before and after NumPy and SciPy, to detect a change of the speed of the machine.
    before, error = timed(by_fpbm, 100)
    rows = [("NumPy, same RK4 steps", *timed(by_numpy, 3)), ("SciPy DOP853, equal accuracy", *timed(by_scipy, 3))]
    after, _ = timed(by_fpbm, 100)
    ours = sorted(before + after)
    print(f"{'10 s circle at 1 kHz, FPBM':32}{'median':>12}{'least':>12}{'ratio':>9}  error of final qd [rad/s]")
    results = []
    for name, seconds, difference in [("fpbm_cpp simulate", ours, error), *rows]:
        median = seconds[len(seconds) // 2]
        ratio = median / ours[len(ours) // 2]
        print(f"{name:32}{median * 1e3:9.2f} ms{seconds[0] * 1e3:9.2f} ms{ratio:9.1f}  {difference:.1e}")
        results.append({"name": name, "median": median, "least": seconds[0], "ratio": ratio, "error": difference})
    if options.out:
        options.out.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
