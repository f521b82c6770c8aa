"""A sound job's blanks, filled; among them a posture to start from."""

from collections.abc import Iterator
from itertools import islice, product
from typing import Any

import numpy as np

from .._types import Array
from ..arms import Arm, PlanarArm
from ..parameter import REQUIRED
from ..paths import PATH_OPTIONS
from ..table import to_table
from .sections import FREE, Table, known, make

# The hand points down, from the makers' ready postures: Franka's, 30° -90° 60° of the iiwa 14, Kinova's home [rad].
READY = {
    "panda": [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
    "iiwa14": [0.0, 0.5236, 0.0, -1.5708, 0.0, 1.0472, 0.0],
    "gen3": [0.0, 0.2618, 3.1416, -2.2689, 0.0, 0.9599, 1.5708],
}

# How far joints of an unknown arm are bent, one way, the other or not at all [rad]; at most a quarter of their range.
BEND = 1.0
MOST = 3**7  # Postures that are looked at.
GOOD = 0.8  # Of what the best has, as far as singular postures are.


def filled(job: Table, arm: Arm) -> Table:
    """The job with what it leaves out."""
    path = job.get("path", {"kind": FREE["path"]})
    pieces = [_filled_path(piece, arm) for piece in path] if isinstance(path, list) else _filled_path(path, arm)
    scheme = _filled("scheme", job.get("scheme", {"kind": FREE["scheme"]}))
    if "weights" in known("scheme", scheme["kind"]):
        scheme = {"weights": [1.0] * arm.dof, **scheme}
    run = _filled("run", job.get("run", {}))
    if "q0" not in run:
        preset = job["arm"].get("name")
        run["q0"] = READY[preset] if preset in READY else ready(arm, run["task"])
    return {**job, "path": pieces, "scheme": scheme, "run": run}


def taken(job: Table, full: Table) -> Iterator[str]:
    """What the full job has and the job did not say, as in 'k1 = 10', but for what is off."""
    for section in ("path", "scheme", "run"):
        said, whole = (each if isinstance(each, list) else [each] for each in (job.get(section, {}), full[section]))
        for before, after in zip(said, whole):
            for key, value in after.items():
                if key not in before and key != "kind" and value:
                    yield f"{key} = {_text(value)}"


def _filled(section: str, said: Table) -> Table:
    """A table with the usual values of its kind, where they are not what the library takes anyway."""
    declared = known(section, said.get("kind")).items()
    usual = {key: each.usual for key, each in declared if each.usual is not each.default or section == "run"}
    return {**{key: to_table(value) for key, value in usual.items() if value not in (REQUIRED, None)}, **said}


def _filled_path(said: Table, arm: Arm) -> Table:
    """A path; a path of the plane is laid before an arm in space."""
    whole = _filled("path", said)
    if isinstance(arm, PlanarArm) or "in_plane" in whole:
        return whole
    shape = make("path", {key: whole[key] for key in whole if key not in PATH_OPTIONS})
    return {"in_plane": "yz", **whole} if len(shape.sample(0.0)[0]) == 2 else whole


def _text(value: Any) -> str:
    if isinstance(value, list):
        if len(value) > 1 and all(entry == value[0] for entry in value):
            return f"{_text(value[0])} for each"
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def ready(arm: Arm, task: str) -> list[float]:
    """Joint positions that are not singular [rad].

    In the plane, a quarter of a turn from the first link to the last, in even bends; else the middle of the limits, or
    zero where there are none, with as few joints bent as keep it far from singular postures.
    """
    posture = np.full(arm.dof, np.pi / 2 / (arm.dof - 1)) if isinstance(arm, PlanarArm) else _bent(arm, task)
    return [round(float(position), 4) for position in posture]


def _bent(arm: Arm, task: str) -> Array:
    """The posture of fewest bent joints that is about as far from singular ones as any."""
    lower, upper = arm.limits.lower, arm.limits.upper
    bounded = np.isfinite(lower) & np.isfinite(upper)
    middle = np.clip(0.0, lower, upper)
    middle[bounded] = (lower[bounded] + upper[bounded]) / 2
    room = np.minimum(BEND, (upper - lower) / 4)
    # The last joints change fastest: of long arms, those near the base stay as they are.
    bends = np.array(list(islice(product((0.0, 1.0, -1.0), repeat=arm.dof), MOST)))
    bends = bends[np.argsort(np.abs(bends).sum(axis=1), kind="stable")]
    jacobians = np.array([arm.jacobian(middle + bend * room, task=task) for bend in bends])
    sigma = np.linalg.svd(jacobians, compute_uv=False)
    inverse_condition = sigma[:, -1] / np.maximum(sigma[:, 0], np.finfo(float).tiny)
    good = inverse_condition >= GOOD * inverse_condition.max()
    return np.asarray(middle + bends[np.argmax(good)] * room)
