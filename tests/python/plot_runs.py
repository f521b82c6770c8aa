"""Motions to draw, and requirements on all figures."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Any
from unittest.mock import patch

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

import fpbm_cpp as fp


def a_run(joints: int = 4, **options: Any) -> fp.Run:
    return fp.simulate(
        fp.PlanarArm(np.full(joints, 4 / joints)),
        fp.Circle(0.3, 2.0),
        fp.FPBM(0.5, np.arange(1, joints + 1), 1, 1, null_damping=1.0),
        np.full(joints, 1.5 / joints),
        **{"dt": 0.01, **options},
    )


def a_run_in_space(task: str = "pose", **options: Any) -> fp.Run:
    """An arm on a rail, 8 joints of which one slides."""
    panda = fp.SerialArm.preset("panda")
    arm = fp.SerialArm([fp.Joint("prismatic", axis=(0, 1, 0), name="rail"), *panda.joints], panda.tip)
    q0 = [0.1, 0, -0.8, 0, -2.4, 0, 1.6, 0.8]
    scheme = fp.FPBM(0.5, np.arange(1, 9), 20, 100, null_damping=1.0)
    return fp.simulate(arm, fp.Circle(0.1, 2.0).in_plane("yz"), scheme, q0, task=task, **{"dt": 0.01, **options})


def a_run_within_limits() -> fp.Run:
    """A run that seems to be slowed by limits from 0.5 s to 1 s.

    Joint 2 is on a bound then and at the end, and the tip moves up and down before a wall.
    """
    run = a_run()
    slowed = (run.t >= 0.5) & (run.t < 1.0)
    saturated = np.zeros(run.q.shape, dtype=bool)
    saturated[slowed, 1] = saturated[-1, 1] = True
    lower, upper = run.q.min(axis=0) - 2.0, run.q.max(axis=0) + 2.0
    lower[0] = run.q[:, 0].min()
    velocity = np.full(4, np.abs(run.qd).max())
    limits = fp.JointLimits(lower=lower, upper=upper, velocity=velocity, acceleration=np.full(4, np.inf))
    scale = np.where(slowed, 0.25, 1.0)
    clearance = fp.Clearance([fp.Capsule(4, [1, 0, 0], [1, 0, 0], 0.0)], [fp.HalfSpace([0, 1, 0], 0.0)])
    distances = run.x[:, 1] - run.x[:, 1].min() + clearance.margin
    options = {**run.options, "limits": limits, "bounds": (clearance,)}
    return replace(run, scale=scale, saturated=saturated, clearance=distances, options=options)


def a_stopped_run() -> fp.Run:
    arm, path = fp.PlanarArm([1, 1, 1]), fp.Line([3.0, 0.0], 2.0)
    return fp.simulate(arm, path, fp.MAN(), [0.3, 0.4, 0.5], dt=0.01, partial=True)


def panels(figure: Figure) -> dict[str, Any]:
    """Axes by their headings, in the order of their letters."""
    titled = {axes.get_title(loc="left"): axes for axes in figure.axes if axes.get_title(loc="left")}
    return dict(sorted(titled.items()))


def assert_tidy(figure: Figure) -> None:
    """Texts have 9 points or more and enough contrast, are inside the figure, and do not overlap."""
    background = luminance(figure.get_facecolor())
    boxes = []
    for text in drawn_texts(figure):
        assert text.get_fontsize() >= 9, text
        dark, light = sorted([luminance(text.get_color()), background])
        assert (light + 0.05) / (dark + 0.05) > 3.0, text
        box = text.get_window_extent()
        assert figure.bbox.x0 - 1 <= box.x0 < box.x1 <= figure.bbox.x1 + 1, text
        assert figure.bbox.y0 - 1 <= box.y0 < box.y1 <= figure.bbox.y1 + 1, text
        boxes.append((text, box))
    for (text, box), (other, its) in combinations(boxes, 2):
        width, height = min(box.x1, its.x1) - max(box.x0, its.x0), min(box.y1, its.y1) - max(box.y0, its.y0)
        assert min(width, height) < 4, (text, other)  # The height of a letter is 25 pixels or more.


def drawn_texts(figure: Figure) -> list[Text]:
    texts: list[Text] = []
    draw = Text.draw

    def recorded(text: Text, renderer: Any) -> None:
        if text.get_visible() and text.get_text():
            texts.append(text)
        draw(text, renderer)

    with patch.object(Text, "draw", recorded):
        figure.draw_without_rendering()
    return texts


def luminance(colour: Any) -> float:
    """Relative luminance (WCAG 2)."""
    rgb = np.array(to_rgb(colour))
    return float(np.where(rgb <= 0.03928, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722])
