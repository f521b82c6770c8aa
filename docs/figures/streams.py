"""A policy with jumps and stalls on a Panda, through a forwarder and through a JointStream: draws streams.gif.

    python docs/figures/streams.py [where to write the film]

The motions are from example 23. Ten seconds.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from trees import CAPSULES, FIRST, FPS, LINK, OTHER, SECOND, draw, scene, strip, view

import fpbm_cpp as fp
from fpbm_cpp.plot.animation import write_frames
from fpbm_cpp.skeleton import link_frames

example = importlib.import_module("23_policy_chunks")
ARM = fp.SerialArm.preset("panda")
DT = example.TICKS["panda"]
HOLD = round(0.05 / DT)  # Ticks in which a peak of the acceleration is shown.


def motions() -> dict[str, np.ndarray]:
    home = np.array(example.READY["panda"])
    loops = {"forwarder": example.Forwarder(home), "JointStream": example.Shield(ARM, home, ARM.limits, DT)}
    return {name: example.motion(home, DT, loop.receive, loop.command)[0] for name, loop in loops.items()}


def accelerations(q: np.ndarray) -> np.ndarray:
    """Largest acceleration of a joint relative to its bound, at each tick and the ticks before."""
    change = np.diff(q, 2, axis=0, prepend=np.tile(q[0], (2, 1)))
    share = np.max(np.abs(change) / DT**2 / ARM.limits.acceleration, axis=1)
    padded = np.concatenate([np.zeros(HOLD - 1), share])
    return np.lib.stride_tricks.sliding_window_view(padded, HOLD).max(axis=1)


def film(runs: dict[str, np.ndarray]) -> Iterator[np.ndarray]:
    seen = view(0.5, -1.0, 0.3)
    lines = {name: np.maximum(accelerations(q), 1e-3) for name, q in runs.items()}
    tips = {name: np.array([ARM.forward(each)[:3, 3] for each in q]) for name, q in runs.items()}
    for i in range(0, len(next(iter(runs.values()))), round(1e3 / FPS)):
        figure = plt.figure(figsize=(6.4, 4.8), dpi=80)
        for column, (name, q) in enumerate(runs.items()):
            axes = scene(figure, (0.01 + 0.49 * column, 0.27, 0.49, 0.69), (-0.4, 0.75), (-0.1, 1.0))
            axes.set_title(name, fontsize=10, y=0.97, color=(FIRST, SECOND)[column])
            frames = link_frames(ARM, q[i])
            links = [
                (np.array([c.a, c.b]) @ frames[c.link][:3, :3].T + frames[c.link][:3, 3], c.radius) for c in CAPSULES
            ]
            draw(axes, [(*each, (OTHER, LINK)[column]) for each in links], seen)
            axes.plot(*(tips[name][max(0, i - 1500) : i + 1] @ seen[:2].T).T, color=(FIRST, SECOND)[column], lw=1.2)
        label = "acceleration / bound"
        yield strip(figure, (0.12, 0.11, 0.86, 0.17), lines, i, label, ylim=(1e-2, 1e9), yscale="log")


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "streams.gif")
    runs = motions()
    for name, q in runs.items():
        print(f"{name}: largest acceleration {accelerations(q).max():.3g} of the bound")
    write_frames(out, film(runs), FPS)


if __name__ == "__main__":
    main()
