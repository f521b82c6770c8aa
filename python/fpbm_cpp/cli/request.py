"""Jobs from the command line: a job file, and an option that overrides each of its keys."""

import functools
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from .._core import PRESETS, ROBOT_PRESETS
from ..errors import not_one_of
from ..job import JobError, Motion, prepare, read_job
from ..job.sections import FREE, SECTIONS, Table, known
from ..parameter import REQUIRED, Parameter
from ..table import is_by_task
from ..torque_bounds import TorqueBounds
from .plain import PLACE, WIDTH, Plain, file_errors

HEADING = {
    "arm": "Arm and start",
    "run": "Arm and start",
    "path": "Path",
    "scheme": "Scheme",
    "limits": "Joint limits",
    "bounds": "Joint limits",
    "clearance": "Clearance",
}
SAVED = "Write the job, including all defaults, to a TOML file."
METAVARS = {"tip": "LINK", "base": "LINK", "in_plane": "AXES", "file": "FILE", "srdf": "FILE"}
WORDS = {"task": ("position", "pose")}  # Words that shells complete; a job with tasks has further names.
# Defaults that depend on the arm.
TAKEN = {
    "base": "the root",
    "q0": "a ready posture",
    "qd0": "at rest",
    "duration": "10, but none for a kept path",
    "in_plane": "yz in space",
    "weights": "ones",
}


def _value(text: str) -> Any:
    """A number or several: '1,2; 3,4' has two rows. Other text stays text, which the job rejects."""
    try:
        rows = [_row(row) for row in text.split(";")]
    except ValueError:
        return text
    return rows if len(rows) > 1 else rows[0]


def _row(text: str) -> Any:
    if "," not in text:
        return float(text)
    return [float(part) for part in text.split(",") if part.strip()]


class Word(click.Choice):  # type: ignore[type-arg]
    """One of a few words, which shells complete. The job reports the error of any other word."""

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        return value


class JobOption(click.Option):
    """An option for a key of a job, listed under its topic."""

    def __init__(self, section: str, key: str, flag: str, **attributes: Any) -> None:
        super().__init__([flag, f"{section}__{key}"], default=None, **attributes)
        self.section, self.key, self.heading = section, key, HEADING[section]


BASE = "Base link of a URDF file. For a robot: fixed, or planar, which moves along x and y and rotates about z."
PAYLOAD = (
    "Mass of a payload at the tip, and centre of mass in the frame of the tip. For a robot, a job has payload.frame.  "
    "[kg, m; default: at the tip]"
)
TORQUES = (
    "Bound the torques to this fraction of the arm's efforts, for schemes at acceleration level; keeps joint limits. "
    "Accelerations are lower than their bounds where the torques need it."
)
LOCKED = "Fix a joint of the robot in a URDF file at a position; can be repeated.  [rad, m]"
TASK = (
    "Task of the tip: position or pose. For a job with tasks: name of the task that follows the path. For a robot: a "
    "frame that moves; can be repeated.  [default: position; with 4 or 5 joints in space, position and then axis]"
)
CLEAR = (
    "Avoid self-collision, with the collision geometry of this URDF file, and the job's obstacles; keeps joint limits."
)
SRDF = "SRDF file of MoveIt, whose disabled pairs are not checked."
MARGIN = "Least distance between two shapes."
PER_LINK = "Largest number of capsules per link."

LIVE = {"q0"}  # Keys of a run that apply without a path.
KEPT = {"keep_path", "reserve"}  # Keys of a run that keeps its path.


def _job_options(kind: bool, path: bool, clear: bool, keep: bool) -> Iterator[JobOption]:
    """Options of a job, with or without the kind of the scheme, the path, the clearance, and keeping the path. Without
    a path, the limits are always kept.
    """
    urdf = known("arm", "urdf")
    yield _option("arm", "tip", replace(urdf["tip"], help="Tip link of a URDF file."))
    yield _option("arm", "base", replace(urdf["base"], help=BASE))
    yield JobOption("arm", "locked", "--locked", multiple=True, metavar="JOINT=NUMBER", help=LOCKED)
    yield JobOption("arm", "payload", "--payload", type=_value, metavar="MASS[,X,Y,Z]", help=PAYLOAD)
    for key, declared in known("run").items():
        if key == "task":
            words = Word(WORDS["task"])
            yield JobOption("run", key, "--task", multiple=True, type=words, metavar="TASK", help=TASK)
        elif keep if key in KEPT else path or key in LIVE:
            yield _option("run", key, declared)
    for section, usual in FREE.items():
        if section == "path" and not path:
            continue
        keys = {each: known(section, each) for each in (usual, *SECTIONS[section])}
        if kind or section != "scheme":
            words = Word(list(SECTIONS[section]))
            yield JobOption(section, "kind", f"--{section}", type=words, help=f"Kind; default: {usual}.")
        for key in dict.fromkeys(key for each in keys for key in keys[each] if key != section):
            having = [each for each in keys if key in keys[each]]
            yield _option(section, key, keys[having[0]][key], of=having if len(having) < 3 else [])
    text = (
        "Keep the arm's limits, with the changes below; track does so by default. Arms without acceleration bounds "
        "need --limit-acceleration: e.g. 10 rad/s^2."
    )
    if path:
        yield JobOption("limits", "keep", "--limits/--no-limits", help=text)
    yield from limit_options()
    if clear:
        yield JobOption("bounds", "fraction", "--torque-bounds", type=_value, metavar="FRACTION", help=TORQUES)
        shapes = known("clearance", "urdf")
        yield JobOption("clearance", "file", "--clearance", metavar="FILE", help=CLEAR)
        for key, text in (("srdf", SRDF), ("margin", MARGIN), ("per_link", PER_LINK)):
            yield _option("clearance", key, replace(shapes[key], help=text))


def limit_options() -> Iterator[JobOption]:
    """Options that change the limits of an arm."""
    for key, declared in known("limits").items():
        yield _option("limits", key, declared, prefix="limit-")


def _option(section: str, key: str, declared: Parameter, prefix: str = "", of: Sequence[str] = ()) -> JobOption:
    """The option for a key. of: the kinds that have the key, if only a few have it."""
    flag = f"--{prefix}{key.replace('_', '-')}"
    if declared.type is bool:
        return JobOption(section, key, f"{flag}/--no-{flag[2:]}", help=declared.help)
    several = bool(declared.shape)
    kind: Any = _value if several or declared.type in (float, int) else str
    words = WORDS.get(key, declared.choices)
    kind = Word(words) if words and not several else kind
    metavar = None if isinstance(kind, Word) else METAVARS.get(key, "NUMBERS" if several else "NUMBER")
    usual = [] if declared.usual in (REQUIRED, None) else np.ravel(declared.usual).tolist()
    taken = TAKEN.get(key) or ",".join(f"{x:g}" if isinstance(x, float) else str(x) for x in usual)
    extra = "; ".join(filter(None, [declared.unit, f"default: {taken}" if taken else ""]))
    text = f"{', '.join(of)}: {declared.help}" if of else declared.help
    return JobOption(section, key, flag, type=kind, metavar=metavar, help=f"{text}  [{extra}]" if extra else text)


def motion_command(
    short_help: str, examples: str, *, kind: bool = True, path: bool = True, clear: bool = False, keep: bool = False
) -> Callable[[Callable[..., None]], Plain]:
    """Decorator for a command that calls its function with a Request from ARM, --job, --save-job and the options."""

    def make(function: Callable[..., None]) -> Plain:
        ours = list(_job_options(kind, path, clear, keep))

        @click.argument("arm", required=False, metavar="ARM")
        @click.option("--job", type=PLACE, metavar="FILE", help="TOML file of a job, which the options override.")
        @click.option("--save-job", type=PLACE, metavar="FILE", help=SAVED)
        @functools.wraps(function)
        def call(arm: str | None, job: Path | None, save_job: Path | None, **options: Any) -> None:
            values = {option: options.pop(str(option.name)) for option in ours}
            function(Request(arm, job, save_job, values), **options)

        epilog = "\b\nExamples:" + examples.replace("\n    ", "\n  ")
        command = click.command(function.__name__, short_help=short_help, cls=Plain, epilog=epilog)(call)
        command.params += ours
        return command

    return make


class Request:
    """A job's table from the file and from the options, which override the file; and the options of its keys."""

    def __init__(self, arm: str | None, file: Path | None, copy: Path | None, values: dict[JobOption, Any]) -> None:
        if arm is None and file is None:
            every = ", ".join((*PRESETS, *ROBOT_PRESETS))
            raise click.UsageError(f"Missing argument 'ARM': {every}, planar:1,1,1,1 or a URDF file.")
        self.file, self.copy = file, copy
        self.free = any(option.key == "keep" and value is False for option, value in values.items())
        self.sections = {option.section for option in values}
        self.table: Table = {}
        self.flags: dict[str, str] = {}
        if file is not None:
            with self.plain(), file_errors("read", file):
                self.table = read_job(file)
        said = {f"{section}.{key}" for section, keys in self.table.items() if isinstance(keys, dict) for key in keys}
        if arm is not None:
            self.table["arm"] = _arm(arm)
        given = {option: value for option, value in values.items() if value not in (None, ())}
        # Kinds before their keys; tasks last, because they depend on the arm.
        for option in sorted(given, key=lambda each: (each.key != "kind", each.key == "task")):
            self._put(option, given[option])
        names = {f"{option.section}.{option.key}": option for option in values}
        self.chosen = "scheme.kind" in said or names.get("scheme.kind") in given  # Whether the scheme is not a default.
        self.flags |= {key: each.opts[0] for key, each in names.items() if each in given or key not in said}
        if isinstance(self.table.get("task"), list) and names["run.task"] in given:
            self.flags["run.frame"] = "--task"  # The option --task constructs the tasks.

    @property
    def scheme(self) -> str:
        """The requested kind of scheme."""
        given = self.table.get("scheme")
        return str(given.get("kind")) if isinstance(given, dict) else FREE["scheme"]

    @property
    def scheme_of_velocity(self) -> str | None:
        """The scheme for a command that needs a scheme at velocity level; None if the job or the options have one."""
        return None if self.chosen else "wmvn" if "weights" in self.table.get("scheme", {}) else "mvn"

    def motion(
        self, kind: str | None = None, *, at_rest: bool = False, limited: bool = False, keep_path: bool = False
    ) -> Motion:
        """The motion, with this kind of scheme if given.

        at_rest: whether the motion must start at rest. limited: whether limits are kept without a request, unless the
        option --no-limits is given. keep_path: whether the path is kept without a request.
        """
        table = {"limits": {}, **self.table} if limited and not self.free else self.table
        run = table.get("run", {})
        if keep_path and isinstance(run, dict):
            run = {"reserve": known("run")["reserve"].usual, **run, "keep_path": True}
            table = {**table, "run": run}
        for section in ("clearance", "bounds"):
            if section in table and "clearance" not in self.sections:
                command = click.get_current_context().info_name
                raise click.ClickException(f"{command} does not accept {section}: remove {section}, or use track")
        if kind is not None:
            table = {**table, "scheme": _of_kind("scheme", table.get("scheme"), kind)}
        with self.plain(), file_errors("read"):
            motion = prepare(table)
        if at_rest and motion.options.qd0 is not None:
            command = click.get_current_context().info_name
            raise click.ClickException(f"{command} starts at rest: remove qd0, or use track")
        return motion

    def say(self, motion: Motion, *, scheme: bool = True, path: bool = True) -> None:
        """Write the job if requested; print the motion and the defaults in use."""
        if self.copy is not None:
            with file_errors("write to", self.copy):
                motion.save(self.copy)
        name = motion.label if path else motion.name
        click.echo(f"{name}, {motion.scheme.kind}" if scheme else name)
        taken = [text for section, texts in motion.taken.items() if path or section != "path" for text in texts]
        if taken:
            click.echo(click.wrap_text(f"by default: {', '.join(taken)}", WIDTH, subsequent_indent="  "))
        click.echo()

    @contextmanager
    def plain(self) -> Iterator[None]:
        """Report each error of the job in one line, with the name on the command line."""
        try:
            yield
        except JobError as error:
            where = f"{self.file}: " if self.file else ""
            lines = [self.flags.get(each.name, where + each.name) + each.problem for each in error.errors]
            raise click.ClickException("\nError: ".join(lines)) from None

    def _put(self, option: JobOption, value: Any) -> None:
        section, key = option.section, option.key
        if key == "keep":
            if value:
                self.table.setdefault("limits", {})
            else:
                self.table.pop("limits", None)
            return
        if key == "task":
            return self._put_tasks(value)
        if section == "bounds":
            return self._put_torque_bounds(value)
        if key == "locked":
            value = dict(map(_locked, value))
        there = self.table.get(section)
        if there is not None and (isinstance(there, list) or is_by_task(there)) and key != "kind":
            many = f"the file has {len(there)} {section}s: change them in the file, or give --{section}"
            raise click.ClickException(f"{option.opts[0]}: {many}")
        if not isinstance(there, dict):
            there = {"kind": FREE[section]} if section in FREE else {}
        if key == "kind" and value in SECTIONS[section]:
            there = _of_kind(section, there, value)
        if key == "payload":
            mass, *com = value if isinstance(value, list) else [value]
            before = there.get(key)
            value = {**(before if isinstance(before, dict) else {}), "mass": mass, **({"com": com} if com else {})}
            self.flags |= {f"arm.payload.{part}": f"--payload: {part}" for part in ("mass", "com", "frame")}
        self.table[section] = {**there, key: value}

    def _put_torque_bounds(self, fraction: Any) -> None:
        """Set the fraction of the bounds on torques, or add these bounds."""
        given = self.table.get("bounds", [])
        tables = list(given) if isinstance(given, list) else [given]
        kinds = [each.get("kind") if isinstance(each, dict) else None for each in tables]
        at = kinds.index(TorqueBounds.kind) if TorqueBounds.kind in kinds else len(tables)
        before = tables[at] if at < len(tables) else {"kind": TorqueBounds.kind}
        tables[at : at + 1] = [{**before, "fraction": fraction}]
        self.table["bounds"] = tables
        self.flags[f"bounds[{at}].fraction"] = "--torque-bounds"

    def _put_tasks(self, tasks: Sequence[str]) -> None:
        """Set the task of the tip, or of the path; for a robot without tasks, add a pose task for each frame."""
        arm = self.table.get("arm", {})
        is_robot = arm.get("kind") == "robot" or arm.get("name") in ROBOT_PRESETS
        is_robot |= arm.get("kind") == "urdf" and "tip" not in arm and not set(tasks) & set(WORDS["task"])
        if not is_robot or "task" in self.table:
            if len(tasks) > 1:
                raise click.ClickException("--task: must be given once, unless ARM is a robot and the job has no tasks")
            self.table["run"] = {**self.table.get("run", {}), "task": tasks[0]}
            return
        if arm["kind"] == "urdf":
            arm["kind"] = "robot"
        poses = [{"level": i // 2, "kind": "pose", "frame": each, "name": each} for i, each in enumerate(tasks)]
        self.table["task"] = [*poses, {"level": (len(tasks) + 1) // 2, "kind": "posture", "k1": 4.0, "k2": 4.0}]
        path = self.table.get("path", {"kind": FREE["path"]})
        if len(tasks) > 1 and not is_by_task(path):
            self.table["path"] = {each: path for each in tasks}


def _locked(text: str) -> tuple[str, float]:
    name, _, position = text.partition("=")
    try:
        return name, float(position)
    except ValueError:
        raise click.ClickException(f"--locked = {text!r}: must be JOINT=NUMBER") from None


def _arm(text: str) -> Table:
    if text in (*PRESETS, *ROBOT_PRESETS):
        return {"kind": "preset", "name": text}
    if text.startswith("planar:"):
        try:
            lengths = [float(length) for length in text[len("planar:") :].rstrip(",").split(",")]
        except ValueError:
            must = "must be planar: and the link lengths, as in planar:1,1,1,1"
            raise click.ClickException(f"ARM = {text}: {must}") from None
        return {"kind": "planar", "lengths": lengths}
    if Path(text).suffix or Path(text).exists():
        return {"kind": "urdf", "file": text}
    raise click.ClickException(
        str(not_one_of("ARM", text, [*PRESETS, *ROBOT_PRESETS, "planar:1,1,1,1", "a URDF file"]))
    )


def _of_kind(section: str, table: Any, kind: str) -> Table:
    """A table of this kind, without the keys of other kinds."""
    foreign = {key for each in SECTIONS[section] for key in known(section, each)} - set(known(section, kind))
    kept = {key: value for key, value in table.items() if key not in foreign} if isinstance(table, dict) else {}
    return {**kept, "kind": kind}
