"""The result of a tuning: its text and its figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .search import numbers
from .trials import TuningData

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NOT_FINITE = {"+nan": "-", "+inf": "infeasible"}


class Tuning(TuningData):
    """The best scheme, its sensitivity, and the trials, starting with the baseline; arm, path, q0, task are the motion.

    sensitivity is the change of the objective for a step down and a step up of one parameter of the best scheme: 0.05
    for alpha, within [0, 1], and 10 % for all others. The change is NaN if the parameter cannot step, and infinite if
    the step is infeasible. After an interruption, sensitivity is empty. objective is a name; the unit of a user's
    function is empty.
    """

    def plot(self, *, dark: bool = False) -> Figure:
        """Figure of the Pareto front with best and baseline, the sensitivity, and the convergence. Needs matplotlib."""
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
            changes = (f"{step:+.2e}" for step in self.sensitivity.get(name, ()))
            steps = "".join(f"{NOT_FINITE.get(change, change):>12}" for change in changes)
            lines.append(f"{name:14}{before[name]:12.4g}{value:12.4g}{steps}")
        if self.sensitivity:
            lines += ["", f"-10 %, +10 %: change of {self.objective} for this step of one parameter (0.05 for alpha)"]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Tuning of {self.objective}: {self.value:.5g}, {self._against()}; {self.scheme!r}>"

    def _against(self) -> str:
        if np.isnan(self.baseline_value):
            return "where the baseline is infeasible"
        share = f"{100 * self.improvement:.3g} % below " if self.baseline_value else "against "
        return f"{share}the baseline's {self.baseline_value:.5g}"


class TuneInterrupted(KeyboardInterrupt):
    """A tuning was stopped by Ctrl-C. tuning: the result so far; None if no feasible scheme was found."""

    def __init__(self, tuning: Tuning | None, tried: int) -> None:
        super().__init__(f"interrupted after {tried} schemes")
        self.tuning = tuning
