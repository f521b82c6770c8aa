"""The panels of a motion, each a function of axes and run, and all panels by name."""

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator, MultipleLocator

from .._types import Array
from ..arms import Arm
from ..bounds import clearance_among, torque_bounds_among
from ..motion.run import Run
from ..motion.run_data import ON_BOUND
from ..motion.task_errors import error_parts, tracks
from ..robots import Robot
from ..skeleton import joint_labels, joint_points, joint_units, task_frames, torque_units
from .lines import draw_lines, envelope, from_zero, head_legend, in_decades, over_time, side_legend, top_legend
from .theme import LIGHT, LINE, TEXT, Theme, dress

__all__ = ["OVERVIEW", "PANELS", "arm_panel", "min_singular_values", "null_space_velocities"]
__all__ += [
    "acceleration_panel",
    "clearance_panel",
    "position_panel",
    "saturation_panel",
    "scale_panel",
    "task_error_panel",
    "torque_panel",
    "velocity_panel",
]
__all__ += ["error_panel", "manipulability_panel", "null_space_panel", "orientation_error_panel", "tip_error_panel"]

NEAR = 0.1  # Distance from which a bound is drawn, relative to the distance between both bounds.
SNAPSHOTS = 11
ROUND = {"solid_capstyle": "round"}
LINK = {"lw": 1.8, "marker": "o", "ms": 3.8, "mew": 0.5, **ROUND}


def arm_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Postures at equal intervals of time, the tip's path and its target, and the tip's axes at the end.

    For a Robot, the panel has path, target and axes of each task that follows a path. An arm in space needs axes with
    projection='3d', a planar arm axes without a projection.
    """
    t, q = (run.t, run.q) if len(run.t) else (np.zeros(1), run.status.q[None])
    time = Normalize(0.0, float(t[-1]) or 1.0)
    shown = np.unique(np.linspace(0, len(t) - 1, SNAPSHOTS).round().astype(int))
    for i, points in zip(shown, joint_points(run.arm, q[shown])):
        axes.plot(*points.T, color=theme.fade(time(t[i])), mec=theme.paper, **LINK)
    draw_base(axes, run.arm, q[-1], theme)
    tip = [line for each, _ in tracks(run) for line in axes.plot(*each.T, color=theme.tip, lw=2.4, label="tip")]
    target = draw_target(axes, run, theme)
    length, dimensions = 0.12 * _extent(run.arm, q[-1]), run.positions.shape[1]
    for frame in (task_frames(run.arm, q[-1], each) for each in run.tips):
        p = frame[:dimensions, 3]
        for axis, colour in zip(frame[:dimensions, :dimensions].T, theme.axes):
            axes.plot(*np.stack([p, p + length * axis]).T, color=colour, lw=1.6, zorder=3, **ROUND)
    frame_arm(axes, theme)
    pad = 0.13 if axes.name == "3d" else 0.02
    times = ScalarMappable(time, theme.fade)
    bar = axes.figure.colorbar(times, ax=axes, location="bottom", aspect=45, fraction=0.06, pad=pad)
    bar.set_label("time of the posture [s]", size=TEXT, color=theme.ink, labelpad=2.0)
    bar.ax.tick_params(labelsize=TEXT, colors=theme.ink, length=2.5, pad=2.5)
    bar.outline.set(edgecolor=theme.ink, linewidth=0.7)
    head_legend(axes, theme, [tip[0], target[0]])


def _extent(arm: Arm | Robot, q: Array) -> float:
    """Largest side of the bounding box of the joints in a posture [m]."""
    points = joint_points(arm, q)
    return float((np.nanmax(points, axis=0) - np.nanmin(points, axis=0)).max())


def draw_base(axes: Any, arm: Arm | Robot, q: Array, theme: Theme) -> None:
    """Draw the arm's base: a square in the plane, a circle in space."""
    if axes.name != "3d":
        axes.plot(0.0, 0.0, "s", color=theme.soft, ms=8, zorder=4)
        axes.plot(0.0, 0.0, "o", color=theme.paper, ms=3, zorder=4)
        return
    radius = 0.06 * _extent(arm, q)
    angle = np.linspace(0.0, 2 * np.pi, 33)
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle, color=theme.soft, lw=1.6)


def draw_target(axes: Any, run: Run, theme: Theme) -> list[Any]:
    style = {"color": theme.ink, "lw": 0.9, "ls": (0, (2, 2)), "label": "target"}
    return [line for _, target in tracks(run) for line in axes.plot(*target.T, **style)]


def frame_arm(axes: Any, theme: Theme) -> None:
    """Give all axes one scale and one distance between ticks; call this last."""
    space = axes.name == "3d"
    ends = np.array([axes.get_xlim(), axes.get_ylim(), *([axes.get_zlim()] if space else [])])
    reach = np.ptp(ends, axis=1)
    step = MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(0.0, reach.max())[1]
    every = [axes.xaxis, axes.yaxis, *([axes.zaxis] if space else [])]
    for name, axis in zip("xyz", every):
        axis.set_major_locator(MultipleLocator(step))
        axis.set_label_text(f"{name} [m]", size=TEXT, color=theme.ink)
    if not space:
        axes.set_aspect("equal", adjustable="datalim")
        return
    reach = np.maximum(reach, reach.max() / 2)
    lower, upper = ends.mean(axis=1) + np.multiply.outer([-0.5, 0.5], reach)
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), zlim=(lower[2], upper[2]))
    axes.set_box_aspect(tuple(reach), zoom=1.2)
    axes.set_anchor("W")
    axes.view_init(elev=20, azim=-55)
    axes.tick_params(pad=-3.0)
    for axis, least, most in zip(every, lower + 0.08 * reach, upper - 0.08 * reach):
        axis.set_ticks(step * np.arange(np.ceil(least / step), np.floor(most / step) + 1))  # No tick in a corner.
        axis.set_pane_color(theme.pane)
        axis.line.set_color(theme.ink)
        axis._axinfo["grid"].update(color=theme.grid, linewidth=0.6)  # 3D axes have no public interface for this.
        axis.labelpad = -5.0


def tip_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Norm of the position error and, if the task is a pose, of the orientation error, on a logarithmic axis."""
    pose = run.kind == "pose"
    names = ("[m]", "[rad]") if pose else ("[m]",)
    for name, norms, (colour, dash) in zip(names, run.error_norms(), theme.styles()):
        axes.plot(*envelope(run.t, norms), color=colour, ls=dash, lw=LINE, label=name)
    over_time(axes, r"$\|e\|$" if pose else r"$\|e\|$ [m]")
    in_decades(axes)
    if pose:
        head_legend(axes, theme)


def error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Position error along each axis, in units of a power of ten."""
    _components(axes, run, theme, run.position_error, ["x", "y", "z"], "m")


def orientation_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Orientation error about each axis, in units of a power of ten."""
    error = run.orientation_error
    _components(axes, run, theme, error, ["angle"] if error.shape[1] == 1 else ["about x", "y", "z"], "rad")


def _components(axes: Any, run: Run, theme: Theme, error: Array, names: Sequence[str], unit: str) -> None:
    largest = float(np.abs(error).max(initial=0.0))
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    scale = f"[$10^{{{exponent}}}$ {unit}]" if exponent else f"[{unit}]"
    draw_lines(axes, theme, run.t, error / 10.0**exponent, names, f"error {scale}")
    head_legend(axes, theme)


def position_panel(axes: Any, run: Run, theme: Theme = LIGHT, bounds: bool = False) -> None:
    """Joint positions, and bounds that are close to a joint, or all finite bounds."""
    _joints(axes, run, theme, run.q, rf"$q$ [{unit_of([run], '')}]", run.limits.lower, run.limits.upper, bounds)


def velocity_panel(axes: Any, run: Run, theme: Theme = LIGHT, bounds: bool = False) -> None:
    """Joint velocities, and bounds that are close to a joint, or all finite bounds."""
    most = run.limits.velocity
    _joints(axes, run, theme, run.qd, rf"$\dot q$ [{unit_of([run], '/s')}]", -most, most, bounds)


def acceleration_panel(axes: Any, run: Run, theme: Theme = LIGHT, bounds: bool = False) -> None:
    """Joint accelerations, and bounds that are close to a joint, or all finite bounds."""
    most = run.limits.acceleration
    _joints(axes, run, theme, run.qdd, rf"$\ddot q$ [{unit_of([run], '/s²')}]", -most, most, bounds)


def torque_panel(axes: Any, run: Run, theme: Theme = LIGHT, bounds: bool = False) -> None:
    """Torques of inverse dynamics, and bounds that are close to a torque, or all finite bounds."""
    assert run.torque is not None
    units, most = sorted(set(torque_units(run.arm)), reverse=True), run.largest_torques
    _joints(axes, run, theme, run.torque, rf"$\tau$ [{', '.join(units)}]", -most, most, bounds)


def joint_names(arm: Arm | Robot) -> list[str]:
    """Names of the joints for a legend; prismatic joints are marked if there are also revolute joints."""
    names, units = joint_labels(arm), joint_units(arm)
    return [f"{name} (prismatic)" if unit == "m" and "rad" in units else name for name, unit in zip(names, units)]


def unit_of(runs: Sequence[Run], per: str) -> str:
    """Unit of a quantity of all joints: 'rad/s', or 'rad/s, m/s' if some joints are prismatic."""
    units = sorted({unit for run in runs for unit in joint_units(run.arm)}, reverse=True)
    return ", ".join(unit + per for unit in units)


def _joints(
    axes: Any, run: Run, theme: Theme, values: Array, label: str, lower: Array, upper: Array, every: bool
) -> None:
    """A line for each joint and for each close bound: in the colour of its joint, or in ink for several joints.

    every: whether all finite bounds are drawn.
    """
    draw_lines(axes, theme, run.t, values, joint_names(run.arm), label)
    span = np.where(np.isfinite(upper - lower), upper - lower, 1.0)
    colours = [colour for (colour, _), _ in zip(theme.styles(), lower)]
    name = "bound"
    for bounds, gaps in ((lower, values - lower), (upper, upper - values)):
        near = np.isfinite(bounds) if every else gaps.min(axis=0, initial=np.inf) < NEAR * span
        for bound in np.unique(bounds[near]):
            owners = np.flatnonzero(near & (bounds == bound))
            colour = colours[owners[0]] if len(owners) == 1 else theme.ink
            axes.axhline(bound, color=colour, lw=0.8, ls=(0, (1, 1)), label=name, zorder=1.5)
            name = "_bound"
    side_legend(axes, theme)


def scale_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Task scale: fraction of the commanded motion that the limits admit, from 0 to 1; for a stack, of each level."""
    if run.stack is not None and run.scales is not None:
        names = [", ".join(task.name for task in level) for level in run.stack.levels]
        draw_lines(axes, theme, run.t, run.scales, names, "task scale")
    else:
        assert run.scale is not None
        axes.plot(run.t, run.scale, color=theme.lines[0], lw=LINE)
        axes.fill_between(run.t, run.scale, color=theme.lines[0], alpha=0.15, lw=0)
        over_time(axes, "task scale")
    axes.set(ylim=(0.0, 1.05), yticks=(0.0, 0.5, 1.0))
    top_legend(axes, theme)


def task_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Norms of the errors of a stack's tasks, separate for lengths and angles."""
    for (name, unit, values, _), (colour, dash) in zip(error_parts(run), theme.styles()):
        norms = np.linalg.norm(values, axis=1)
        axes.plot(*envelope(run.t, norms), color=colour, ls=dash, lw=LINE, label=f"{name} [{unit}]")
    over_time(axes, r"$\|e\|$")
    in_decades(axes)
    top_legend(axes, theme)


def saturation_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """A bar for each interval in which a joint is on a bound, with a line in the bar if the bound is on its torque."""
    assert run.saturated is not None
    n = run.arm.dof
    ends = np.append(run.t, run.t[-1:])
    torque = run.saturated & (run.bound_ratios().get("torque", np.zeros((1, 1))) > ON_BOUND)
    for joint, *on, (colour, _) in zip(range(1, n + 1), run.saturated.T, torque.T, theme.styles()):
        for flags, height, fill in zip(on, (0.8, 0.15), (colour, theme.ink)):
            edges = np.flatnonzero(np.diff(flags, prepend=False, append=False))
            spans = [(ends[a], ends[b] - ends[a]) for a, b in zip(edges[::2], edges[1::2])]
            axes.broken_barh(spans, (joint - height / 2, height), color=fill, lw=0)
    over_time(axes, "joint")
    axes.set(ylim=(n + 0.6, 0.4), yticks=range(1, n + 1, ceil(n / 8)))
    axes.grid(False, axis="y")
    axes.set_xlim(*(run.t[[0, -1]] if len(run.t) > 1 else (0.0, 1.0)))


def clearance_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Distance between the two nearest shapes, and the margin."""
    assert run.clearance is not None
    clearance = clearance_among(run.options.get("bounds") or ())
    axes.plot(run.t, np.where(np.isfinite(run.clearance), run.clearance, np.nan), color=theme.lines[0], lw=LINE)
    if clearance is not None:
        margin = axes.axhline(clearance.margin, color=theme.ink, lw=0.8, ls=(0, (1, 1)), label="margin")
        head_legend(axes, theme, [margin])
    over_time(axes, r"$d$ [m]")
    if np.all(run.clearance >= 0.0):
        from_zero(axes)


def manipulability_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """√det(JJᵀ), which is 0 in a singular posture (Yoshikawa, 1985), and the least singular value of J."""
    right = axes.twinx()
    dress(right, theme, "")
    right.grid(False)
    right.spines["left"].set_visible(False)
    right.spines["right"].set_visible(True)
    lines = (
        (axes, "left", "√det(JJᵀ)  —", run.manipulability(), theme.lines[0], "-"),
        (right, "right", r"$\sigma_\mathrm{min}(J)$  - -", min_singular_values(run), theme.lines[5], "--"),
    )
    for side, spine, label, values, colour, dash in lines:
        side.plot(run.t, values, color=colour, ls=dash, lw=LINE)
        over_time(side, label)
        from_zero(side)
        side.yaxis.label.set_color(colour)
        side.tick_params(axis="y", colors=colour)
        side.spines[spine].set_color(colour)


def null_space_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Norm of the joint velocity that does not move the tip: ‖(I − J⁺J) qd‖."""
    axes.plot(run.t, null_space_velocities(run), color=theme.lines[0], lw=LINE)
    over_time(axes, rf"$\|\dot q_N\|$ [{unit_of([run], '/s')}]")
    from_zero(axes)


def min_singular_values(run: Run) -> Array:
    """Least singular value of the task's Jacobian at each sample, shape (N,)."""
    return np.asarray(np.linalg.svd(run.jacobians(), compute_uv=False)[:, -1])


def null_space_velocities(run: Run) -> Array:
    """‖(I − J⁺J) qd‖ at each sample, shape (N,)."""
    _, s, Vt = np.linalg.svd(run.jacobians(), full_matrices=False)
    row_space = (s > 1e-12 * s[:, :1])[..., None] * Vt  # In a singular posture, the rank of J is less than m.
    return np.asarray(np.linalg.norm(run.qd - np.einsum("kmi,kmj,kj->ki", row_space, Vt, run.qd), axis=1))


class Panel(NamedTuple):
    """A panel: its heading, its function, whether it has a line for each joint, and whether a run has data for it."""

    heading: str
    draw: Callable[..., None]
    of_joints: bool = False
    fits: Callable[[Run], bool] = lambda run: True


PANELS = {
    "arm": Panel("Arm", arm_panel),
    "error": Panel("Tip error", tip_error_panel),
    "axis_errors": Panel("Tip error", error_panel),
    "axis_orientation_errors": Panel("Orientation error", orientation_error_panel, fits=lambda run: run.kind == "pose"),
    "task_errors": Panel("Task errors", task_error_panel, fits=lambda run: run.task_errors is not None),
    "positions": Panel("Joint positions", position_panel, of_joints=True),
    "velocities": Panel("Joint velocities", velocity_panel, of_joints=True),
    "accelerations": Panel("Joint accelerations", acceleration_panel, of_joints=True),
    "torques": Panel("Joint torques", torque_panel, of_joints=True, fits=lambda run: run.torque is not None),
    "saturation": Panel("Joints on a bound", saturation_panel, fits=lambda run: run.saturated is not None),
    "scale": Panel("Task scale", scale_panel, fits=lambda run: run.scale is not None or run.scales is not None),
    "clearance": Panel("Clearance", clearance_panel, fits=lambda run: run.clearance is not None),
    "manipulability": Panel("Manipulability", manipulability_panel),
    "null_space": Panel("Null-space velocity", null_space_panel),
}
OVERVIEW = tuple(name for name in PANELS if not name.startswith("axis") and name != "torques")


def choose(run: Run, panels: str | Sequence[str] | None) -> dict[str, Panel]:
    """The requested panels, without panels that have no data. Raises ValueError.

    By default OVERVIEW, and the torques if the motion has bounds on torques.
    """
    bounded = torque_bounds_among(run.options.get("bounds") or ()) is not None
    usual = tuple(name for name in PANELS if name in OVERVIEW or (bounded and name == "torques"))
    asked = usual if panels is None else (panels,) if isinstance(panels, str) else tuple(panels)
    for name in asked:
        if name not in PANELS:
            raise ValueError(f"panels: {name!r} must be one of {', '.join(PANELS)}")
        if asked.count(name) > 1:
            raise ValueError(f"panels: {name!r} is given twice: must be given once")
    chosen = {name: PANELS[name] for name in asked if PANELS[name].fits(run)}
    if not chosen:
        able = ", ".join(name for name, panel in PANELS.items() if panel.fits(run))
        raise ValueError(f"panels = {asked}: no data in this run: must have one of {able}")
    return chosen
