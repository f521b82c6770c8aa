"""How objects look in a notebook and in a terminal: tables, and short texts of the compiled classes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from html import escape
from typing import Any

import numpy as np

from ._core import PathFollower, TargetFilter, Tick, Tracker


def html_table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in HTML; the first column has names."""
    head = "".join(f"<th>{escape(each)}</th>" for each in headings)
    body = "".join(
        f"<tr><th>{escape(str(first))}</th>{''.join(f'<td>{escape(str(each))}</td>' for each in rest)}</tr>"
        for first, *rest in rows
    )
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def number(value: float) -> str:
    """A number with four significant digits, or two below 1e-3."""
    return f"{value:.1e}" if 0.0 < abs(value) < 1e-3 else f"{value:.4g}"


def short(values: Any, decimals: int = 12) -> str:
    """An array in one line, with three significant digits, these decimals, and at most twelve numbers."""
    numbers = [f"{value:.3g}" for value in np.round(np.ravel(values), decimals) + 0.0]
    numbers = numbers if len(numbers) <= 12 else [*numbers[:12], "..."]
    return f"[{', '.join(numbers)}]"


def _point(pose: Any) -> str:
    """The position of a point or of a pose."""
    pose = np.asarray(pose)
    return short(pose[:3, 3] if pose.shape == (4, 4) else pose, 4)


REPRS: dict[type, Callable[[Any], str]] = {
    Tracker: lambda it: f"<Tracker of {len(it.q)} joints: q = {short(it.q, 4)}, tip at {_point(it.tip)}>",
    Tick: lambda it: (
        f"<Tick: {it.status.name}{'' if it.scale is None else f', scale {it.scale:.3g}'}, q = {short(it.q, 4)}, "
        f"error {short(it.error)}>"
    ),
    TargetFilter: lambda it: f"<TargetFilter: x at {_point(it.x)}, xd = {short(it.xd, 4)}>",
    PathFollower: lambda it: f"<PathFollower: {'done' if it.done else 'on its path'}>",
}
for _kind, _text in REPRS.items():
    _kind.__repr__ = _text  # type: ignore[method-assign, assignment]
