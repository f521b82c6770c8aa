"""What a scheme was made of."""

from __future__ import annotations

from typing import Any

from ._core import Scheme


def arguments(scheme: Scheme) -> dict[str, Any]:
    """All arguments that a scheme was made with, by name."""
    return dict(scheme.__reduce__()[0].keywords)
