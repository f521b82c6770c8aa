"""Jobs as TOML files."""

import os
from pathlib import Path

import tomlkit
from tomlkit.exceptions import TOMLKitError

from ..errors import ParameterError
from ..io.write_whole import write_whole
from .make import JobError
from .sections import SECTIONS, Table, in_order


def read_job(file: str | os.PathLike[str]) -> Table:
    """What a file says, as yet unchecked. Raises JobError where it is no TOML, or OSError where it cannot be read.

    Files that it names are seen from its folder.
    """
    try:
        table: Table = tomlkit.parse(Path(file).read_bytes()).unwrap()
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise JobError(ParameterError("", None, None, f"no TOML: {error}")) from None
    arm = table.get("arm")
    if isinstance(arm, dict) and isinstance(arm.get("file"), str):
        arm["file"] = os.path.normpath(Path(file).parent / arm["file"])
    return table


def write_job(job: Table, file: str | os.PathLike[str]) -> None:
    """Write a job that is sound to a file, whole or not at all; read_job reads it back. Raises OSError."""
    place = Path(file).resolve()
    table = {section: in_order(section, job[section]) for section in SECTIONS if section in job}
    if "file" in table["arm"]:
        table["arm"]["file"] = _seen_from(place.parent, table["arm"]["file"])
    write_whole(place, f"# fpbm-cpp track --job {place.name}\n\n{tomlkit.dumps(table)}".encode())


def _seen_from(folder: Path, file: str) -> str:
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # On another drive.
        return str(Path(file).resolve())
