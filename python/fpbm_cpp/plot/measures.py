"""Panels of how the arm stands to its task: how far from a singular posture, and what its joints do that the tip does
not see."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .joints import unit_of
from .lines import from_zero, over_time
from .theme import LIGHT, LINE, Theme, dress

if TYPE_CHECKING:
    from .._types import Array
    from ..run import Run


def manipulability_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """How far the posture is from a singular one: √det(JJᵀ) (Yoshikawa, 1985), and J's least σ with its own scale."""
    right = axes.twinx()
    dress(right, theme, "")
    right.grid(False)
    right.spines["left"].set_visible(False)
    right.spines["right"].set_visible(True)
    values = {"√det(JJᵀ)": run.manipulability(), r"$\sigma_\mathrm{min}(J)$": least_singular_values(run)}
    looks = ((theme.lines[0], "-", "—"), (theme.lines[5], "--", "- -"))
    for side, (name, column), (colour, dash, sign) in zip((axes, right), values.items(), looks):
        side.plot(run.t, column, color=colour, ls=dash, lw=LINE)
        over_time(side, f"{name}  {sign}")
        from_zero(side)
        side.yaxis.label.set_color(colour)
        side.tick_params(axis="y", colors=colour)
        side.spines["left" if side is axes else "right"].set_color(colour)


def null_space_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """How fast the joints move without moving the tip: ‖(I − J⁺J) qd‖."""
    axes.plot(run.t, null_space_velocities(run), color=theme.lines[0], lw=LINE)
    over_time(axes, rf"$\|\dot q_N\|$ [{unit_of([run], '/s')}]")
    from_zero(axes)


def least_singular_values(run: Run) -> Array:
    """The least singular value of the task's Jacobian, shape (N,)."""
    return np.asarray(np.linalg.svd(_jacobians(run), compute_uv=False)[:, -1])


def null_space_velocities(run: Run) -> Array:
    """‖(I − J⁺J) qd‖, shape (N,)."""
    _, s, Vt = np.linalg.svd(_jacobians(run), full_matrices=False)
    seen = (s > 1e-12 * s[:, :1])[..., None] * Vt  # What of the joints' motions the tip sees.
    return np.asarray(np.linalg.norm(run.qd - np.einsum("kmi,kmj,kj->ki", seen, Vt, run.qd), axis=1))


def _jacobians(run: Run) -> Array:
    """J of each sample, shape (N, m, n)."""
    m = run.error.shape[1]
    return np.array([run.arm.jacobian(q, task=run.task) for q in run.q]).reshape(-1, m, run.arm.dof)
