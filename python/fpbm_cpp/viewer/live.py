"""Text, numbers and curves of a live arm: its status, and its motion of the last ten seconds relative to its bounds."""

from collections.abc import Iterator

import numpy as np
from viser import GuiApi

from .._core import Status, advice, message
from .._types import Array
from ..skeleton import joint_labels
from ..tasks import FrameTask
from .frames import distances, frame_of
from .loop import SECONDS, ServoLoop
from .readout import BAD, GOOD, LINES, curve, sentence, table

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
        return f"{', '.join(late) or 'a lower level'}: slowed by higher levels and joint limits.", FAIR
    text = f"{message(status)}. {HINTS.get(status, advice(status))}".strip()
    return text, COLOURS.get(status, BAD)


def _rows(loop: ServoLoop) -> Iterator[tuple[str, ...]]:
    _, worst = loop.strip.curves()
    there = worst[:, ~np.isnan(worst[0])]
    now, far = "", ""
    yield "th", "largest fraction of a bound", "now", f"in {SECONDS:g} s"
    names = [f"joint {name}" for name in NAMES]
    for i, (name, bounded) in enumerate(zip([*names, *_scales(loop)], [*loop.strip.bounded, *[True] * len(worst)])):
        if there.size:
            now, far = (f"{100.0 * x:.0f} %" for x in (there[i, -1], there[i].max() if i < 3 else there[i].min()))
        yield "td", name, *((now, far) if bounded else ("no bound", ""))
    limits, q, tick = loop.limits, loop.q, loop.tick
    on_bound = (q < limits.lower + NEAR) | (q > limits.upper - NEAR)
    on_bound = on_bound if tick is None else on_bound | tick.saturated
    joints = [label for label, flag in zip(joint_labels(loop.arm), on_bound) if flag]
    yield "td", "joints on a bound", ", ".join(joints) or "none", ""
    for task in loop.tasks:
        if isinstance(task, FrameTask):
            found = distances(task, frame_of(task, loop.target_of(task.name)), loop.frame(task.name))
            yield "td", f"from {task.name} to handle", ", ".join(f"{x:.3f} {unit}" for unit, x in found.items()), ""
    if tick is not None and tick.nearest is not None:
        yield "td", "nearest shapes", f"{tick.nearest.distance:.3f} m", " and ".join(tick.nearest.pair)


def _scales(loop: ServoLoop) -> list[str]:
    """Name of the scale of each level."""
    if loop.stack is None:
        return ["task scale"]
    return [f"scale of {', '.join(task.name for task in level)}" for level in loop.stack.levels]


class StripChart:
    """The last ten seconds: each quantity of the joint closest to its bound, and the scale of each level [%]."""

    def __init__(self, gui: GuiApi, loop: ServoLoop) -> None:
        known = zip(NAMES, LINES[:1] + LINES[5:6] + LINES[3:4], loop.strip.bounded)
        curves = [curve(name if there else f"{name} (no bound)", colour) for name, colour, there in known]
        scales = zip(_scales(loop), LINES[6:7] + LINES[1:3] + LINES[4:5])
        curves += [curve(name, colour, dash=[6, 3]) for name, colour in scales]
        with gui.add_folder(f"Last {SECONDS:g} s"):
            self._plot = gui.add_uplot(
                self._data(loop),
                ({"label": "t [s]"}, *curves),
                title="largest fraction of a bound [%]",
                scales={"x": {"time": False}, "y": {"range": (0.0, 105.0)}},
                axes=({"size": 36}, {"size": 44}),
                legend={"live": False},
                height=220,
                padding=(8, 16, 0, 0),
            )

    def show(self, loop: ServoLoop) -> None:
        self._plot.data = self._data(loop)

    def _data(self, loop: ServoLoop) -> tuple[Array, ...]:
        t, worst = loop.strip.curves()
        return (t, *(100.0 * worst))
