"""Panels of the distance from singular postures, and of the joint motion that does not move the tip."""

from typing import Any

import numpy as np

from .._types import Array
from ..motion.run import Run
from .joints import unit_of
from .lines import from_zero, over_time
from .theme import LIGHT, LINE, Theme, dress


def manipulability_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """√det(JJᵀ), which is 0 in a singular posture (Yoshikawa, 1985), and on its own scale J's least singular value."""
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
    return np.asarray(np.linalg.svd(_jacobians(run), compute_uv=False)[:, -1])


def null_space_velocities(run: Run) -> Array:
    """‖(I − J⁺J) qd‖ at each sample, shape (N,)."""
    _, s, Vt = np.linalg.svd(_jacobians(run), full_matrices=False)
    row_space = (s > 1e-12 * s[:, :1])[..., None] * Vt  # J's rank is less than m in a singular posture.
    return np.asarray(np.linalg.norm(run.qd - np.einsum("kmi,kmj,kj->ki", row_space, Vt, run.qd), axis=1))


def _jacobians(run: Run) -> Array:
    """J at each sample, shape (N, m, n)."""
    m = run.error.shape[1]
    return np.array([run.arm.jacobian(q, task=run.task) for q in run.q]).reshape(-1, m, run.arm.dof)
