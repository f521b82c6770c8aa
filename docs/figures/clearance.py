"""A Panda whose reference leads through a table and a post, without and with a clearance: draws clearance.gif.

    python docs/figures/clearance.py [where to write the film]

Needs the dependency group 'peers' (for the Panda's meshes) and the extra 'clearance'. A quarter of a minute.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

import fpbm_cpp as fp
from fpbm_cpp.plot import OKABE_ITO
from fpbm_cpp.plot.animation import write_frames
from fpbm_cpp.skeleton import link_frames

FPS, SPEED = 12.5, 1.5
PANDA = fp.SerialArm.preset("panda")
START = np.array([0.6, 0.0, 0.0, -2.0, 0.0, 2.0, 0.785])
TOP = 0.15  # Height of the table [m].
TABLE = fp.Cuboid(np.array([[1, 0, 0, 0.6], [0, 1, 0, 0], [0, 0, 1, TOP - 0.02], [0, 0, 0, 1.0]]), [0.28, 0.55, 0.02])
X = 0.06 + PANDA.forward(START)[0, 3]
POST = fp.Capsule(0, [X, 0, TOP], [X, 0, TOP + 0.35], 0.05, "post")
LINK, WRONG, WORLD, GAP = "#8FB8DE", OKABE_ITO[5], "#E9B44C", OKABE_ITO[6]
TO_EYE = np.array([0.80, 0.25, 0.42]) / np.linalg.norm([0.80, 0.25, 0.42])
RIGHT = np.cross([0.0, 0.0, 1.0], TO_EYE) / np.linalg.norm(np.cross([0.0, 0.0, 1.0], TO_EYE))
VIEW = np.array([RIGHT, np.cross(TO_EYE, RIGHT)])  # Parallel projection: parallel lines stay parallel.
TURN = np.linspace(0.0, np.pi, 17)


def what_is_around() -> fp.Clearance:
    robots = metadata.distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots")
    urdf, srdf = (f"{robots}/panda_description/{kind}/panda.{kind}" for kind in ("urdf", "srdf"))
    return fp.Clearance.from_urdf(urdf, "panda_link8", srdf=srdf, obstacles=[TABLE, POST])


def motions(clearance: fp.Clearance) -> dict[str, fp.Run]:
    tip = PANDA.forward(START)[:3, 3]
    displacements = [[0, 0, TOP + 0.12 - tip[2]], [0, -2 * tip[1], 0], [0, 0, 0.35]]  # Down, across, up.
    path = fp.Sequence(
        [
            fp.Line(displacement, seconds, time_law="quintic")
            for displacement, seconds in zip(displacements, (2.0, 4.0, 2.0))
        ]
    )
    scheme = fp.FPBM(0.6, np.ones(7), k1=10, k2=25, null_damping=2)
    kept = {"without a clearance": [], "with a clearance": [clearance]}
    return {name: fp.track(PANDA, path, scheme, START, bounds=each, hold=0.5) for name, each in kept.items()}


def outline(a: np.ndarray, b: np.ndarray, radius: float) -> np.ndarray:
    """Outline of a projected capsule: two half circles."""
    a, b = VIEW @ a, VIEW @ b
    heading = np.arctan2(*(b - a)[::-1]) - np.pi / 2
    arc = radius * np.stack([np.cos(TURN + heading), np.sin(TURN + heading)], axis=1)
    return np.vstack([b + arc, a - arc])


def slab(box: fp.Cuboid) -> list[np.ndarray]:
    """The three visible sides of a box."""
    p, (x, y, z) = box.pose[:3, 3], box.half
    signs = np.sign(TO_EYE)
    sides = []
    for axis in range(3):
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
        sides.append((p + np.insert(corners, axis, signs[axis], axis=1) * [x, y, z]) @ VIEW.T)
    return sides


def draw(axes: Any, clearance: fp.Clearance, q: np.ndarray, trail: np.ndarray) -> float:
    """The arm, its surroundings and the nearest pair; returns the distance of this pair."""
    nearest = clearance.nearest(PANDA, q)
    frames = link_frames(PANDA, q)
    shapes = []
    for each in (*clearance.capsules, POST):
        frame = frames[each.link]
        ends = np.array([each.a, each.b]) @ frame[:3, :3].T + frame[:3, 3]
        hit = nearest.distance < 0 and each.name in nearest.pair
        colour = WRONG if hit else WORLD if each is POST else LINK
        shapes.append((ends.mean(axis=0), each.radius, ends, np.array(to_rgb(colour))))
    shapes.sort(key=lambda shape: shape[0] @ TO_EYE)
    under = [shape for shape in shapes if shape[0][2] < TOP and shape[0][0] > 0.3]
    over = [shape for shape in shapes if not any(shape is each for each in under)]
    axes.add_collection(_bodies(under))
    colours = np.clip([[*(np.array(to_rgb(WORLD)) * shade), 0.85] for shade in (0.75, 0.6, 1.05)], 0, 1)
    axes.add_collection(PolyCollection(slab(TABLE), facecolors=colours, edgecolors="white", lw=0.5))
    axes.add_collection(_bodies(over))
    axes.plot(*(trail @ VIEW.T).T, color="black", lw=0.9, ls=(0, (3, 2)))
    axes.plot(*(nearest.points @ VIEW.T).T, color=GAP, lw=2.5, marker=".", ms=6)
    return float(nearest.distance)


def _bodies(shapes: list[Any]) -> PolyCollection:
    """Capsules, from back to front, lit from beside the eye."""
    parts, colours = [], []
    for _, radius, (a, b), colour in shapes:
        for share, shade in ((1.06, 0.45), (1.0, 0.82), (0.72, 0.95), (0.4, 1.08)):
            lit = max(1.0 - share, 0.0) * radius * np.array([-0.3, 0.5])
            parts.append(outline(a, b, share * radius) + lit)
            colours.append(np.clip(shade * colour, 0.0, 1.0))
    return PolyCollection(parts, facecolors=colours, lw=0)


def film(clearance: fp.Clearance, runs: dict[str, fp.Run]) -> Iterator[np.ndarray]:
    first = next(iter(runs.values()))
    distances = {name: [clearance.nearest(PANDA, q).distance for q in run.q[::10]] for name, run in runs.items()}
    for sample in np.arange(0, len(first.t), round(1000 * SPEED / FPS)):
        figure = plt.figure(figsize=(8.0, 5.0), dpi=100)
        grid = figure.add_gridspec(
            2, 2, height_ratios=(4, 1), left=0.085, right=0.985, top=0.93, bottom=0.1, wspace=0.03
        )
        for column, (name, run) in enumerate(runs.items()):
            axes = figure.add_subplot(grid[0, column], aspect="equal", xlim=(-0.66, 0.66), ylim=(-0.36, 0.74))
            axes.axis("off")
            axes.set_title(name, fontsize=11)
            draw(axes, clearance, run.q[sample], run.x_ref)
        strip = figure.add_subplot(grid[1, :], xlim=(0, first.t[-1]), ylim=(-14, 8))
        for (name, each), colour in zip(distances.items(), (WRONG, OKABE_ITO[0])):
            now = sample // 10 + 1
            strip.plot(first.t[::10][:now], 100 * np.array(each)[:now], color=colour, lw=1.6, label=name)
        strip.axhline(100 * clearance.margin, color="black", lw=0.8, ls=":")
        strip.axhspan(-20, 0, color=WRONG, alpha=0.12, lw=0)
        strip.text(0.05, -12.5, "overlap", fontsize=8, color=WRONG)
        strip.text(0.05, 1.8, "margin", fontsize=8)
        strip.set(xlabel="time [s]", ylabel="distance [cm]")
        strip.legend(loc="lower right", fontsize=8, frameon=False, ncols=2)
        strip.spines[["top", "right"]].set_visible(False)
        figure.canvas.draw()
        yield np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
        plt.close(figure)


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "clearance.gif")
    clearance = what_is_around()
    runs = motions(clearance)
    for name, run in runs.items():
        nearest = min(clearance.nearest(PANDA, q).distance for q in run.q)
        end = np.linalg.norm(run.error[-1])
        print(f"{name}: nearest {100 * nearest:.2f} cm, {1e3 * end:.2f} mm from the target at the end")
    write_frames(out, film(clearance, runs), FPS)


if __name__ == "__main__":
    main()
