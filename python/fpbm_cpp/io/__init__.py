"""Motions and arms in files: runs and back, tables, datasets, ROS bags, URDF, C++ headers."""

import os
from pathlib import Path


def write_whole(file: Path, content: bytes) -> Path:
    """Write a file, or leave what is there as it was. Raises OSError; returns the file."""
    if file.exists() and not file.is_file():
        file.write_bytes(content)  # A device; a directory says that it is one.
        return file
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
    return file
