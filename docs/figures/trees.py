"""Two Pandas with a tray, a humanoid that reaches, a mobile Panda that wipes: draws tray.gif, reach.gif and wipe.gif.

    python docs/figures/trees.py [folder to write the films to]

The motions are those of examples 16 to 18. Needs the dependency group 'peers' (for the robots' URDF files). One minute.
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
FIRST, SECOND = "#D55E00", "#0072B2"
LINK, OTHER, BODY, WORLD, TRAY = "#8FB8DE", "#B9A6D9", "#C9C9C9", "#E9B44C", "#7FB77E"
CAPSULES = fp.Clearance.preset("panda").capsules
TURN = np.linspace(0.0, np.pi, 13)
Shape = tuple[np.ndarray, float, str]  # Ends of a capsule [m], or corners of a polygon; radius [m], 0 of a polygon.


def view(x: float, y: float, z: float) -> np.ndarray:
    """Axes of the picture to the right, upward and to the eye, which is in direction (x, y, z)."""
    to_eye = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    right = np.cross([0.0, 0.0, 1.0], to_eye)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(to_eye, right), to_eye])


def draw(axes: Any, shapes: Sequence[Shape], seen: np.ndarray) -> None:
    """Capsules and polygons, from back to front, in a light beside the eye."""
    parts, colours = [], []
    for points, radius, colour in sorted(shapes, key=lambda shape: float(shape[0].mean(axis=0) @ seen[2])):
        flat = points @ seen[:2].T
        if radius == 0:
            parts.append(flat)
            colours.append((*to_rgb(colour), 0.9))
            continue
        heading = np.arctan2(*(flat[1] - flat[0])[::-1]) - np.pi / 2
        arc = np.stack([np.cos(TURN + heading), np.sin(TURN + heading)], axis=1)
        for share, shade in ((1.0, 0.72), (0.75, 0.9), (0.45, 1.05)):
            light = (1.0 - share) * radius * np.array([-0.3, 0.5])
            parts.append(np.vstack([flat[1] + share * radius * arc, flat[0] - share * radius * arc]) + light)
            colours.append((*np.clip(shade * np.array(to_rgb(colour)), 0, 1), 1.0))
    axes.add_collection(PolyCollection(parts, facecolors=colours, lw=0))


def panda(robot: fp.Robot, q: np.ndarray, first: int, colour: str) -> list[Shape]:
    """Capsules of a Panda whose first joint has a number, by those of the preset."""
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
    seen = view(1.0, 0.0, 0.45)
    t, log = np.arange(1, 8001) / 1e3, np.maximum(errors, 1e-12)
    for i in range(0, 8000, round(1e3 / FPS)):
        figure = plt.figure(figsize=(6.4, 5.4), dpi=80)
        axes = figure.add_axes((0.02, 0.27, 0.96, 0.72), aspect="equal", xlim=(-0.8, 0.8), ylim=(-0.3, 0.78))
        axes.axis("off")
        shapes = [*panda(robot, q[i], 0, LINK), *panda(robot, q[i], 7, OTHER)]
        right, left = (robot.forward(q[i], f"{side}_tip")[:3, 3] for side in ("right", "left"))
        shapes.append((level((right[0] - 0.15, right[0] + 0.15), (right[1], left[1]), right[2] - 0.02), 0, TRAY))
        draw(axes, shapes, seen)
        trail = np.array([robot.forward(each, "right_tip")[:3, 3] for each in q[: i + 1 : 40]])
        axes.plot(*(trail @ seen[:2].T).T, color="black", lw=0.9, ls=(0, (3, 2)))
        strip = figure.add_axes((0.13, 0.1, 0.84, 0.16), xlim=(0, 8), ylim=(1e-13, 1), yscale="log")
        for column, (name, colour) in enumerate((("grasp", SECOND), ("tray", FIRST))):
            strip.plot(t[: i + 1 : 10], log[: i + 1 : 10, column], color=colour, lw=1.4, label=name)
        strip.legend(loc="upper left", fontsize=8, frameon=False, ncols=2)
        strip.set(xlabel="time [s]", ylabel="error [m, rad]")
        yield finish(figure, strip)


def finish(figure: Any, strip: Any) -> np.ndarray:
    strip.spines[["top", "right"]].set_visible(False)
    strip.tick_params(labelsize=8)
    figure.canvas.draw()
    picture = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    plt.close(figure)
    return picture


FILMS = {"tray": tray}


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS
    for name, frames in FILMS.items():
        write_frames(out / f"{name}.gif", frames(), FPS)


if __name__ == "__main__":
    main()
