"""Two Pandas with a tray, a humanoid that reaches, a mobile Panda that wipes: draws tray.gif, reach.gif and wipe.gif.

    python docs/figures/trees.py [folder to write the films to]

The motions are from examples 16 to 18. Needs the dependency group 'peers' (for the robots' URDF files), and one minute.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

import fpbm_cpp as fp
from fpbm_cpp.plot.animation import write_frames

DOCS = Path(__file__).parent.parent
sys.path.insert(0, str(DOCS.parent / "examples"))

FPS = 12.5
GRIPPER = 0.1  # From a flange to the held object [m].
FIRST, SECOND = "#D55E00", "#0072B2"
LINK, OTHER, BODY, WORLD, TRAY = "#8FB8DE", "#B9A6D9", "#C9C9C9", "#E9B44C", "#7FB77E"
CAPSULES = fp.Clearance.preset("panda").capsules
TURN = np.linspace(0.0, np.pi, 13)
Shape = tuple[np.ndarray, float, str]  # Ends of a capsule [m], or corners of a polygon; radius [m], 0 for a polygon.


def view(x: float, y: float, z: float) -> np.ndarray:
    """Axes of the picture to the right, upward and to the eye, which is in direction (x, y, z)."""
    to_eye = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    right = np.cross([0.0, 0.0, 1.0], to_eye)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(to_eye, right), to_eye])


def draw(axes: Any, shapes: Sequence[Shape], seen: np.ndarray) -> None:
    """Capsules and polygons, from back to front, lit from beside the eye."""
    parts, colours = [], []
    for points, radius, colour in sorted(shapes, key=lambda shape: float(shape[0].mean(axis=0) @ seen[2])):
        flat = points @ seen[:2].T
        if radius == 0:
            parts.append(flat)
            colours.append((*to_rgb(colour), 1.0))
            continue
        heading = np.arctan2(*(flat[1] - flat[0])[::-1]) - np.pi / 2
        arc = np.stack([np.cos(TURN + heading), np.sin(TURN + heading)], axis=1)
        for share, shade in ((1.0, 0.72), (0.75, 0.9), (0.45, 1.05)):
            light = (1.0 - share) * radius * np.array([-0.3, 0.5])
            parts.append(np.vstack([flat[1] + share * radius * arc, flat[0] - share * radius * arc]) + light)
            colours.append((*np.clip(shade * np.array(to_rgb(colour)), 0, 1), 1.0))
    axes.add_collection(PolyCollection(parts, facecolors=colours, lw=0))


def panda(robot: fp.Robot, q: np.ndarray, first: int, colour: str) -> list[Shape]:
    """Capsules of the Panda whose first joint has the index `first`, from the capsules of the preset."""
    names = [robot.joint_names[first + i] for i in range(7)]
    root = np.eye(4) if robot.joints[first].parent == 0 else robot.forward(q, robot.joint_names[first - 1])
    shift = robot.joints[first].joint.placement[:3, 3] * [1, 1, 0]
    frames = [root @ np.block([[np.eye(3), shift[:, None]], [np.zeros(3), 1]]), *(robot.forward(q, n) for n in names)]
    return [
        (np.array([frames[c.link][:3, :3] @ end + frames[c.link][:3, 3] for end in (c.a, c.b)]), c.radius, colour)
        for c in CAPSULES
    ]


def level(x: Sequence[float], y: Sequence[float], z: float) -> np.ndarray:
    """Corners of a horizontal rectangle."""
    return np.array([[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]])


def tray() -> Iterator[np.ndarray]:
    """Example 16: the circle, then the jump."""
    example = importlib.import_module("16_carry_a_tray")
    robot = example.robot
    tracker = fp.Tracker(robot, fp.Balanced(0, np.ones(14), null_damping=2), example.q0, stack=example.stack)
    path = tracker.follow(fp.Circle(0.1, 6.0).in_plane("yz"), task="tray")
    q, errors = [], []
    goal: Any = path
    for i in range(8000):
        if i == 6000:
            goal = tracker.tip["tray"].copy()
            goal[:3, 3] += [0.05, -0.1, 0.15]
        tick = tracker.tick({"tray": goal})
        q.append(tick.q)
        errors.append([np.linalg.norm(tick.errors[name]) for name in ("grasp", "tray")])
    print(f"tray.gif: grasp off by at most {np.max(errors, axis=0)[0]:.0e} m and rad")
    seen = view(1.0, 0.2, 0.4)
    lines = {"grasp": np.maximum(errors, 1e-12)[:, 0], "tray": np.maximum(errors, 1e-12)[:, 1]}
    for i in range(0, 8000, round(1e3 / FPS)):
        figure = plt.figure(figsize=(6.4, 5.0), dpi=80)
        axes = scene(figure, (0.02, 0.26, 0.96, 0.73), (-0.85, 0.85), (-0.2, 0.81))
        hands = [robot.forward(q[i], f"{side}_tip")[:3, 3] for side in ("right", "left")]
        down = np.array([0.0, 0.0, -GRIPPER])
        (x, y, z), end = hands[0] + down, hands[1] + down
        shapes = [*panda(robot, q[i], 0, LINK), *panda(robot, q[i], 7, OTHER)]
        shapes += [(np.array([hand, hand + down]), 0.03, BODY) for hand in hands]
        draw(axes, [*shapes, (level((x - 0.13, x + 0.13), (y, end[1]), z), 0, TRAY)], seen)
        trail = np.array([robot.forward(each, "right_tip")[:3, 3] for each in q[: i + 1 : 40]])
        axes.plot(*(trail @ seen[:2].T).T, color="black", lw=0.9, ls=(0, (3, 2)))
        yield strip(figure, (0.13, 0.1, 0.84, 0.16), lines, i, "error [m, rad]", ylim=(1e-13, 1e3), yscale="log")


def body(robot: fp.Robot, whole: fp.Robot, q: np.ndarray, colour: str) -> list[Shape]:
    """Capsules between the joints of a humanoid, whose legs are held."""
    angles = dict(zip(robot.joint_names, q))
    posture = [angles.get(name, 0.0) for name in whole.joint_names]
    at = {name: whole.forward(posture, name) for name in whole.joint_names}
    shapes = []
    for each in whole.joints:
        name = each.joint.name
        start = at[whole.joint_names[each.parent - 1]][:3, 3] if each.parent else np.zeros(3)
        if "shoulder_pitch" in name:
            start = at["waist_pitch_joint"] @ [0, 0, each.joint.placement[2, 3], 1]
        leg = any(part in name for part in ("hip", "knee", "ankle"))
        radius = 0.055 if leg else 0.034
        shapes.append((np.array([start[:3], at[name][:3, 3]]), radius, BODY if leg else colour))
    torso = [at["waist_pitch_joint"] @ [0, 0, z, 1] for z in (0.02, 0.2, 0.4, 0.44)]
    shapes.append((np.array([torso[0][:3], torso[1][:3]]), 0.09, colour))
    shapes.append((np.array([torso[2][:3], torso[3][:3]]), 0.06, BODY))
    for hand in ("left", "right"):
        wrist = at[f"{hand}_wrist_yaw_joint"]
        shapes.append((np.array([wrist[:3, 3], (wrist @ [0.09, 0, 0, 1])[:3]]), 0.025, WORLD))
    return shapes


def reach() -> Iterator[np.ndarray]:
    """Example 17: without and with the centre of mass on the second level."""
    example = importlib.import_module("17_humanoid_reach")
    whole = fp.Robot.from_urdf(f"{example.ROBOTS}/g1_description/urdf/g1_29dof_rev_1_0.urdf", base="fixed")
    print("reach.gif: hands, posture; then hands, centre of mass, posture")
    runs = {
        "hands": example.reach(),
        "hands, then centre of mass": example.reach(fp.CenterOfMassTask(rows=("x", "y"))),
    }
    seen = view(0.75, -0.8, 0.25)
    pitch = {name: np.degrees([each[example.waist[2]] for each in q]) for name, q in runs.items()}
    for i in range(0, 9000, round(1e3 / FPS)):
        figure = plt.figure(figsize=(6.4, 5.0), dpi=80)
        for column, (name, q) in enumerate(runs.items()):
            axes = scene(figure, (0.02 + 0.48 * column, 0.26, 0.48, 0.69), (-0.32, 0.5), (-0.38, 0.57))
            axes.set_title(name, fontsize=10, y=0.96, color=(FIRST, SECOND)[column])
            draw(axes, body(example.robot, whole, q[i], (LINK, OTHER)[column]), seen)
            goals = example.goals(*list(example.PLACES.values())[min(i // 3000, 2)])
            for goal in goals.values():
                axes.plot(*(seen[:2] @ goal[:3, 3]), marker="+", color="black", ms=9, mew=1.2)
        yield strip(figure, (0.13, 0.1, 0.84, 0.16), pitch, i, "waist pitch [°]", ylim=(-20, 50))


def wipe() -> Iterator[np.ndarray]:
    """Example 18: a light base and a heavy base."""
    example = importlib.import_module("18_wipe_a_table")
    robot, runs, driven = example.robot, {}, {}
    for name, weight in {"light base": 0.05, "heavy base": 60.0}.items():
        runs[name], error, _ = example.wipe(weight)
        driven[name] = np.cumsum(np.linalg.norm(np.diff(runs[name][:, :2], axis=0), axis=1))
        print(f"wipe.gif: {name}: tip off by at most {error:.0e} m, base travels {driven[name][-1]:.2f} m")
    seen = view(0.65, -0.6, 0.75)
    tips = {name: np.array([robot.forward(each, "panda_link8")[:3, 3] for each in q[::60]]) for name, q in runs.items()}
    (x, y, z), count = tips["light base"][0] - [0, 0, GRIPPER], len(runs["light base"])
    for i in range(0, count, round(2e3 / FPS)):
        figure = plt.figure(figsize=(7.2, 4.6), dpi=80)
        for column, (name, q) in enumerate(runs.items()):
            axes = scene(figure, (0.01 + 0.49 * column, 0.26, 0.49, 0.7), (-0.4, 1.36), (-0.58, 0.98))
            axes.set_title(name, fontsize=10, y=0.96, color=(FIRST, SECOND)[column])
            shapes = panda(robot, q[i], 3, LINK)
            tip = robot.forward(q[i], "panda_link8")[:3, 3]
            shapes.append((np.array([tip, tip - [0, 0, GRIPPER]]), 0.03, BODY))
            draw(axes, base(robot.forward(q[i], "base_yaw")), seen)  # Drawn before the table, which is nearer.
            draw(axes, [(level((x - 0.05, x + 0.42), (y - 0.08, y + 0.98), z), 0, WORLD)], seen)
            trail = tips[name][: i // 60 + 1] - [0, 0, GRIPPER]
            axes.plot(*(trail @ seen[:2].T).T, color="white", lw=5, alpha=0.6, solid_capstyle="round")
            draw(axes, shapes, seen)
        yield strip(figure, (0.11, 0.11, 0.86, 0.16), driven, i, "travel [m]", ylim=(0, 2.6))


def base(place: np.ndarray) -> list[Shape]:
    """Sides and top of a mobile base."""
    corners = np.array([[x, y, z, 1] for z in (-0.35, 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    points = (corners * [0.2, 0.17, 1, 1] @ place.T)[:, :3]
    sides = ((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7))
    shades = ("#9A9A9A", "#8A8A8A", "#9A9A9A", "#8A8A8A", BODY)
    return [(points[list(side)], 0, shade) for side, shade in zip(sides, shades)]


def scene(figure: Any, place: tuple[float, ...], xlim: tuple[float, float], ylim: tuple[float, float]) -> Any:
    axes = figure.add_axes(place, aspect="equal", xlim=xlim, ylim=ylim)
    axes.axis("off")
    return axes


def strip(
    figure: Any, place: tuple[float, ...], lines: dict[str, np.ndarray], now: int, label: str, **options: Any
) -> np.ndarray:
    """The picture with a strip of lines up to a tick."""
    axes = figure.add_axes(place, **options)
    for (name, line), colour in zip(lines.items(), (FIRST, SECOND)):
        axes.plot(1e-3 * np.arange(now + 1)[::10], line[: now + 1 : 10], color=colour, lw=1.5, label=name)
    axes.legend(loc="upper left", fontsize=8, frameon=False, ncols=2)
    axes.set(xlim=(0, 1e-3 * len(next(iter(lines.values())))), xlabel="time [s]", ylabel=label)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)
    figure.canvas.draw()
    picture = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    plt.close(figure)
    return picture


FILMS = {"tray": tray, "reach": reach, "wipe": wipe}


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS
    for name, frames in FILMS.items():
        write_frames(out / f"{name}.gif", frames(), FPS)


if __name__ == "__main__":
    main()
