"""How objects look in a notebook and in a terminal: tables, and short texts of the compiled classes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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


def _tracker(self: Tracker) -> str:
    return f"<Tracker of {len(self.q)} joints: q = {short(self.q, 4)}, tip at {_point(self.tip)}>"


def _tick(self: Tick) -> str:
    scale = "" if self.scale is None else f", scale {self.scale:.3g}"
    return f"<Tick: {self.status.name}{scale}, q = {short(self.q, 4)}, error {short(self.error)}>"


def _filter(self: TargetFilter) -> str:
    return f"<TargetFilter: x at {_point(self.x)}, xd = {short(self.xd, 4)}>"


def _follower(self: PathFollower) -> str:
    return f"<PathFollower: {'done' if self.done else 'on its path'}>"


for _kind, _text in ((Tracker, _tracker), (Tick, _tick), (TargetFilter, _filter), (PathFollower, _follower)):
    _kind.__repr__ = _text  # type: ignore[method-assign]
