"""FPBM near singular postures, with five kinds of damping: draws singularities.png and prints its numbers.

    python docs/figures/singularities.py [where to write the picture]

The library computes the motions without damping and with the damping of fpbm_cpp. NumPy computes the motions with two
dampings of all directions: constant damping (Wampler, 1986), and damping below a threshold of the manipulability
(Nakamura and Hanafusa, 1986). With damping, the largest gain from a desired tip velocity to the joint velocities is
1.2/ε or less.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import fpbm_cpp as fp

ALPHA, K1, K2, NULL_DAMPING = 0.6, 20.0, 100.0, 2.0
RADIUS = 0.02
STEP = 1e-3  # [s]

Vector = np.ndarray
Resolve = Callable[[Vector, Vector, Any, Vector, Vector], Vector]


@dataclass
class Motion:
    """An arm on a path that meets a singular posture."""

    title: str
    arm: Any
    task: str
    weights: list[float]
    q0: Vector
    singular: Vector
    path: Any
    hold: float
    reach: float = np.inf  # [m], from the base

    def target(self, t: float) -> tuple[Any, Vector, Vector]:
        """Reference of the tip, and its first two derivatives."""
        x, xd, xdd = self.path.sample(min(t, self.path.duration))
        if t >= self.path.duration:
            xd, xdd = np.zeros_like(xd), np.zeros_like(xdd)
        start = self.arm.forward(self.q0)
        if self.task == "position":
            return start + x, xd, xdd
        reference = start.copy()
        reference[:3, 3] += np.asarray(x)[:3, 3]
        return reference, xd, xdd

    def error(self, q: Vector, x: Any) -> Vector:
        tip = self.arm.forward(q)
        if self.task == "position":
            return x - tip
        return np.concatenate([x[:3, 3] - tip[:3, 3], fp.rotation_vector(x[:3, :3] @ tip[:3, :3].T)])

    def jacobian(self, q: Vector) -> Vector:
        return self.arm.jacobian(q, task=self.task)

    @property
    def edge(self) -> float:
        """ε at the singular posture."""
        return RADIUS * float(np.linalg.norm(self.jacobian(self.singular)))


def library(motion: Motion, null_damping: float = NULL_DAMPING, **options: float) -> Resolve:
    scheme = fp.FPBM(ALPHA, motion.weights, K1, K2, null_damping=null_damping, **options)
    return lambda q, qd, x, xd, xdd: scheme.resolve(motion.arm, q, qd, x, xd, xdd, task=motion.task)


def damped_everywhere(motion: Motion, damping: Callable[[Vector], float]) -> Resolve:
    """FPBM with J W⁻¹Jᵀ + k I instead of J W⁻¹Jᵀ."""
    winv = np.min(motion.weights) / np.asarray(motion.weights)

    def resolve(q: Vector, qd: Vector, x: Any, xd: Vector, xdd: Vector) -> Vector:
        J, Jd = motion.jacobian(q), motion.arm.jacobian_dot(q, qd, task=motion.task)
        k = damping(J) * np.eye(len(J))
        plain, weighted = np.linalg.inv(J @ J.T + k), np.linalg.inv(J * winv @ J.T + k)
        b = xdd - Jd @ qd + K1 * (xd - J @ qd) + K2 * motion.error(q, x)
        u = ALPHA * winv * (Jd.T @ (weighted @ xd)) - NULL_DAMPING * qd
        return (1 - ALPHA) * J.T @ (plain @ b) + u + winv * (J.T @ (weighted @ (ALPHA * b - J @ u)))

    return resolve


def wampler(motion: Motion) -> Resolve:
    """Constant damping λ², of largest gain 1/(2λ) = 1.17/ε."""
    return damped_everywhere(motion, lambda J: (motion.edge / 2.34) ** 2)


def nakamura_hanafusa(motion: Motion) -> Resolve:
    """k₀ (1 − w/w₀)² if w = √det(JJᵀ) is below w₀; k₀ = ε², and w₀ is the manipulability at σ_min = ε."""
    w0 = motion.edge * np.prod(np.linalg.svd(motion.jacobian(motion.singular), compute_uv=False)[:-1])

    def damping(J: Vector) -> float:
        w = np.prod(np.linalg.svd(J, compute_uv=False))
        return motion.edge**2 * max(0.0, 1 - w / w0) ** 2

    return damped_everywhere(motion, damping)


TREATMENTS: dict[str, tuple[Callable[[Motion], Resolve], dict[str, Any]]] = {
    "no damping": (library, {"color": "0.55", "lw": 1.2, "ls": (0, (1, 1))}),
    "constant damping": (wampler, {"color": "#E69F00", "lw": 1.4}),
    "damping by manipulability": (nakamura_hanafusa, {"color": "#009E73", "lw": 1.4, "ls": (0, (6, 1.5))}),
    "fpbm_cpp": (lambda motion: library(motion, singular_radius=RADIUS), {"color": "#0072B2", "lw": 2.0}),
    "fpbm_cpp, no brake": (
        lambda motion: library(motion, singular_radius=RADIUS, singular_brake=0.0),
        {"color": "#CC79A7", "lw": 1.2, "ls": (0, (4, 1, 1, 1))},
    ),
}


def run(motion: Motion, resolve: Resolve) -> dict[str, Vector]:
    """RK4 until the end, or until a joint turns by more than a quarter of a radian in a step."""
    rows: list[tuple[float, ...]] = []
    q, qd = motion.q0.copy(), np.zeros_like(motion.q0)
    h = STEP

    def qdd(t: float, q: Vector, qd: Vector) -> Vector:
        return resolve(q, qd, *motion.target(t))

    for t in np.arange(0.0, motion.path.duration + motion.hold + h / 2, h):
        try:
            a1 = qdd(t, q, qd)
            sigma = np.linalg.svd(motion.jacobian(q), compute_uv=False)[-1]
            error = np.linalg.norm(motion.error(q, motion.target(t)[0]))
            rows.append((t, sigma, np.linalg.norm(qd), np.linalg.norm(a1), error))
            a2 = qdd(t + h / 2, q + h / 2 * qd, v2 := qd + h / 2 * a1)
            a3 = qdd(t + h / 2, q + h / 2 * v2, v3 := qd + h / 2 * a2)
            a4 = qdd(t + h, q + h * v3, v4 := qd + h * a3)
        except fp.ResolutionError:
            break
        q = q + h / 6 * (qd + 2 * v2 + 2 * v3 + v4)
        qd = qd + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        if h * np.abs(qd).max() > 0.25:
            break
    return dict(zip(("t", "sigma", "speed", "acceleration", "error"), np.array(rows).T, strict=True))


def to_the_edge(beyond: float = 0.02, back: bool = True) -> Motion:
    """Four links of 1 m, sent along a line to an unreachable point, and back."""
    arm = fp.PlanarArm([1.0, 1.0, 1.0, 1.0])
    q0 = np.array([0.3, 0.9, -0.5, 0.8])
    start = arm.forward(q0)
    angle = np.arctan2(start[1], start[0]) + 0.5
    displacement = (4.0 + beyond) * np.array([np.cos(angle), np.sin(angle)]) - start
    path = fp.Line(displacement, 4.0, time_law="quintic")
    if back:
        path = path.then(fp.Line(-displacement, 4.0, time_law="quintic"))
    title = "Four links, to 2 cm beyond the workspace and back"
    singular = np.array([angle, 0, 0, 0])
    return Motion(title, arm, "position", [1, 2, 3, 4], q0, singular, path, 2.0 if back else 30.0, reach=4.0)


def through_the_middle() -> Motion:
    """A Panda on a line at constant orientation, through a posture in which the joint axes 1, 3, 5, 7 meet in a point.

    In this posture, no joint moves the tip perpendicular to the plane of the arm. The reference stays in this plane.
    """
    arm = fp.SerialArm.preset("panda")
    singular = np.array([0, 0, 0, -1.6, 0, 3.330367060928, 0])
    displacement = np.array([0.1, 0.0, -0.3])
    goal = arm.forward(singular)
    goal[:3, 3] -= displacement / 2
    q0 = singular.copy()
    in_plane = [1, 3, 5]
    for _ in range(50):  # Newton, by the three joints that move the tip in that plane.
        tip = arm.forward(q0)
        error = np.concatenate([goal[:3, 3] - tip[:3, 3], fp.rotation_vector(goal[:3, :3] @ tip[:3, :3].T)])
        q0[in_plane] += np.linalg.lstsq(arm.jacobian(q0, task="pose")[:, in_plane], error, rcond=None)[0]
    path = fp.Line(displacement, 4.0, time_law="quintic").with_rotation([0, 0, 0])
    return Motion("A Panda, on a line through a singular posture", arm, "pose", [1] * 7, q0, singular, path, 1.0)


def draw(axes: Any, motion: Motion) -> None:
    print(f"{motion.title}: ε = {motion.edge:.3f}")
    print(f"{'':28}least σ   peak q̇   peak q̈   error: at 1 s   largest    at the end")
    for name, (treatment, style) in TREATMENTS.items():
        done = run(motion, treatment(motion))
        t, error = done["t"], done["error"]
        stopped = t[-1] < motion.path.duration + motion.hold - STEP
        for row, key in enumerate(("sigma", "acceleration", "error")):
            axes[row].plot(t, np.maximum(done[key], 1e-18), label=name, **style)
            if stopped:
                axes[row].plot(t[-1], done[key][-1], "x", color=style["color"], ms=7, mew=2)
        at_one = error[round(1.0 / STEP)]
        end = f"stopped at {t[-1]:.3f} s" if stopped else f"{error[-1]:.1e}"
        print(
            f"  {name:26}{done['sigma'].min():8.1e}{done['speed'].max():9.3g}{done['acceleration'].max():9.3g}"
            f"{at_one:14.1e}{error.max():12.1e}    {end}"
        )
    axes[0].axhline(motion.edge, color="k", lw=0.8, ls=":")
    axes[0].annotate(
        "ε", (1.0, motion.edge), xycoords=("axes fraction", "data"), xytext=(3, -3), textcoords="offset points"
    )
    if np.isfinite(motion.reach):
        ts = np.arange(0.0, motion.path.duration, STEP)
        beyond = np.array([np.linalg.norm(motion.target(t)[0]) for t in ts]) - motion.reach
        axes[2].plot(ts[beyond > 0], beyond[beyond > 0], color="k", lw=0.8, ls=":")
        axes[2].annotate(
            "unreachable", (4.0, beyond.max()), (0, 9), textcoords="offset points", ha="center", fontsize=8
        )
    axes[0].set_title(motion.title, fontsize=10)


def rest_at_the_edge() -> None:
    """How the arm settles if the target stays at an unreachable point."""
    motion = to_the_edge(beyond=0.1, back=False)
    print("Four links, target held 10 cm beyond the workspace: joint speed 30 s later [rad/s]")
    for null_damping in (0.0, NULL_DAMPING):
        for brake in (0.0, 10.0):
            done = run(motion, library(motion, null_damping, singular_radius=RADIUS, singular_brake=brake))
            print(f"  null damping {null_damping:.0f}/s, brake {brake:2.0f}/s: {done['speed'][-1]:.1e}")


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "singularities.png"
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(3, 2, figsize=(9.6, 7.2), sharex="col", layout="constrained")
    for column, motion in enumerate((to_the_edge(), through_the_middle())):
        draw(axes[:, column], motion)
    for row, label in enumerate(
        (r"least singular value $\sigma_{\min}$", r"$\|\ddot q\|$  [rad/s²]", "tip error  [m, rad]")
    ):
        axes[row, 0].set_ylabel(label)
        for each in axes[row]:
            each.grid(alpha=0.25, lw=0.5)
            each.set_yscale("log" if row else "linear")
    for each in axes[1]:
        each.set_ylim(1e-2, 1e4)
    for each in axes[2]:
        each.set_ylim(1e-14, 1)
        each.set_xlabel("time  [s]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    figure.savefig(target, dpi=150)
    rest_at_the_edge()


if __name__ == "__main__":
    main()
