"""What is varied in a sweep: alpha=0,0.6,1, or alpha=0:1:11."""

from __future__ import annotations

from typing import Any, NamedTuple

import click
import numpy as np


class Variation(NamedTuple):
    """An option of a scheme, and the values that it takes."""

    key: str
    values: tuple[float, ...]


class _Vary(click.ParamType):  # type: ignore[type-arg]
    name = "variation"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Variation:
        key, equals, text = value.partition("=")
        try:
            if not (key and equals):
                raise ValueError
            return Variation(key.strip().replace("-", "_"), _values(text))
        except ValueError:
            raise click.ClickException(f"--vary {value}: must be as alpha=0,0.6,1 or alpha=0:1:11") from None


def _values(text: str) -> tuple[float, ...]:
    if ":" in text:
        first, last, count = text.split(":")
        return tuple(np.linspace(float(first), float(last), int(count)).tolist())
    return tuple(map(float, text.split(",")))


VARY = _Vary()
