"""A Panda on a circle that is too fast for its joints, without and with keep_path: draws paths.gif.

    python docs/figures/paths.py [where to write the film]

The film has a fifth of the speed of the motion. Ten seconds.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from trees import CAPSULES, FIRST, FPS, LINK, OTHER, SECOND, draw, scene, strip, view

import fpbm_cpp as fp
from fpbm_cpp.plot.animation import write_frames
from fpbm_cpp.skeleton import link_frames

ARM = fp.SerialArm.preset("panda")
READY = [0, -0.3, 0, -2.2, 0, 2, 0.785]  # [rad]
RADIUS, DURATION, HOLD = 0.15, 1.0, 0.5  # [m], [s], [s]
SLOWNESS = 5


def motions() -> dict[str, fp.Run]:
    path = fp.Circle(RADIUS, DURATION).in_plane("yz")
    return {
        name: fp.track(ARM, path, fp.MVN(k=5), READY, task="pose", hold=HOLD, keep_path=keeps)
        for name, keeps in {"fp.track": False, "fp.track(…, keep_path=True)": True}.items()
    }


def distances(run: fp.Run) -> np.ndarray:
    """Distance of the tip from the circle at each sample [m]."""
    x, y, z = (run.positions - run.positions[0]).T
    return np.hypot(x, np.hypot(y + RADIUS, z) - RADIUS)


def film(runs: dict[str, fp.Run]) -> Iterator[np.ndarray]:
    seen = view(1.0, 0.6, 0.3)
    turn = np.linspace(0.0, 2 * np.pi, 100)[:, None]
    circle = RADIUS * np.hstack([0 * turn, np.cos(turn) - 1, np.sin(turn)])
    away = {name: 100 * distances(run) for name, run in runs.items()}
    length = max(len(run.t) for run in runs.values())
    away = {name: np.append(each, np.full(length - len(each), each[-1])) for name, each in away.items()}
    for i in range(0, length, round(1e3 / (SLOWNESS * FPS))):
        figure = plt.figure(figsize=(6.4, 4.8), dpi=80)
        for column, (name, run) in enumerate(runs.items()):
            now = min(i, len(run.t) - 1)
            axes = scene(figure, (0.01 + 0.49 * column, 0.27, 0.49, 0.69), (-0.6, 0.34), (-0.14, 0.86))
            axes.set_title(name, fontsize=10, y=0.97, color=(FIRST, SECOND)[column])
            axes.plot(*((run.positions[0] + circle) @ seen[:2].T).T, color="black", lw=0.9, ls=(0, (3, 2)))
            frames = link_frames(ARM, run.q[now])
            links = [
                (np.array([c.a, c.b]) @ frames[c.link][:3, :3].T + frames[c.link][:3, 3], c.radius) for c in CAPSULES
            ]
            draw(axes, [(*each, (OTHER, LINK)[column]) for each in links], seen)
            axes.plot(*(run.positions[: now + 1] @ seen[:2].T).T, color=(FIRST, SECOND)[column], lw=2)
            axes.plot(*(seen[:2] @ run.positions[now]), color="black", marker="o", ms=4)
        yield strip(figure, (0.12, 0.11, 0.86, 0.17), away, i, "distance [cm]", ylim=(-0.5, 9))


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "paths.gif")
    runs = motions()
    for name, run in runs.items():
        print(f"{name}: {run.t[-1] - HOLD:.2f} s, tip at most {distances(run).max():.0e} m off the circle")
    write_frames(out, film(runs), FPS)


if __name__ == "__main__":
    main()
