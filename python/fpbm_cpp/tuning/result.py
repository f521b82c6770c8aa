"""The result of a tuning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .._types import Array
from ..arms import Arm
from ..paths import Path
from ..schemes import FPBM
from .space import numbers, tunable
from .trials import Trials

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False, eq=False)
class Tuning:
    """The best scheme found, its sensitivity, and all that was tried.

    Attributes
    ----------
    trials : Trials
        All schemes tried and their results, the baseline first.
    sensitivity : dict of str to (float, float)
        Change of the objective when one parameter of the best steps down, and up: alpha by 0.05, within [0, 1], all
        others by 10 %. NaN where it cannot step, infinite where the step is infeasible. Empty after an interruption.
    objective, unit : str
        Name and unit of the objective; the unit is empty for a function of the caller's.
    arm, path, q0, task
        The motion.
    """

    trials: Trials
    sensitivity: dict[str, tuple[float, float]]
    objective: str
    unit: str
    arm: Arm
    path: Path
    q0: Array
    task: str

    @property
    def scheme(self) -> FPBM:
        """The best of all feasible trials, ready to use."""
        best: FPBM = self.trials.schemes[self.trials.best()]
        return best

    @property
    def value(self) -> float:
        """The objective of the best."""
        return float(self.trials.value[self.trials.best()])

    @property
    def parameters(self) -> dict[str, Any]:
        """The tunable parameters of the best, by FPBM's names."""
        return tunable(self.scheme)

    @property
    def front(self) -> Trials:
        """The Pareto front: the feasible trials that no other beats in both peak velocity and peak acceleration."""
        return self.trials.front()

    @property
    def baseline(self) -> FPBM:
        """The scheme that the best is compared with."""
        first: FPBM = self.trials.schemes[0]
        return first

    @property
    def baseline_value(self) -> float:
        """The objective of the baseline; NaN if that is infeasible."""
        return float(self.trials.scores()[0])

    @property
    def improvement(self) -> float:
        """How far the best is below the baseline, as a share of the baseline's value; NaN if that is NaN or 0."""
        before = self.baseline_value
        return (before - self.value) / abs(before) if before else np.nan

    def plot(self, *, dark: bool = False) -> Figure:
        """Figure of the Pareto front with the best and the baseline, the sensitivity, and the convergence.

        Raises ImportError, with what to install, if matplotlib is missing.
        """
        from .figure import plot_tuning

        return plot_tuning(self, dark=dark)

    def __str__(self) -> str:
        """A table of each parameter: the baseline's value, the best value, and the sensitivity."""
        trials, unit = self.trials, f" {self.unit}" if self.unit else ""
        lines = [
            f"{self.objective} of {self.arm} along {self.path!r}",
            f"{self.value:.5g}{unit}, {self._against()}",
            f"{len(trials)} schemes tried, {trials.feasible.sum()} feasible, {len(self.front)} on the Pareto front",
            "",
            f"{'':14}{'baseline':>12}{'tuned':>12}" + (f"{'-10 %':>12}{'+10 %':>12}" if self.sensitivity else ""),
        ]
        before = numbers(self.baseline)
        for name, value in numbers(self.scheme).items():
            steps = "".join(f"{_change(step):>12}" for step in self.sensitivity.get(name, ()))
            lines.append(f"{name:14}{before[name]:12.4g}{value:12.4g}{steps}")
        if self.sensitivity:
            lines += ["", f"-10 %, +10 %: change of {self.objective} when one parameter changes so (alpha by 0.05)"]
        return "\n".join(lines)

    def _against(self) -> str:
        if np.isnan(self.baseline_value):
            return "where the baseline is infeasible"
        share = f"{100 * self.improvement:.3g} % below " if self.baseline_value else "against "
        return f"{share}the baseline's {self.baseline_value:.5g}"

    def __repr__(self) -> str:
        return f"<Tuning of {self.objective}: {self.value:.5g}, {self._against()}; {self.scheme!r}>"


def _change(step: float) -> str:
    """A change of the objective, for the table."""
    return "-" if np.isnan(step) else "infeasible" if np.isinf(step) else f"{step:+.2e}"
