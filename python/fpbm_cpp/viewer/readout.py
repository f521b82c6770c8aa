"""Text, numbers and curves: status and figures of a run or of a live arm, one quantity over time, the last seconds."""

import html
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from viser import GuiApi

from .._core import Status, advice, message
from .._types import Array
from ..skeleton import joint_labels, joint_units
from ..tasks import FrameTask
from .frames import distances, frame_of
from .loop import SECONDS, ServoLoop
from .playback import Playback

GOOD, BAD = "#009E73", "#D55E00"
CELL = "padding:0.15em 0.6em 0.15em 0"
TABLE = "font-size:0.8em;margin:0.3em 0.9em;text-align:left;font-variant-numeric:tabular-nums"
# Okabe and Ito's colours, as in the figures.
LINES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
NOW = "#888888"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
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
NAMES = ("speed", "acceleration", "jerk", "torque")


class Readout:
    """Status of the run in a line, and a table of figures: at a sample, and the worst of the whole motion."""

    def __init__(self, gui: GuiApi) -> None:
        self._status = gui.add_html("")
        self._table = gui.add_html("")

    def show(self, playback: Playback) -> None:
        self._playback, status = playback, playback.run.status
        stopped = f"stopped after t = {status.time:g} s: {message(status.code)}. {status.advice}"
        self._status.content = sentence(*((str(status), GOOD) if status else (stopped, BAD)))

    def refuse(self, reason: str) -> None:
        """Show why the requested motion cannot run."""
        self._status.content = sentence(f"not run: {reason}", BAD)

    def at(self, sample: int) -> None:
        playback, run = self._playback, self._playback.run
        w, errors = playback.manipulability, playback.errors
        names, units = joint_labels(run.arm), joint_units(run.arm)

        def fastest(qd: Array) -> str:
            joint = np.unravel_index(np.abs(qd).argmax(), qd.shape)[1]
            return f"{np.abs(qd).max():.3g} {units[joint]}/s ({names[joint]})"

        rows = [
            ("th", "", "now", "at worst"),
            *(("td", name, f"{e[sample]:.3g} {unit}", f"{e.max():.3g} {unit}") for name, (e, unit) in errors.items()),
            ("td", "fastest joint", fastest(run.qd[sample : sample + 1]), fastest(run.qd)),
            ("td", "manipulability", f"{w[playback.frame(sample)]:.3g}", f"{w.min():.3g}"),
        ]
        nearest = playback.nearest(sample)
        if nearest is not None:
            now, worst = f"{nearest.distance:.3f} m ({' and '.join(nearest.pair)})", f"{playback.distances.min():.3f} m"
            rows.append(("td", "nearest shapes", now, worst))
        self._table.content = table(rows)


def sentence(text: str, colour: str) -> str:
    """A sentence as HTML."""
    style = f"padding:0.4em 0.9em 0;font-size:0.85em;font-weight:600;color:{colour}"
    return f'<div style="{style}">{html.escape(text)}</div>'


def table(rows: Iterable[Sequence[str]]) -> str:
    """A table as HTML, from rows of a tag, th or td, and cells."""
    lines = ("".join(f'<{tag} style="{CELL}">{html.escape(cell)}</{tag}>' for cell in row) for tag, *row in rows)
    return f'<table style="{TABLE}">{"".join(f"<tr>{line}</tr>" for line in lines)}</table>'


def quantities(playback: Playback) -> dict[str, tuple[Array, str]]:
    """Values at the frames, and their unit; for a column per joint, the suffix of the joint position's unit."""
    run, at = playback.run, playback.frames
    found = {"joint velocities": (run.qd[at], "/s"), "joint accelerations": (run.qdd[at], "/s²")}
    found["joint positions"] = run.q[at], ""
    found |= {name: (values[at], unit) for name, (values, unit) in playback.errors.items()}
    found["manipulability"] = playback.manipulability, ""
    if playback.distances.size:
        found["distance of the nearest shapes"] = playback.distances, "m"
    return found


def curve(label: str, colour: str, dash: Sequence[int] = ()) -> dict[str, Any]:
    """The style of a curve of a chart."""
    return {"label": label, "stroke": colour, "width": 1.6, "dash": list(dash), "points": {"show": False}}


class Chart:
    """A chart of the selected quantity over the planned duration, with a line at the shown time."""

    def __init__(self, gui: GuiApi, playback: Playback, duration: float) -> None:
        self._playback, self._duration, self._sample = playback, duration, 0
        with gui.add_folder("Over time"):
            self._quantity = gui.add_dropdown("quantity", tuple(quantities(playback)))
            nothing = (np.zeros(1), np.zeros(1)), ({"label": ""}, {"label": ""})
            axes = ({"size": 32}, {"size": 44})
            self._plot = gui.add_uplot(*nothing, axes=axes, height=220, padding=(8, 16, 0, 0))
        self._quantity.on_update(lambda _: self.show(self._playback))

    def show(self, playback: Playback) -> None:
        self._playback = playback
        labels, values, self._plot.title = self._curves()
        low, high = float(values.min()), float(values.max())
        low, high = (0.0, high) if 0.0 <= low < high / 2 else (low, high)
        room = 0.05 * (high - low) or 1.0
        self._range = low - room, high + room
        lines = [
            curve(label, LINES[i % len(LINES)], dash=[] if i < len(LINES) else [6, 3]) for i, label in enumerate(labels)
        ]
        self._plot.series = ({"label": "t [s]"}, *lines, curve("now", NOW))
        self._plot.scales = {"x": {"time": False, "range": (0.0, self._duration)}, "y": {"range": self._range}}
        self._plot.data = (playback.run.t[playback.frames], *values.T, self._now())

    def at(self, sample: int) -> None:
        self._sample = sample
        self._plot.data = (*self._plot.data[:-1], self._now())

    def _curves(self) -> tuple[list[str], Array, str]:
        """Labels, a column for each, and a title with unit and power of ten."""
        name, arm = self._quantity.value, self._playback.run.arm
        values, unit = quantities(self._playback)[name]
        if values.ndim == 2:
            units = sorted({own + unit for own in joint_units(arm)}, reverse=True)
            return joint_labels(arm), values, f"{name} [{', '.join(units)}]"
        largest = float(values.max())
        exponent = int(np.floor(np.log10(largest))) if 0.0 < largest < 0.01 else 0
        power = f"10{str(exponent).translate(SUPERSCRIPTS)} " if exponent else ""
        unit = f"{power}{unit}".strip()
        return [name], values[:, None] / 10.0**exponent, f"{name} [{unit}]" if unit else name

    def _now(self) -> Array:
        """A vertical line between two neighbouring frames."""
        line = np.full(len(self._playback.frames), np.nan)
        first = min(self._playback.frame(self._sample), max(len(line) - 2, 0))
        line[first : first + 2] = self._range[: len(line)]
        return line


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
    limited = loop.strip.bounded
    names = [f"joint {name}" for name in NAMES[: len(limited)]]
    for i, (name, bounded) in enumerate(zip([*names, *_scales(loop)], [*limited, *[True] * len(worst)])):
        if there.size:
            worst_of = np.max if i < len(limited) else np.min
            now, far = (f"{100.0 * x:.0f} %" for x in (there[i, -1], worst_of(there[i])))
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
        known = zip(NAMES, LINES[:1] + LINES[5:6] + LINES[3:4] + LINES[2:3], loop.strip.bounded)
        curves = [curve(name if there else f"{name} (no bound)", colour) for name, colour, there in known]
        scales = zip(_scales(loop), LINES[6:7] + LINES[1:2] + LINES[4:5] + LINES[7:])
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
