"""A Panda in MuJoCo with computed torque: circle, hold, push, two unreachable targets, and return to the start.

Every millisecond, Tracker.resolve_measured() computes an acceleration within the joint limits from the measured state.
tick.torque are the torques tau = M(q) qdd + h(q, qd) of the library's model. With an exact model, these torques would
realise this acceleration (computed torque). But in the controller's model, every mass and inertia is 2 % too large, and
there is no friction.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from itertools import islice
from math import pi
from typing import Any

import numpy as np
from panda_mjcf import TORQUE, panda, panda_mjcf

import fpbm_cpp as fp

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit("this example needs MuJoCo: pip install mujoco")

ARM = fp.SerialArm.preset("panda")
HOME = np.array([0, -pi / 4, 0, -3 * pi / 4, 0, pi / 2, pi / 4])  # [rad], the hand points down
DT = 1e-3  # A tick of the controller [s].
STEPS = 4  # Simulation steps per tick.

PHASES = {"circle": 0.0, "hold": 4.0, "push": 6.0, "too far": 9.0, "too near": 13.0, "home": 17.0}  # Start times [s].
END = 21.0  # [s]
CIRCLE = fp.Circle(0.12, 4.0, time_law="quintic").in_plane("xy")  # radius [m], duration [s]
START = ARM.forward(HOME)
AWAY = {"too far": (0.5, 0.0, 0.0), "too near": (-0.35, 0.0, -0.35)}  # Jumps of the target from START [m].
PUSH = (0.0, 30.0, 0.0)  # Force on link 4, at the elbow [N].
PUSH_LASTS = 0.3  # Duration of the push [s].

WEIGHTS = [8, 8, 4, 4, 2, 1, 1]  # Larger near the base, where joints carry more.
SCHEME = {"k1": 60, "k2": 900, "null_damping": 10, "rest_posture": HOME, "null_stiffness": 25}
# A quarter of the gain at the stability limit, k1 k2. The bound is in m/s² and rad/s²: the friction torque of the wrist
# divided by the inertia of the wrist is about 6 rad/s².
INTEGRAL = {"integral_gain": 0.25 * 60 * 900, "integral_bound": 10.0}


def margins() -> fp.JointLimits:
    """Limits slightly inside the arm's limits: the realised acceleration differs from the commanded acceleration."""
    real = ARM.limits
    return fp.JointLimits(
        lower=real.lower + 0.005,  # [rad]
        upper=real.upper - 0.005,
        velocity=0.995 * real.velocity,
        acceleration=real.acceleration,
    )


def phase(t: float) -> str:
    return [name for name, start in PHASES.items() if start <= t + DT / 2][-1]


def reference(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pose, velocity and acceleration of the target [m, s]. The orientation is constant."""
    displacement, velocity, acceleration = CIRCLE.sample(t)  # At rest after the end of the circle.
    x = START.copy()
    x[:3, 3] += displacement + AWAY.get(phase(t), (0, 0, 0))
    return x, np.append(velocity, np.zeros(3)), np.append(acceleration, np.zeros(3))


@dataclass
class Motion:
    """Tip errors [m], [rad] and torques [Nm] at each tick, joints [rad], [rad/s] at each simulation step."""

    tip: list[float] = field(default_factory=list)
    orientation: list[float] = field(default_factory=list)
    torque: list[np.ndarray] = field(default_factory=list)
    q: list[np.ndarray] = field(default_factory=list)
    qd: list[np.ndarray] = field(default_factory=list)

    def during(self, name: str, rows: str) -> np.ndarray:
        """The rows of a phase."""
        begins = [*PHASES.values(), END]
        i = list(PHASES).index(name)
        per_second = round((STEPS if rows in ("q", "qd") else 1) / DT)
        return np.array(getattr(self, rows)[round(begins[i] * per_second) : round(begins[i + 1] * per_second)])

    def clearance(self) -> tuple[np.ndarray, np.ndarray]:
        """Smallest distance of each joint from its bounds on position [rad] and on velocity [rad/s]."""
        q, qd, real = np.array(self.q), np.array(self.qd), ARM.limits
        return np.minimum(q - real.lower, real.upper - q).min(axis=0), (real.velocity - abs(qd)).min(axis=0)

    def settled(self) -> float:
        """Settling time [s] from the push until all joints stay below 0.01 rad/s and the tip error below 1 mm."""
        busy = (abs(self.during("push", "qd")[::STEPS]).max(axis=1) > 0.01) | (self.during("push", "tip") > 1e-3)
        return float(DT * (np.flatnonzero(busy).max(initial=-1) + 1))


def simulate(
    *,
    scheme: dict[str, Any] = SCHEME,
    integral: dict[str, float] = INTEGRAL,
    limits: fp.JointLimits | None = None,
    inertia_error: float = 0.02,
    friction: float = 1.0,
    delay: int = 0,  # The simulated state is exact and current.
    end: float = END,
) -> Motion:
    tracker = fp.Tracker(
        panda(inertia_error),
        fp.FPBM(0.6, WEIGHTS, **scheme),
        HOME,
        task="pose",
        dt=DT,
        limits=limits or margins(),
        measured_delay=delay,
        **integral,
    )
    arm = mujoco.MjModel.from_xml_string(panda_mjcf(friction=friction, timestep=DT / STEPS))
    world = mujoco.MjData(arm)
    world.qpos[:] = HOME

    motion = Motion()
    for t in DT * np.arange(round(end / DT)):
        tick = tracker.resolve_measured(world.qpos, world.qvel, *reference(t))
        world.ctrl[:] = tick.torque  # MuJoCo limits the torques.

        pushed = PHASES["push"] <= t < PHASES["push"] + PUSH_LASTS
        world.body("link4").xfrc_applied[:3] = PUSH if pushed else (0, 0, 0)
        for _ in range(STEPS):
            mujoco.mj_step(arm, world)
            motion.q.append(world.qpos.copy())
            motion.qd.append(world.qvel.copy())
        motion.torque.append(world.actuator_force.copy())
        motion.tip.append(float(np.linalg.norm(tick.error[:3])))
        motion.orientation.append(float(np.linalg.norm(tick.error[3:])))
    return motion


def report(motion: Motion) -> None:
    print("            tip error, mm     orientation error, mrad         fastest joint, rad/s")
    print("              rms      max   at end      rms      max   at end      max   at end")
    for name in PHASES:
        cells = []
        for error in (1e3 * motion.during(name, "tip"), 1e3 * motion.during(name, "orientation")):
            cells += [np.sqrt(np.mean(error**2)), error.max(), error[-1]]
        speed = abs(motion.during(name, "qd")).max(axis=1)
        print(f"{name:9}", *(f"{cell:8.3f}" for cell in [*cells, speed.max(), speed[-1]]))

    joints = motion.during("push", "q")
    position, velocity = motion.clearance()
    strain = abs(np.array(motion.torque)).max(axis=0)
    moved = abs(joints - joints[0]).max()
    print(f"\nthe push moved a joint by {moved:.3f} rad; at rest {motion.settled():.2f} s after it began")
    print(f"nearest to a bound at any of {len(motion.q)} steps, joint by joint:")
    print("  position, rad  ", *(f"{value:7.4f}" for value in position))
    print("  velocity, rad/s", *(f"{value:7.4f}" for value in velocity))
    print("greatest torque, Nm", *(f"{value:.1f}" for value in strain))


def draw(motion: Motion) -> Any:
    from matplotlib.figure import Figure

    from fpbm_cpp.plot import LIGHT, OKABE_ITO

    real = ARM.limits
    q = (2 * np.array(motion.q[STEPS - 1 :: STEPS]) - real.upper - real.lower) / (real.upper - real.lower)
    qd = np.array(motion.qd[STEPS - 1 :: STEPS]) / real.velocity
    t = DT * np.arange(1, len(q) + 1)

    figure = Figure(figsize=(8.0, 9.0), dpi=150, layout="constrained")
    axes = figure.subplots(4, 1, sharex=True)
    axes[0].semilogy(t, 1e3 * np.array(motion.tip), color=OKABE_ITO[5], lw=1.2, label="position [mm]")
    axes[0].semilogy(
        t, 1e3 * np.array(motion.orientation), color=OKABE_ITO[0], lw=1.0, ls="--", label="orientation [mrad]"
    )
    axes[0].axhline(1.0, color="0.5", lw=0.8, ls="--", label="1 mm and 1 mrad")
    axes[0].set(ylabel="tip error", ylim=(1e-3, 3e3))
    axes[0].legend(loc="lower center", bbox_to_anchor=(0.62, 0.0), frameon=False)
    torque = np.array(motion.torque) / np.array(TORQUE)
    for panel, rows, label in zip(axes[1:], (q, qd, torque), ("position", "velocity", "torque")):
        for i, (color, dash) in enumerate(islice(LIGHT.styles(), ARM.dof)):
            panel.plot(t, rows[:, i], color=color, ls=dash, lw=1.1, label=f"joint {i + 1}")
        for bound, name in ((-1, None), (1, "bound")):
            panel.axhline(bound, color="0.5", lw=0.8, ls="--", label=name)
        panel.set(ylabel=f"{label} / bounds", ylim=(-1.12, 1.12))
    figure.legend(*axes[1].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    ends = [*PHASES.values(), END]
    for i, name in enumerate(PHASES):
        for panel in axes:
            panel.axvspan(ends[i], ends[i + 1], color="0.93" if i % 2 else "white", zorder=0)
        axes[0].text((ends[i] + ends[i + 1]) / 2, 1.02, name, transform=axes[0].get_xaxis_transform(), ha="center")
    axes[-1].set(xlabel="time [s]", xlim=(0, END), xticks=ends)
    figure.align_ylabels(axes)
    return figure


if __name__ == "__main__":
    done = simulate()
    report(done)
    draw(done).savefig("mujoco_panda.png")
