"""A Panda whose handle was dragged, also to unreachable targets: draws servo.png in a headless browser.

    python docs/figures/servo.py [where to write the picture]

Needs the dependency groups 'browser' and 'peers' (for the Panda's meshes), and chromium. Without a graphics processor
this script takes a minute.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from viewer import panda_file, photograph

import fpbm_cpp as fp
from fpbm_cpp.viewer import Servo

READY = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]


def drag(servo: Servo, displacement: list[float], seconds: float) -> None:
    """Moves the handle by a displacement [m] at constant speed, with 20 updates per second."""
    start = servo.target
    for share in np.linspace(0.0, 1.0, round(20 * seconds) + 1)[1:]:
        x = start.copy()
        x[:3, 3] += share * np.array(displacement)
        servo.target = x
        time.sleep(0.05)


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "servo.png"
    urdf = panda_file()
    limits = fp.SerialArm.preset("panda").limits
    arm = fp.SerialArm.from_urdf(urdf, tip="panda_link8")
    scheme = fp.FPBM(0.6, weights=np.ones(7), k1=10.0, k2=25.0, null_damping=2.0, joint_centring=1.0)
    with Servo(arm, scheme, READY, task="pose", limits=limits, urdf=urdf, port=0) as servo:

        def drags() -> None:
            drag(servo, [0.0, 0.3, 0.1], 1.5)
            drag(servo, [0.1, -0.6, 0.0], 1.5)
            drag(servo, [0.3, 0.2, 0.0], 1.0)
            time.sleep(4.0)

        photograph(servo, target, "from tip to handle", drags)


if __name__ == "__main__":
    main()
