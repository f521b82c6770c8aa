"""Run files: arrays in an .npz file, all other data as JSON in the same file; nothing is pickled."""

import io
import json
import operator
import os
import platform
from collections.abc import Iterable
from datetime import datetime, timezone
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from .._core import Status, __version__, processor_kinds
from ..arms import PlanarArm
from ..errors import not_one_of
from ..files import write_whole
from ..motion.fastest import fastest
from ..motion.run import Run
from ..motion.run_data import ARRAYS, LIMITED, OF_STACKS, RunStatus
from ..motion.simulation import simulate, track
from ..robots import ROBOTS
from ..schemes import SCHEMES
from ..table import EVERY_PATH, Makers, from_table, to_table
from ..tasks import TASKS

FORMAT = "fpbm_cpp run"
KINDS: dict[str, Makers] = {"arm": ROBOTS, "path": EVERY_PATH, "scheme": SCHEMES}
FUNCTIONS = {each.__name__: each for each in (simulate, track, fastest)}  # Functions that make runs, by name.
VERSION = 3  # Version of the format; incremented for each new format.


def save(run: Run, file: str | os.PathLike[str], note: Any, seed: Any) -> None:
    """Write a run to a file, completely or not at all."""
    meta = {
        "format": FORMAT,
        "version": VERSION,
        **{name: to_table(getattr(run, name)) for name in KINDS},
        "task": run.task,
        "function": None if run.function is None else run.function.__name__,
        "options": {name: to_table(value) for name, value in run.options.items()},
        "status": {"code": run.status.code.name, "time": run.status.time, "q": run.status.q.tolist()},
        "provenance": _provenance(run, note, seed),
    }
    buffer = io.BytesIO()
    np.savez_compressed(buffer, meta=np.array(json.dumps(meta, allow_nan=False)), **run.arrays())
    write_whole(FilePath(file), buffer.getvalue())


def load(file: str | os.PathLike[str]) -> Run:
    """Read a run that Run.save wrote: arrays, arm, path, scheme and all other fields, equal to the last bit.

    Nothing in the file is executed: the classes of this package construct arm, path and scheme from numbers. The
    provenance of the run has date, machine and versions, note and seed.

    Raises ValueError if the file is not a run, is damaged, names anything outside this package, or has another format;
    OSError if the file cannot be read.
    """
    content = FilePath(file).read_bytes()
    try:
        meta, arrays = _members(content)
    except Exception as error:  # Readers of damaged files raise exceptions of every kind.
        raise ValueError(f"{file}: must be a complete file from Run.save(): {error}") from error
    if meta["version"] != VERSION:
        remedy = "upgrade fpbm_cpp" if meta["version"] > VERSION else "make the run again"
        demand = f"must be {VERSION}, the format of fpbm_cpp {__version__}: {remedy}"
        raise ValueError(f"{file}: format {meta['version']}: {demand}")
    try:
        return _run(meta, arrays)
    except Exception as error:
        raise ValueError(f"{file}: must be a valid run from Run.save(): {error}") from error


def _provenance(run: Run, note: Any, seed: Any) -> dict[str, Any]:
    """Provenance of a run: from its file, or of this moment on this machine."""
    if note is not None and not isinstance(note, str):
        raise ValueError(f"note = {note!r}: must be text")
    if seed is not None:
        try:
            seed = [operator.index(one) for one in seed] if isinstance(seed, Iterable) else operator.index(seed)
        except TypeError:
            raise ValueError(f"seed = {seed!r}: must be a whole number, or a list of whole numbers") from None
    origin = run.provenance or {
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "fpbm_cpp": __version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "system": platform.system(),
        "processor": [platform.machine(), *processor_kinds()],
    }
    given = {"note": note, "seed": seed}
    return {**origin, **{name: value for name, value in given.items() if value is not None}}


def _refuse_files(table: dict[str, Any]) -> dict[str, Any]:
    """The table; ValueError if the table names another file."""
    if table.get("kind") in ("urdf", "robot"):
        raise ValueError(f"kind = {table['kind']!r}: a run's file must not name another file")
    return table


def _members(content: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    if not content.startswith(b"PK"):
        raise ValueError("is not an .npz file")
    with np.load(io.BytesIO(content), allow_pickle=False) as members:
        if "meta" not in members:
            raise ValueError("has no arm, path and scheme")
        meta = json.loads(str(members["meta"]), object_hook=_refuse_files)
        if meta["format"] != FORMAT or not isinstance(meta["version"], int):
            raise ValueError(f"has the format {meta['format']!r} {meta['version']!r}")
        return meta, {name: members[name] for name in (*ARRAYS, *LIMITED, *OF_STACKS) if name in members}


def _run(meta: dict[str, Any], arrays: dict[str, Any]) -> Run:
    made_of = {name: from_table(meta[name], KINDS[name], name) for name in KINDS}
    options: dict[str, Any] = {name: np.inf if value == "inf" else value for name, value in meta["options"].items()}
    if options.get("limits") is not None:
        options["limits"] = from_table(options["limits"], name="limits")
    if "bounds" in options:
        options["bounds"] = tuple(from_table(each, name="bounds") for each in options["bounds"])
    if options.get("stack") is not None:
        options["stack"] = from_table(options["stack"], TASKS, "stack")
    status = meta["status"]
    ended = RunStatus(Status[status["code"]], status["time"], np.array(status["q"], dtype=float))
    how = {"task": meta["task"], "options": options, "provenance": dict(meta["provenance"])}
    function = None if meta["function"] is None else FUNCTIONS[meta["function"]]
    run = Run(**arrays, **made_of, **how, status=ended, function=function)
    _check_shapes(run)
    return run


def _check_shapes(run: Run) -> None:
    """Raise ValueError unless all arrays of a run have the shapes for its arm and tasks."""
    arm, stack = run.arm, run.stack
    if run.kind not in ("position", "pose"):
        raise not_one_of("task", run.kind, ("position", "pose"))
    rows = (2, 3) if isinstance(arm, PlanarArm) else (3, 6)
    error: tuple[int, ...] = (rows[run.kind == "pose"],)
    point = (4, 4) if error == (6,) else error
    shapes = {"x": point, "x_ref": point, "error": error}
    shapes |= {name: () for name in ("t", "scale", "clearance")}
    if stack is not None:
        shapes |= {"scales": (len(stack.levels),), "task_errors": (sum(stack.error_sizes(arm.dof)),)}
    for name, array in run.arrays().items():
        shape, kind = (len(run.t), *shapes.get(name, (arm.dof,))), "bool" if name == "saturated" else "float64"
        if array.shape != shape or array.dtype != kind:
            raise ValueError(f"{name} has shape {array.shape} and type {array.dtype}: must have {shape} and {kind}")
