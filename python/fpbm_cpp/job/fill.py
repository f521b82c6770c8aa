"""A job's blanks, filled."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arms import Arm, PlanarArm
from ..errors import ParameterError
from ..parameter import REQUIRED
from ..paths import PATH_OPTIONS, PATHS
from ..table import from_table
from .ready import READY, ready
from .sections import FREE, Table, known


def filled(job: Table, arm: Arm | None) -> Table:
    """The job with what it leaves out; what depends on the arm only where there is one. Never refuses anything."""
    path = job.get("path", {"kind": FREE["path"]})
    pieces = [_filled_path(piece, arm) for piece in path] if isinstance(path, list) else _filled_path(path, arm)
    scheme = _filled("scheme", job.get("scheme", {"kind": FREE["scheme"]}))
    if isinstance(scheme, dict) and "weights" in known("scheme", scheme.get("kind")):
        scheme = {"weights": [1.0] * (arm.dof if arm else 1), **scheme}
    run = _filled("run", job.get("run", {}))
    if isinstance(run, dict) and arm is not None and "q0" not in run:
        named = job["arm"].get("name") if job["arm"]["kind"] == "preset" else None
        run = {"q0": READY[named] if named in READY else ready(arm, run["task"]), **run}
    return {**job, "path": pieces, "scheme": scheme, "run": run}


def taken(job: Table, full: Table) -> Iterator[str]:
    """What the full job has and the job did not say, as in 'k1 = 10', but for what is off."""
    for section in ("path", "scheme", "run"):
        said, whole = (each if isinstance(each, list) else [each] for each in (job.get(section, {}), full[section]))
        for before, after in zip(said, whole):
            for key, value in after.items():
                if key not in before and key != "kind" and value:
                    yield f"{key} = {_text(value)}"


def _filled(section: str, said: Any) -> Any:
    """A table with the usual values of its kind, where they are not what the library takes anyway."""
    if not isinstance(said, dict):
        return said
    declared = known(section, said.get("kind")).values()
    usual = {each.name: each.usual for each in declared if each.usual is not each.default or section == "run"}
    return {**{key: value for key, value in usual.items() if value not in (REQUIRED, None)}, **said}


def _filled_path(said: Any, arm: Arm | None) -> Any:
    """A path; a path of the plane is laid before an arm in space."""
    whole = _filled("path", said)
    if not isinstance(whole, dict) or arm is None or isinstance(arm, PlanarArm) or "in_plane" in whole:
        return whole
    problems: list[ParameterError] = []
    shape = from_table({key: whole[key] for key in whole if key not in PATH_OPTIONS}, PATHS, problems=problems)
    return {"in_plane": "yz", **whole} if not problems and np.shape(shape.sample(0.0)[0]) == (2,) else whole


def _text(value: Any) -> str:
    if isinstance(value, list):
        if len(value) > 1 and all(entry == value[0] for entry in value):
            return f"{_text(value[0])} for each"
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)
