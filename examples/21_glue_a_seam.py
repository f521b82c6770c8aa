"""A Panda glues along the rim of a cover, at a constant speed where the joints allow it, and slower in corners."""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("panda")
q0 = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]  # [rad], the tool points down
corners = 0.01 * np.array([[0, 0], [0, 8], [12, 8], [12, 2], [8, 0], [12, -2], [12, -8], [0, -8], [0, 0]])  # [m]
seam = fp.Polyline(corners, blend=0.005).in_plane("xy")
speed = 0.15  # [m/s]


def report(name: str, run: fp.Run) -> None:
    reached = np.linalg.norm(np.diff(run.positions, axis=0), axis=1) / run.options["dt"]
    steady = np.mean(np.abs(reached / speed - 1) < 0.01)
    ratio = max(each.max() for each in run.bound_ratios().values())
    print(f"{name}: {run.t[-1]:.2f} s, {steady:.0%} of the time within 1 % of the speed, ", end="")
    print(f"at most {run.max_error():.0e} m from the seam, largest ratio to a bound {ratio:.4f}")


at_speed = seam.at_speed(speed, acceleration=2)
report("fastest", fp.fastest(arm, seam, fp.MVN(), q0, task="pose", tip_speed=speed))
report("track", fp.track(arm, at_speed, fp.MVN(k=5), q0, task="pose"))
report("track, path kept", fp.track(arm, at_speed, fp.MVN(k=5), q0, task="pose", keep_path=True))
