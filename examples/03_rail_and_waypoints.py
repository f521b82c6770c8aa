"""An iiwa 14 on a rail moves along a bench beyond its workspace: the weights determine how far the rail moves."""

from math import pi

import numpy as np
from matplotlib.figure import Figure

import fpbm_cpp as fp
from fpbm_cpp.plot import arm_panel

iiwa = fp.SerialArm.preset("iiwa14")
rail = fp.Joint("prismatic", axis=(0, 1, 0), lower=-1.0, upper=1.0, velocity=1.0, name="rail")  # [m], [m/s]
arm = fp.SerialArm([rail, *iiwa.joints], iiwa.tip)

start = np.array([-0.8, -0.3, 0.6, 0, -1.5, 0, pi - 2.1, 0])  # [m], [rad]: the hand points down
first = arm.forward(start)


def hand(x: float, y: float, z: float, angle: float) -> np.ndarray:
    """The first pose, displaced by x, y, z [m] and rotated about the vertical axis by an angle [rad]."""
    pose = first.copy()
    pose[:3, 3] += x, y, z
    pose[:3, :3] = fp.rotation([0, 0, angle]) @ first[:3, :3]
    return pose


stations = [(0, 0, 0, 0), (0.05, 0.45, -0.15, 0.3), (0, 0.9, 0, 0), (0.05, 1.35, -0.15, -0.3), (0, 1.8, 0, 0)]
path = fp.Waypoints([hand(*station) for station in stations], velocity=0.5, acceleration=1.0, angular_velocity=1.0)


def run(weight: float) -> fp.Run:
    """The motion along the whole bench. 1 m/s of the rail costs as much as sqrt(weight) rad/s of a joint."""
    scheme = fp.FPBM(0.6, [weight, 1, 1, 1, 1, 1, 1, 1], k1=20, k2=100, null_damping=2)
    return fp.simulate(arm, path, scheme, start, hold=1.0, task="pose")


# With a small entry in W, the rail follows the hand. With a large entry, the rail moves only as far as the workspace
# requires.
runs = {"light rail, W = diag(0.1, 1, …, 1)": run(0.1), "heavy rail, W = diag(10, 1, …, 1)": run(10)}
for name, done in runs.items():
    print(
        f"{name[:10]}: rail from {done.q[0, 0]:.2f} to {done.q[-1, 0]:.2f} m,"
        f" at most {abs(done.qd[:, 0]).max():.2f} m/s and {abs(done.qd[:, 1:]).max():.2f} rad/s,"
        f" tip errors {done.max_error():.0e} m and {done.max_orientation_error():.0e} rad"
    )

figure = Figure(figsize=(12.8, 8.0), dpi=150, layout="constrained")
cells = figure.add_gridspec(2, 2, height_ratios=[1.7, 1.0])
for column, (name, done) in enumerate(runs.items()):
    above = figure.add_subplot(cells[0, column], projection="3d")
    arm_panel(above, done)
    above.view_init(elev=18, azim=-22)
    above.set_title(name, loc="left")
    below = figure.add_subplot(cells[1, column])
    below.plot(done.t, done.positions[:, 1], "#000000", label="hand, along the bench")
    below.plot(done.t, done.q[:, 0], "#0072B2", label="rail")
    below.plot(done.t, done.positions[:, 1] - done.q[:, 0], "#D55E00", label="hand relative to the rail")
    below.set(xlabel="time [s]", ylabel="y [m]", ylim=(-1.1, 1.3))
    below.grid(color="0.9")
    below.legend(loc="upper left", frameon=False)
figure.savefig("rail_and_waypoints.png")
