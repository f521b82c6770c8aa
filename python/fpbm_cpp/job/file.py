"""Jobs as TOML files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from .._files import write_whole
from .complaint import Complaint, JobError
from .model import Job
from .section import Section


def read_table(file: str | os.PathLike[str]) -> dict[str, Any]:
    """What a file says, before anyone asks whether it is a job. Raises JobError, or OSError where it cannot be read.

    Files that it names are seen from its folder.
    """
    try:
        table: dict[str, Any] = tomlkit.parse(Path(file).read_bytes()).unwrap()
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise JobError(Complaint("", f"no TOML: {error}")) from None
    arm = table.get("arm")
    if isinstance(arm, dict) and isinstance(arm.get("file"), str):
        arm["file"] = os.path.normpath(Path(file).parent / arm["file"])
    return table


def read_job(file: str | os.PathLike[str]) -> Job:
    """A job from its file. Raises JobError, or OSError where it cannot be read."""
    return Job.of(read_table(file))


def write_job(job: Job, file: str | os.PathLike[str]) -> None:
    """Write a job to a file, whole or not at all; read_job reads it back. Raises OSError."""
    folder = Path(file).resolve().parent
    table: dict[str, Any] = {}
    for name, value in job:
        if isinstance(value, list):
            pieces = [_table(piece) for piece in value]
            table[name] = pieces[0] if len(pieces) == 1 else pieces
        elif value is not None:
            table[name] = _table(value)
    if "file" in table["arm"]:
        table["arm"]["file"] = _seen_from(folder, table["arm"]["file"])
    write_whole(Path(file).resolve(), f"# fpbm-cpp track --job {Path(file).name}\n\n{tomlkit.dumps(table)}".encode())


def _table(section: Section) -> dict[str, Any]:
    """What a section says, as a file has it."""
    values = section.model_dump(exclude_none=True)
    return {key: values[key] for key in section.key_order() if key in values}


def _seen_from(folder: Path, file: str) -> str:
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # On another drive.
        return str(Path(file).resolve())
