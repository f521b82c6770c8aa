"""A sound job's blanks, filled."""

from collections.abc import Iterator
from typing import Any

from ..arms import Arm, PlanarArm
from ..parameter import REQUIRED
from ..paths import PATH_OPTIONS
from ..table import to_table
from .make import make
from .ready import READY, ready
from .sections import FREE, Table, known


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
