"""The code that sweeps run in: for the lanes of this processor, or for any processor."""

import os
from importlib import import_module

from .._core import processor_kinds, use_lanes

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
    for kind in processor_kinds():
        if choice not in ("", kind):
            continue
        try:
            code = import_module(f".._lanes_{kind}", __package__).code
        except ImportError:  # Left out of this build.
            continue
        return use_lanes(code)
    return use_lanes(None)


LANES = choose()
