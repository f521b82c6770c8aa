"""Runs from files."""

from __future__ import annotations

import os

from .run import Run


def load(file: str | os.PathLike[str]) -> Run:
    """Read a run that Run.save wrote: arrays, arm, path, scheme and all, equal to the last bit.

    Nothing in a file is executed: arm, path and scheme are made from numbers by this package's own classes.

    Parameters
    ----------
    file : path
        The file.

    Returns
    -------
    Run
        The run; its provenance says when, where and by which versions it was made, with its note and seed.

    Raises
    ------
    ValueError
        Where the file is no run, is damaged, names what is not this package's, or has a newer format.
    OSError
        Where it cannot be read.
    """
    from . import file as run_file

    return run_file.load(file)
