"""A Panda lifts 3 kg from the floor and carries the load past its base, at the edge of its torques."""

import numpy as np

import fpbm_cpp as fp

ARM = fp.SerialArm.preset("panda").with_payload(3.0, com=(0, 0, 0.15))  # 3 kg, 0.15 m in front of the flange
START = [-0.319, 0.894, -0.141, -1.463, 0.154, 2.345, -0.516]  # [rad], far from the base
PATH = fp.Polyline([[0, 0, 0], [0, 0, 0.3], [0, 0.6, 0.3]], blend=0.1)  # [m]
CASES = {
    "no bounds": [],
    "bounds": [fp.TorqueBounds()],
    "90 % of the bounds": [fp.TorqueBounds(fraction=0.9)],
}


def lift(bounds: list[fp.TorqueBounds]) -> list[fp.Tick]:
    """The ticks of the motion along the path, as fast as the bounds allow."""
    scheme = fp.FPBM(0.6, np.ones(7), k1=40, k2=400, null_damping=10)
    tracker = fp.Tracker(ARM, scheme, START, task="pose", singular_radius=0, bounds=bounds)  # 1 kHz
    follower = tracker.follow(PATH, keep_path=True)
    ticks = []
    while not follower.done:
        ticks.append(tracker.tick(follower))
    return ticks


if __name__ == "__main__":
    for name, bounds in CASES.items():
        ticks = lift(bounds)
        share = np.max(np.abs([tick.torque for tick in ticks]) / ARM.limits.effort)
        error = max(np.linalg.norm(tick.error[:3]) for tick in ticks)
        print(f"{name}: {len(ticks) / 1000:.3f} s, largest torque {share:.3f} of the effort, ", end="")
        print(f"{error:.0e} m from the path")
