"""Runs in files, and back as they were: arrays in an .npz file, all else in it as JSON; nothing is pickled."""

from __future__ import annotations

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

from .. import _core
from .._core import Status, __version__
from .._files import write_whole
from .recipe import from_data, to_data
from .run import Run
from .status import RunStatus

FORMAT = "fpbm_cpp run"
VERSION = 1  # Of the format: one more for each that older packages cannot read.
ARRAYS = ("t", "q", "qd", "qdd", "x", "x_ref", "error")
LIMITED = ("scale", "saturated")  # Of runs that kept the joints' limits.


def save(run: Run, file: str | os.PathLike[str], note: Any, seed: Any) -> None:
    """Write a run to a file, whole or not at all."""
    provenance = _provenance(run, note, seed)
    meta = {"format": FORMAT, "version": VERSION, **_description(run), "provenance": provenance}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, meta=np.array(json.dumps(meta, allow_nan=False)), **_arrays(run))
    write_whole(FilePath(file), buffer.getvalue())


def load(file: str | os.PathLike[str]) -> Run:
    """Read a run that save() wrote. Raises ValueError where the file holds none, OSError where it cannot be read."""
    content = FilePath(file).read_bytes()
    # Whatever can be wrong with a file, what reads it has no list of.
    try:
        meta, arrays = _members(content)
    except Exception as error:
        raise ValueError(f"{file}: must be a whole file that a run was saved to: {error}") from error
    if meta["version"] > VERSION:
        raise ValueError(
            f"{file}: its format {meta['version']} is newer than {VERSION}, the newest that fpbm_cpp {__version__} "
            "reads: upgrade fpbm_cpp"
        )
    try:
        return _run(meta, arrays)
    except Exception as error:
        raise ValueError(f"{file}: holds no run: {error}") from error


def same(one: Run, other: Run) -> bool:
    """Whether two runs are of the same things and equal to the last bit, wherever and whenever they were made."""
    return _bits(one) == _bits(other) and _description(one) == _description(other)


def _arrays(run: Run) -> dict[str, Any]:
    arrays = {name: getattr(run, name) for name in (*ARRAYS, *LIMITED)}
    return {name: np.asarray(array) for name, array in arrays.items() if array is not None}


def _bits(run: Run) -> dict[str, Any]:
    return {name: (array.shape, array.dtype, array.tobytes()) for name, array in _arrays(run).items()}


def _description(run: Run) -> dict[str, Any]:
    """All but the arrays, as JSON holds it."""
    status = {"code": run.status.code.name, "time": run.status.time, "q": run.status.q}
    return {
        "arm": to_data(run.arm),
        "path": to_data(run.path),
        "scheme": to_data(run.scheme),
        "task": run.task,
        "options": {name: to_data(value) for name, value in run.options.items()},
        "status": {name: to_data(value) for name, value in status.items()},
    }


def _provenance(run: Run, note: Any, seed: Any) -> dict[str, Any]:
    """Where a run comes from: as its file says, or from here and now."""
    if note is not None and not isinstance(note, str):
        raise ValueError(f"note = {note!r}: must be text")
    origin = run.provenance or {
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "fpbm_cpp": __version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "system": platform.system(),
        "processor": [platform.machine(), *_core.processor_kinds()],
    }
    given = {"note": note, "seed": None if seed is None else _whole_numbers(seed)}
    return {**origin, **{name: value for name, value in given.items() if value is not None}}


def _whole_numbers(seed: Any) -> int | list[int]:
    try:
        return [operator.index(one) for one in seed] if isinstance(seed, Iterable) else operator.index(seed)
    except TypeError:
        raise ValueError(f"seed = {seed!r}: must be a whole number, or several") from None


def _members(content: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    if not content.startswith(b"PK"):
        raise ValueError("it is no .npz file")
    with np.load(io.BytesIO(content), allow_pickle=False) as members:
        if "meta" not in members:
            raise ValueError("it says nothing of arm, path and scheme")
        meta = json.loads(str(members["meta"]))
        if meta["format"] != FORMAT or not isinstance(meta["version"], int):
            raise ValueError(f"its format is {meta['format']!r} {meta['version']!r}")
        return meta, {name: members[name] for name in (*ARRAYS, *LIMITED) if name in members}


def _run(meta: dict[str, Any], arrays: dict[str, Any]) -> Run:
    arm, path, scheme, task = (from_data(meta[name]) for name in ("arm", "path", "scheme", "task"))
    known = arm.kinematics(np.zeros(arm.dof), np.zeros(arm.dof), task=task)
    rows, n, m, tip = len(arrays["t"]), arm.dof, len(known.J), known.tip.shape
    shapes = {"t": (), "error": (m,), "x": tip, "x_ref": tip, "scale": ()}
    for name, array in arrays.items():
        shape, kind = (rows, *shapes.get(name, (n,))), "bool" if name == "saturated" else "float64"
        if array.shape != shape or array.dtype != kind:
            raise ValueError(f"{name} has shape {array.shape} and type {array.dtype}: must have {shape} and {kind}")
    status = {name: from_data(value) for name, value in meta["status"].items()}
    return Run(
        **arrays,
        status=RunStatus(Status[status["code"]], status["time"], status["q"]),
        arm=arm,
        path=path,
        scheme=scheme,
        task=task,
        options={name: from_data(value) for name, value in meta["options"].items()},
        provenance=dict(meta["provenance"]),
    )
