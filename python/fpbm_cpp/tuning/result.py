"""What a tuning comes to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import FPBM, Arm, Path
from .._types import Array
from .sensitivity import flat
from .space import parameters
from .trials import Trials

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False, eq=False)
class Tuning:
    """The best scheme that was found, how firm the choice is, and all that was tried.

    Attributes
    ----------
    trials : Trials
        All schemes that were tried and what came of them, the baseline first.
    sensitivity : dict of str to (float, float)
        By how much the objective changes as one parameter of the best steps down, and up: alpha by 0.05, within
        [0, 1], all others by 10 %. Not a number where it cannot step, infinite where that is infeasible. Empty where
        the tuning was interrupted.
    objective, unit : str
        What was made small: a name, and its unit, empty for a function of the caller's.
    arm, path, q0, task
        What moved, along what, from where, and as what task.
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
        """Those of the best that can be tuned, by the names that FPBM has for them."""
        return parameters(self.scheme)

    @property
    def front(self) -> Trials:
        """The Pareto front of peak velocity and peak acceleration: the trials that no other beats in both."""
        return self.trials.front()

    @property
    def baseline(self) -> FPBM:
        """What the best is compared with."""
        first: FPBM = self.trials.schemes[0]
        return first

    @property
    def baseline_value(self) -> float:
        """The objective of the baseline, not a number where that is infeasible."""
        return float(self.trials.scores()[0])

    @property
    def improvement(self) -> float:
        """By what share of the baseline's value the best is below it; not a number where there is none, or it is 0."""
        before = self.baseline_value
        return (before - self.value) / abs(before) if before else np.nan

    def plot(self, *, dark: bool = False) -> Figure:
        """Figure of the tuning: the front with the best and the baseline, the sensitivity, and the convergence.

        Raises ImportError, with what to install, where matplotlib is missing.
        """
        from .figure import plot_tuning

        return plot_tuning(self, dark=dark)

    def __str__(self) -> str:
        """A table: what was won, and of each parameter the baseline's, the best, and what a step away from it costs."""
        trials, unit = self.trials, f" {self.unit}" if self.unit else ""
        head = f"{'':14}{'baseline':>12}{'tuned':>12}" + (f"{'-10 %':>12}{'+10 %':>12}" if self.sensitivity else "")
        lines = [
            f"{self.objective} of {self.arm!r} along {self.path!r}",
            f"{self.value:.5g}{unit}, {self._against()}",
            f"{len(trials)} schemes tried, {trials.feasible.sum()} feasible, {len(self.front)} on the Pareto front",
            "",
            head,
        ]
        before = flat(self.baseline)
        for name, value in flat(self.scheme).items():
            steps = "".join(f"{_change(step):>12}" for step in self.sensitivity.get(name, ()))
            lines.append(f"{name:14}{before[name]:12.4g}{value:12.4g}{steps}")
        if self.sensitivity:
            lines += ["", f"-10 %, +10 %: what such a step of one parameter, of alpha 0.05, adds to {self.objective}"]
        return "\n".join(lines)

    def _against(self) -> str:
        if np.isnan(self.baseline_value):
            return "where the baseline is infeasible"
        share = f"{100 * self.improvement:.3g} % below " if self.baseline_value else "against "
        return f"{share}the baseline's {self.baseline_value:.5g}"

    def __repr__(self) -> str:
        return f"<Tuning of {self.objective}: {self.value:.5g}, {self._against()}; {self.scheme!r}>"


class TuneInterrupted(KeyboardInterrupt):
    """A tuning was stopped by Ctrl-C.

    Attributes
    ----------
    tuning : Tuning or None
        What was found until then; None where no feasible scheme was.
    """

    def __init__(self, tuning: Tuning | None, tried: int) -> None:
        super().__init__(f"interrupted after {tried} schemes")
        self.tuning = tuning


def _change(step: float) -> str:
    """A change of the objective, as the table has it."""
    return "-" if np.isnan(step) else "infeasible" if np.isinf(step) else f"{step:+.2e}"
