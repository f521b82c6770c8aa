"""Text, numbers and curves of a live arm: its status, and its motion of the last ten seconds relative to its bounds."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from viser import GuiApi

from .._core import Status, advice, message
from .._types import Array
from ..skeleton import joint_labels
from ..tasks import FrameTask
from .frames import distances, frame_of
from .loop import SECONDS, ServoLoop, Strip
from .readout import BAD, GOOD, LINES, sentence, table

FAIR = "#8A6100"
WHOLE = 0.999  # Scale of a level that is not slowed, up to round-off.
NEAR = 0.01  # Distance of a joint to an end of its range [rad].
COLOURS = {Status.OK: GOOD, Status.DAMPED: FAIR, Status.SLOWED: FAIR, Status.BLOCKED: FAIR}
# The actions of the user on the page.
HINTS = {
    Status.DAMPED: "The tip follows in all other directions.",
    Status.SLOWED: "The tip follows as fast as the joint limits admit.",
    Status.BLOCKED: "Drag the handle around the nearest shape.",
    Status.RECOVERING: "Wait until the arm is in that posture.",
    Status.STALLED: "Drag the handle into the workspace, or around a limit or a shape that blocks the arm.",
}
NAMES = ("speed", "acceleration", "jerk")


class LiveReadout:
    """Status of the arm in a sentence, and a table of the quantities that are closest to their bounds."""

    def __init__(self, gui: GuiApi) -> None:
        self._status = gui.add_html("")
        self._table = gui.add_html("")
        self._rejected = ""

    def refuse(self, reason: str) -> None:
        """Show why the requested scheme is rejected, until another scheme is accepted."""
        self._rejected = f"rejected: {reason}" if reason else ""

    def show(self, loop: ServoLoop) -> None:
        self._status.content = sentence(*((self._rejected, BAD) if self._rejected else _words(loop)))
        self._table.content = table(_rows(loop))


def _words(loop: ServoLoop) -> tuple[str, str]:
    """Status of the arm, and a colour."""
    if loop.stopped:
        moves = loop.tick is not None and loop.tick.qd.any()
        return ("stopping: every joint brakes" if moves else "stopped: the arm is at rest"), FAIR
    status, scales = loop.status, None if loop.tick is None else loop.tick.scales
    if status is Status.SLOWED and loop.stack is not None and scales is not None and scales[0] > WHOLE:
        late = [task.name for level, scale in zip(loop.stack.levels, scales) if scale < WHOLE for task in level]
        return (
            f"{', '.join(late) or 'a lower level'}: slowed by higher levels and joint limits.",
            FAIR,
        )
    text = f"{message(status)}. {HINTS.get(status, advice(status))}".strip()
    return text, COLOURS.get(status, BAD)


def _rows(loop: ServoLoop) -> list[tuple[str, ...]]:
    _, worst = loop.strip.curves()
    nothing = np.full(len(worst), np.nan)
    there = worst[:, ~np.isnan(worst[0])]
    now = there[:, -1] if there.size else nothing
    far = np.append(there[:3].max(axis=1), there[3:].min(axis=1)) if there.size else nothing
    names = [*(f"joint {name}" for name in NAMES), *_scales(loop)]
    known = [*loop.strip.bounded, *(True for _ in _scales(loop))]
    cells = [(_percent(a), _percent(b)) if there else ("no bound", "") for a, b, there in zip(now, far, known)]
    joints = [label for label, flag in zip(joint_labels(loop.arm), _on_bounds(loop)) if flag]
    return [
        ("th", "largest fraction of a bound", "now", f"in {SECONDS:g} s"),
        *(("td", name, *cell) for name, cell in zip(names, cells)),
        ("td", "joints on a bound", ", ".join(joints) or "none", ""),
        *_distances(loop),
        *_nearest(loop),
    ]


def _scales(loop: ServoLoop) -> list[str]:
    """Name of the scale of each level."""
    if loop.stack is None:
        return ["task scale"]
    return [f"scale of {', '.join(task.name for task in level)}" for level in loop.stack.levels]


def _distances(loop: ServoLoop) -> Iterator[tuple[str, ...]]:
    """Distance of each frame from its handle."""
    for task in loop.tasks:
        if isinstance(task, FrameTask):
            found = distances(task, frame_of(task, loop.target_of(task.name)), loop.frame(task.name))
            yield "td", f"from {task.name} to handle", ", ".join(f"{x:.3f} {unit}" for unit, x in found.items()), ""


def _nearest(loop: ServoLoop) -> Iterator[tuple[str, ...]]:
    """The nearest pair of shapes, if any pair is checked."""
    if loop.tick is not None and loop.tick.nearest is not None:
        yield "td", "nearest shapes", f"{loop.tick.nearest.distance:.3f} m", " and ".join(loop.tick.nearest.pair)


def _on_bounds(loop: ServoLoop) -> list[bool]:
    """Joints that were on a bound in the last tick, or are at an end of their range."""
    limits, q = loop.limits, loop.q
    ends = (q < limits.lower + NEAR) | (q > limits.upper - NEAR)
    return list(ends if loop.tick is None else ends | loop.tick.saturated)


def _percent(share: float) -> str:
    return "" if np.isnan(share) else f"{100.0 * share:.0f} %"


class StripChart:
    """The last ten seconds: each quantity of the joint closest to its bound, and the scale of each level [%]."""

    def __init__(self, gui: GuiApi, loop: ServoLoop) -> None:
        known = zip(NAMES, LINES[:1] + LINES[5:6] + LINES[3:4], loop.strip.bounded)
        curves: list[dict[str, Any]] = [
            {"label": name if there else f"{name} (no bound)", "stroke": colour, "width": 1.6}
            for name, colour, there in known
        ]
        scales = [
            {"label": name, "stroke": colour, "width": 1.6, "dash": [6, 3]}
            for name, colour in zip(_scales(loop), LINES[6:7] + LINES[1:3] + LINES[4:5])
        ]
        with gui.add_folder(f"Last {SECONDS:g} s"):
            self._plot = gui.add_uplot(
                self._data(loop.strip),
                ({"label": "t [s]"}, *({**curve, "points": {"show": False}} for curve in (*curves, *scales))),
                title="largest fraction of a bound [%]",
                scales={"x": {"time": False}, "y": {"range": (0.0, 105.0)}},
                axes=({"size": 36}, {"size": 44}),
                legend={"live": False},
                height=220,
                padding=(8, 16, 0, 0),
            )

    def show(self, loop: ServoLoop) -> None:
        self._plot.data = self._data(loop.strip)

    def _data(self, strip: Strip) -> tuple[Array, ...]:
        t, worst = strip.curves()
        return (t, *(100.0 * worst))
