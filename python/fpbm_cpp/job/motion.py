"""Reads a job, adds the defaults, and constructs its arm, path and scheme."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice, product
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError

from .._core import check_sweep
from .._types import Array
from ..arms import Arm, PlanarArm, SerialArm
from ..bounds import Bound
from ..errors import not_one_of, wrong
from ..files import write_whole
from ..joints import JointLimits
from ..motion.fastest import fastest
from ..motion.run import Run
from ..motion.run_data import Paths
from ..motion.simulation import simulate, task_and_paths, track
from ..parameter import REQUIRED
from ..paths import DURATION, PATH_OPTIONS, Circle, Path
from ..robots import Robot
from ..schemes import MVN, Scheme
from ..skeleton import length
from ..table import is_by_task, to_table
from ..tasks import FrameTask, Stack
from .sections import (
    FREE,
    SECTIONS,
    JobError,
    RunOptions,
    Table,
    arm_of,
    in_order,
    job_errors,
    known,
    make,
    require_sound,
    with_kind,
)

# Ready postures with the hand down [rad]: the maker's for Franka; 30° -90° 60° for the iiwa 14; the maker's home for
# Kinova; right angles for UR; -20° 40° 60° for the xArm 7; -20° 40° 70° for the SO-101. The posture of the Z1 is
# "forward" of Unitree's SDK, with the hand to the front.
READY = {
    "panda": [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
    "fr3": [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
    "iiwa14": [0.0, 0.5236, 0.0, -1.5708, 0.0, 1.0472, 0.0],
    "gen3": [0.0, 0.2618, 3.1416, -2.2689, 0.0, 0.9599, 1.5708],
    "ur5e": [0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0],
    "ur10e": [0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0],
    "xarm7": [0.0, -0.3491, 0.0, 0.6981, 0.0, 1.0472, 0.0],
    "so101": [0.0, -0.3491, 0.6981, 1.2217, 0.0],
    "z1": [0.0, 1.5, -1.0, -0.54, 0.0, 0.0],
}
READY["two_pandas"] = 2 * READY["panda"]

# Displacement of the joints of an unknown arm, in either direction or zero [rad]; at most a quarter of their range.
BEND = 1.0
TIP_TASKS = ("position", "pose")
# Tasks of an arm in space that has too few joints for a pose, but more than for a position.
FEW = range(4, 6)
FEW_TASKS = ({"level": 0, "kind": "position"}, {"level": 1, "kind": "axis"})
MOST = 3**7  # Largest number of candidate postures.
GOOD = 0.8  # Accepted inverse condition number, relative to the best.

CIRCLE = 0.08  # Default radius of a circle, in reaches: 0.1 m for the preset arms, whose reach is 1.2 m to 1.7 m.
HALVINGS = 8  # Smaller radii that are tried.
TRIAL_GAIN, TRIAL_STEP, TRIAL_STEPS, TRIAL_ERROR = 10.0, 0.01, 200, 1e-3  # [1/s], [s], at least, [m]

Jacobian = Callable[[Array], Array]


@dataclass(frozen=True)
class Motion:
    """A motion that is ready to run."""

    job: Table  # The job, with all defaults.
    taken: dict[str, list[str]]  # The defaults in use by section, for example 'k1 = 10'.
    arm: Arm | Robot
    path: Paths
    scheme: Scheme
    options: RunOptions
    stack: Stack | None  # None if the tip's task is the only task.
    limits: JointLimits | None  # None if limits are not kept.
    bounds: tuple[Bound, ...]  # Need limits.

    @property
    def q0(self) -> Array:
        """Joint positions at the start [rad]."""
        assert self.options.q0 is not None
        return self.options.q0

    @property
    def label(self) -> str:
        """Name of the arm and the path."""
        paths = self.job["path"]
        each = (" then ".join(piece["kind"] for piece in _pieces(path)) for path in _by_task(paths).values())
        return f"{self.name}, {' and '.join(each)}"

    @property
    def name(self) -> str:
        """Name of the arm."""
        arm = self.job["arm"]
        return str(arm.get("name") or arm.get("file") or f"arm of {self.arm.dof} joints")

    @property
    def keywords(self) -> dict[str, Any]:
        """The keyword arguments of sweep() and tune() for this motion."""
        options = self.options
        keywords = {"dt": options.dt, "hold": options.hold, "task": options.task}
        keywords |= {"stack": self.stack, "limits": self.limits}
        # The scheme of a job has its own damping, which may be 0.
        return keywords if self.limits is None else {**keywords, "null_damping": 0.0}

    def of_one_arm(self) -> tuple[Arm, Path]:
        """Arm and path, for sweep() and tune(). Raises JobError for a robot, for several paths, or for a kept path."""
        if self.options.keep_path:
            raise JobError(wrong("run.keep_path", True, ": must not be given here: use track to keep a path"))
        if isinstance(self.arm, Robot) or isinstance(self.path, Mapping):
            raise JobError(wrong("arm", None, ": must be an arm on one path: use track for a robot or several paths"))
        return self.arm, self.path

    def with_scheme(self, options: Mapping[str, Any]) -> Motion:
        """The motion with other options of its scheme. Raises JobError."""
        scheme = {**self.job["scheme"], **{key: to_table(value) for key, value in options.items()}}
        return replace(self, job={**self.job, "scheme": scheme}, scheme=make("scheme", scheme, self.arm))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the job to a file, completely or not at all. Raises OSError."""
        write_job(self.job, file)

    def run(self) -> Run:
        """Run the motion by simulate(), or by track() if limits are kept; a motion may stop early."""
        keywords = {**self.keywords, "qd0": self.options.qd0}
        with job_errors():
            if self.limits is not None:
                keywords |= {"keep_path": self.options.keep_path, "reserve": self.options.reserve}
                return track(self.arm, self.path, self.scheme, self.q0, bounds=self.bounds, **keywords)
            del keywords["limits"]
            return simulate(self.arm, self.path, self.scheme, self.q0, partial=True, **keywords)

    def fastest(self, **tip: Any) -> Run:
        """Run the motion by fastest(). tip: bounds on the tip, and its speeds at the ends."""
        options = self.options
        with job_errors():
            return fastest(
                self.arm,
                self.path,
                self.scheme,
                self.q0,
                dt=options.dt,
                task=options.task,
                stack=self.stack,
                limits=self.limits,
                bounds=self.bounds,
                **tip,
            )


def prepare(job: Table) -> Motion:
    """Construct the motion of a job. Raises JobError, or OSError if a file that the job names cannot be read."""
    require_sound(job)
    arm = arm_of(job)
    full = filled(job, arm)
    full = {section: in_order(section, full[section]) for section in SECTIONS if section in full}
    path, scheme, options = (make(section, full[section], arm) for section in ("path", "scheme", "run"))
    stack = make("task", full["task"], arm) if "task" in full else None
    limits = make("limits", full["limits"], arm) if "limits" in full else None
    if limits is not None and "acceleration" not in full["limits"]:
        bounded = np.isfinite([limits.lower, limits.upper, limits.velocity]).any(axis=0)
        if np.any(bounded & np.isinf(limits.acceleration)):
            missing = ": is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual, for example "
            missing += "--limit-acceleration 10, or acceleration = 10 under [limits] in a job"
            raise JobError(wrong("limits.acceleration", None, missing))
    bounds = make("bounds", full.get("bounds", []), arm)
    if "clearance" in full:
        bounds = (make("clearance", full["clearance"], arm), *bounds)
    motion = Motion(full, taken(job, full), arm, path, scheme, options, stack, limits, bounds)
    if options.keep_path:  # The motion has its own duration, and its checks need the joint path.
        return motion
    with job_errors():
        try:
            _, kind, followed, tasks = task_and_paths(path, options.task, stack)
            check_sweep(arm, followed, [scheme], options.q0, options.dt, options.hold, kind, None, tasks)
        except ValueError:
            motion.run()  # Raises the error of check_sweep(), with the names in the job.
            raise
    return motion


def filled(job: Table, arm: Arm | Robot) -> Table:
    """The job with the defaults for missing keys."""
    job = with_tasks(job, arm)
    said = job.get("run", {})
    run = _filled("run", said)
    keep_path = run.get("keep_path", False)
    if "reserve" in said and "keep_path" not in said:
        raise JobError(wrong("run.reserve", said["reserve"], ": has no effect without keep_path: give keep_path"))
    if not keep_path:
        del run["reserve"]
    path = job.get("path", {"kind": FREE["path"]})
    timed = not keep_path or any("duration" in piece for each in _by_task(path).values() for piece in _pieces(each))
    fill = partial(_filled_paths, path, arm, timed=timed)
    pieces = fill()
    gains = {"k1": 0.0, "k2": 0.0} if "task" in job else {}  # Each task has its own gains.
    scheme = dict(job.get("scheme", {"kind": FREE["scheme"]}))
    gains = {key: gain for key, gain in gains.items() if key in known("scheme", scheme.get("kind"))}
    scheme = _filled("scheme", {**gains, **scheme})
    if "weights" in known("scheme", scheme["kind"]):
        scheme = {"weights": [1.0] * arm.dof, **scheme}
    stack = make("task", job["task"]) if "task" in job else None
    if stack is None and isinstance(arm, Robot):
        missing = ": is missing: a robot needs [[task]] tables, or --task FRAME on the command line"
        raise JobError(wrong("task", None, missing))
    if stack is None and run["task"] not in TIP_TASKS:
        raise JobError(not_one_of("run.task", run["task"], TIP_TASKS))
    with job_errors():
        run["task"], kind, *_ = task_and_paths(make("path", pieces, arm), said.get("task"), stack)
        if "q0" not in run:
            preset = job["arm"].get("name")
            run["q0"] = list(READY.get(preset) or ready(arm, kind, stack))
    limits = make("limits", job.get("limits", {}), arm)
    pieces = _scaled(fill, pieces, arm, limits, run if stack is None else None)
    full = {**job, "path": pieces, "scheme": scheme, "run": run}
    if keep_path or "bounds" in job or "clearance" in job:
        full["limits"] = job.get("limits", {})  # Without limits, no arm can stop in time.
    if "clearance" in job:
        full["clearance"] = with_kind(job["clearance"])
        if full["clearance"]["kind"] == "urdf":
            keys = {"urdf": ("tip", "base"), "robot": ("base", "locked", "tips")}.get(job["arm"]["kind"], ())
            parts = {key: job["arm"][key] for key in keys if key in job["arm"]}
            if not isinstance(arm, Robot):
                parts = {"tip": "", **parts}  # Without a tip, the error message lists the links.
            full["clearance"] = {**parts, **full["clearance"]}
    return full


def with_tasks(job: Table, arm: Arm | Robot) -> Table:
    """The job; for an arm with few joints and without a task, tasks for the tip's position and the direction of its z
    axis, with the gains of the scheme.
    """
    if "task" in job or "task" in job.get("run", {}) or not isinstance(arm, SerialArm) or arm.dof not in FEW:
        return job
    scheme = dict(job.get("scheme", {"kind": FREE["scheme"]}))
    gains = {key: scheme.pop(key) for key in ("k1", "k2", "k") if key in scheme}
    return {**job, "scheme": scheme, "task": [{**each, **gains} for each in FEW_TASKS]}


def taken(job: Table, full: Table) -> dict[str, list[str]]:
    """Defaults in the full job by section, for example 'k1 = 10', without options that are off."""
    texts = {
        section: [*dict.fromkeys(_taken(job.get(section, {}), full[section]))] for section in ("path", "scheme", "run")
    }
    if "task" in full and "task" not in job:
        texts["run"].insert(0, "tasks " + " and ".join(each["kind"] for each in full["task"]))
    return {section: each for section, each in texts.items() if each}


def _taken(said: Any, full: Any) -> Iterator[str]:
    """Defaults in a full section."""
    if is_by_task(full):
        for task in full:
            yield from _taken(said.get(task, {}), full[task])
        return
    for before, after in zip(_pieces(said), _pieces(full)):
        for key, value in after.items():
            if key not in before and key != "kind" and value:
                yield f"{key} = {_text(value)}"


def _filled(section: str, said: Table) -> Table:
    """A table with the usual values of its kind, where they differ from the defaults of the library."""
    declared = known(section, said.get("kind")).items()
    written = ("k1", "k2") if section == "scheme" else ()  # A full job states the gains of the scheme.
    usual = {
        key: each.usual
        for key, each in declared
        if each.usual is not each.default or section == "run" or key in written
    }
    return {**{key: to_table(value) for key, value in usual.items() if value not in (REQUIRED, None)}, **said}


def _pieces(path: Any) -> list[Table]:
    """The tables of a path."""
    return path if isinstance(path, list) else [path]


def _by_task(path: Any) -> dict[str, Any]:
    """Paths by task name; the name of a single path is ''."""
    return path if is_by_task(path) else {"": path}


def _filled_paths(said: Any, arm: Arm | Robot, radius: float | None = None, *, timed: bool = True) -> Any:
    """The paths with their defaults, and this radius for each circle of which the job does not say the radius.

    For an arm in space, a planar path is placed in the yz plane. timed: whether the defaults include a duration.
    """
    if isinstance(said, list):
        return [_filled_paths(piece, arm, radius, timed=timed) for piece in said]
    if is_by_task(said):
        return {task: _filled_paths(each, arm, radius, timed=timed) for task, each in said.items()}
    given = {"radius": radius, **said} if radius is not None and said["kind"] == Circle.kind else said
    whole = _filled("path", given)
    if "duration" not in said and (not timed or "at_speed" in said):
        whole.pop("duration", None)
    if "path" in whole:
        whole["path"] = _filled_paths(whole["path"], arm, radius, timed=timed)
    if isinstance(arm, PlanarArm) or "in_plane" in whole:
        return whole
    shape = make("path", {key: whole[key] for key in whole if key not in PATH_OPTIONS})
    return {"in_plane": "yz", **whole} if len(shape._lasting(1.0).sample(0.0)[0]) == 2 else whole


def _scaled(fill: Callable[..., Any], full: Any, arm: Arm | Robot, limits: JointLimits, run: Table | None) -> Any:
    """The paths with the default radius of circles: CIRCLE times the arm's length. fill(radius): the paths.

    The radius is halved until the tip can follow the path, unless HALVINGS do not suffice. run: the options of the run;
    None for a stack, whose paths are not tried.
    """
    radius = float(f"{CIRCLE * length(arm, np.zeros(arm.dof)):.1g}")
    if radius == 0.0 or fill(radius) == fill(2 * radius):
        return full
    if run is not None:
        for halvings in range(HALVINGS + 1):
            paths = fill(radius / 2**halvings)
            if _can_follow(arm, make("path", paths, arm), limits, run):
                return paths
    return fill(radius)


def _can_follow(arm: Arm | Robot, path: Path, limits: JointLimits, run: Table) -> bool:
    """Whether MVN follows the path within bounds on position, velocity and acceleration. If the job is wrong: true."""
    try:
        path = path if path._is_timed() else path._lasting(DURATION.usual)
        dt = min(TRIAL_STEP, (path._duration() or 0.0) / TRIAL_STEPS)
        found = simulate(arm, path, MVN(k=TRIAL_GAIN), run["q0"], dt=dt, task=run["task"], partial=True)
    except ValueError:
        return True  # prepare() reports the error.
    inside = (found.q >= limits.lower) & (found.q <= limits.upper) & (np.abs(found.qd) <= limits.velocity)
    inside &= np.abs(found.qdd) <= limits.acceleration
    return bool(found.status) and found.max_error() < TRIAL_ERROR and bool(np.all(inside))


def _text(value: Any) -> str:
    if isinstance(value, list):
        if len(value) > 1 and all(entry == value[0] for entry in value):
            return f"{_text(value[0])} for each"
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def ready(arm: Arm | Robot, task: str, stack: Stack | None = None) -> list[float]:
    """Joint positions that are not singular [rad]; for a planar arm, equal bends that add up to a quarter turn."""
    if isinstance(arm, PlanarArm):
        posture = np.full(arm.dof, np.pi / 2 / (arm.dof - 1))
    else:
        lower, upper = arm.limits.lower, arm.limits.upper
        bounded = np.isfinite(lower) & np.isfinite(upper)
        posture = np.clip(0.0, lower, upper)
        posture[bounded] = (lower[bounded] + upper[bounded]) / 2
        for jacobian, columns in _jacobians(arm, posture, task, stack):
            posture = _bent(arm.limits, posture, jacobian, columns)
    return [round(float(position), 4) for position in posture]


def _jacobians(arm: Arm | Robot, q: Array, task: str, stack: Stack | None) -> Iterator[tuple[Jacobian, Any]]:
    """Jacobians that must not be singular, of the tip or of each frame of a robot's tasks, and their joints.

    The joints of a frame are the joints that move only this frame or, if these joints are fewer than six, all joints
    that move the frame.
    """
    if not isinstance(arm, Robot):
        yield lambda q: arm.jacobian(q, task=task), np.arange(arm.dof)
    elif stack is not None:
        frames = dict.fromkeys(each.frame for each in stack.tasks if isinstance(each, FrameTask))
        moving = {frame: arm.jacobian(q, frame).any(axis=0) for frame in frames}
        shared = sum(moving.values()) > 1
        for frame, joints in moving.items():
            own = joints & ~shared
            yield partial(arm.jacobian, frame=frame), np.flatnonzero(own if own.sum() >= 6 else joints)


def _bent(limits: JointLimits, middle: Array, jacobian: Jacobian, columns: Any) -> Array:
    """The middle of the limits, with the fewest displaced joints for a GOOD inverse condition number."""
    room = np.minimum(BEND, (limits.upper - limits.lower) / 4)[columns]
    # The last joints vary first: on a long arm, the joints near the base stay in the middle.
    bends = np.array(list(islice(product((0.0, 1.0, -1.0), repeat=len(columns)), MOST)))
    bends = bends[np.argsort(np.abs(bends).sum(axis=1), kind="stable")]
    postures = np.tile(middle, (len(bends), 1))
    postures[:, columns] += bends * room
    sigma = np.linalg.svd(np.array([jacobian(q)[:, columns] for q in postures]), compute_uv=False)
    inverse_condition = sigma[:, -1] / np.maximum(sigma[:, 0], np.finfo(float).tiny)
    good = inverse_condition >= GOOD * inverse_condition.max()
    return np.asarray(postures[np.argmax(good)])


def read_job(file: str | os.PathLike[str]) -> Table:
    """Content of a TOML file, unchecked. File names are relative to the file's folder. Raises JobError or OSError."""
    try:
        table: Table = tomlkit.parse(FilePath(file).read_bytes()).unwrap()
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise JobError(wrong("", None, f"must be valid TOML: {error}")) from None
    for each, key in _files(table):
        each[key] = os.path.normpath(FilePath(file).parent / each[key])
    return table


def write_job(job: Table, file: str | os.PathLike[str]) -> None:
    """Write a valid job to a file, completely or not at all; read_job() reads it. Raises OSError."""
    place = FilePath(file).resolve()
    table = {section: in_order(section, job[section]) for section in SECTIONS if section in job}
    for each, key in _files(table):
        try:
            each[key] = FilePath(os.path.relpath(each[key], place.parent)).as_posix()
        except ValueError:  # The two files are on different drives.
            each[key] = str(FilePath(each[key]).resolve())
    write_whole(place, f"# fpbm-cpp track --job {place.name}\n\n{tomlkit.dumps(table)}".encode())


def _files(table: Table) -> Iterator[tuple[Table, str]]:
    """The sections that name a file, and their keys."""
    for section in ("arm", "clearance"):
        for key in ("file", "srdf"):
            said = table.get(section)
            if isinstance(said, dict) and isinstance(said.get(key), str):
                yield said, key
