"""Custom kinematics in a control loop: Pinocchio computes tip, J and Jd, and FPBM the joint accelerations."""

import numpy as np

import fpbm_cpp as fp

try:
    import pinocchio as pin
except ModuleNotFoundError:
    print("this example needs Pinocchio: pip install pin")
    raise SystemExit(0) from None

model = pin.buildSampleModelManipulator()  # six joints
data = model.createData()
tip = model.getFrameId("effector_body")


def kinematics(q: np.ndarray, qd: np.ndarray) -> fp.Kinematics:
    """Tip, J and Jd of a position task. A pose task needs oMf[tip].homogeneous and all six rows."""
    pin.computeJointJacobiansTimeVariation(model, data, q, qd)
    pin.updateFramePlacements(model, data)
    J = pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
    Jd = pin.getFrameJacobianTimeVariation(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
    return fp.Kinematics(data.oMf[tip].translation, J[:3], Jd[:3])


scheme = fp.FPBM(0.6, np.ones(6), k1=40, k2=400, null_damping=4)
path = fp.Line([0.1, 0.1, -0.1], 1.0, time_law="quintic")  # displacement [m], duration [s]
h = 1e-3  # [s]
q, qd = np.array([0.3, 0.5, 0.2, 1.0, 0.1, 0.4]), np.zeros(6)  # [rad], [rad/s]
start = kinematics(q, qd).tip

errors = []
for step in range(1001):
    here = kinematics(q, qd)
    x, xd, xdd = path.sample(step * h)
    errors.append(np.linalg.norm(start + x - here.tip))
    qdd = scheme.resolve(here, q, qd, start + x, xd, xdd)
    q, qd = q + h * qd + h * h / 2 * qdd, qd + h * qdd  # motion of the drives until the next tick

print(f"tip error [m]: {max(errors):.1e} at most, {errors[-1]:.1e} at the end")
