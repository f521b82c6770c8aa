"""Which code sweeps run in: that for the lanes of this processor, or the code for every one."""

from __future__ import annotations

import os
from importlib import import_module

from . import _core

CHOICE = "FPBM_LANES"
KINDS = ("avx512", "avx2")


def choose() -> int:
    """Load the best code that this processor can run, and return how many motions it runs side by side.

    The environment variable FPBM_LANES narrows the choice to one kind, 'avx512' or 'avx2', or to 'none' of them.
    """
    choice = os.environ.get(CHOICE, "")
    if choice not in ("", "none", *KINDS):
        raise ValueError(
            f"{CHOICE} is {choice!r}, but must be one of {', '.join(map(repr, (*KINDS, 'none')))}, or unset"
        )
    for kind in _core.processor_kinds():
        if choice not in ("", kind):
            continue
        try:
            code = import_module(f"{__package__}._lanes_{kind}").code
        except ImportError:  # Left out of this build.
            continue
        return _core.use_lanes(code)
    return _core.use_lanes(None)


LANES = choose()
