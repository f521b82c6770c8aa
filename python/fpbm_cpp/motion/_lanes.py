"""The code of sweeps: for the SIMD lanes of this processor, or for any processor."""

import os
from contextlib import suppress
from importlib import import_module

from .._core import processor_kinds, use_lanes

KINDS = ("avx512", "avx2")


def choose() -> int:
    """Load the best code that this processor can run, and return the number of motions that it runs side by side.

    The environment variable FPBM_LANES restricts the choice to one kind, 'avx512' or 'avx2', or to 'none'.
    """
    choice = os.environ.get("FPBM_LANES", "")
    if choice not in ("", "none", *KINDS):
        words = ", ".join(map(repr, (*KINDS, "none")))
        raise ValueError(f"FPBM_LANES = {choice!r}: must be one of {words}, or unset")
    for kind in processor_kinds():
        if choice in ("", kind):
            with suppress(ImportError):  # Not in this build.
                return use_lanes(import_module(f".._lanes_{kind}", __package__).code)
    return use_lanes(None)


LANES = choose()
