"""Files that are written completely or not at all."""

import os
from pathlib import Path


def write_whole(file: Path, content: bytes) -> Path:
    """Write a file completely, or keep the existing file. Raises OSError; returns the file."""
    if file.exists() and not file.is_file():
        file.write_bytes(content)  # A device; a directory raises an error here.
        return file
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
    return file
