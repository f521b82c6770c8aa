"""The trials of a tuning, the best trial, and the result as text and figure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..arms import Arm
from ..paths import Path
from ..schemes import FPBM
from .search import TUNABLE, numbers, pareto_front, tunable, with_numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALPHA_STEP, STEP = 0.05, 0.1  # STEP is relative to the value.
NOT_FINITE = {"+nan": "-", "+inf": "infeasible"}


@dataclass(frozen=True, repr=False, eq=False)
class Trials:
    """T schemes and the results of their motions: arrays of shape (T,), in the order of the trials.

    value is the objective, NaN if the motion stopped early; peak_velocity [rad/s] and peak_acceleration [rad/s^2]
    belong to the fastest joint; error is the larger number of the tip's largest position error [m] and largest
    orientation error [rad]. A trial is feasible if its motion is complete, its objective finite, and its error within
    the tolerance.
    """

    schemes: NDArray[Any]
    value: Array
    peak_velocity: Array
    peak_acceleration: Array
    error: Array
    feasible: NDArray[np.bool_]

    @property
    def parameters(self) -> dict[str, Array]:
        """The schemes' parameters by name: arrays of shape (T,), and (T, n) for the weights."""
        return {name: np.array([getattr(scheme, name) for scheme in self.schemes]) for name in TUNABLE}

    def scores(self) -> Array:
        """The value of each trial; NaN if the trial is infeasible."""
        return np.where(self.feasible, self.value, np.nan)

    def peaks(self) -> Array:
        """Peak velocity and peak acceleration of each trial, shape (T, 2); NaN if the trial is infeasible."""
        pairs = np.column_stack([self.peak_velocity, self.peak_acceleration])
        return np.where(self.feasible[:, None], pairs, np.nan)

    def best(self) -> int:
        """Index of the first feasible trial with the least value; there must be a feasible trial."""
        return int(np.nanargmin(self.scores()))

    def __getitem__(self, which: Any) -> Trials:
        """Some of the trials: a slice, a mask, or an array of indices."""
        return Trials(*(getattr(self, field.name)[which] for field in fields(self)))

    def __len__(self) -> int:
        return len(self.schemes)

    def __repr__(self) -> str:
        return f"<{len(self)} trials, {int(self.feasible.sum())} feasible>"


def joined(parts: Sequence[Trials]) -> Trials:
    return Trials(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Trials)))


def sensitivity(scheme: FPBM, value: float, run: Callable[[Sequence[FPBM]], Trials]) -> dict[str, tuple[float, float]]:
    """Change of a scheme's value for a step down and a step up of each number; see Tuning.sensitivity."""
    steps: dict[tuple[str, int], FPBM] = {}
    for name, number in numbers(scheme).items():
        for sign in (-1, 1):
            alpha = min(max(number + sign * ALPHA_STEP, 0.0), 1.0)
            stepped = alpha if name == "alpha" else number * (1.0 + sign * STEP)
            if stepped != number:
                steps[name, sign] = with_numbers(scheme, {name: stepped})
    trials = run(list(steps.values()))
    added = dict(zip(steps, np.where(trials.feasible, trials.value - value, np.inf).tolist()))
    return {name: (added.get((name, -1), np.nan), added.get((name, 1), np.nan)) for name in numbers(scheme)}


@dataclass(frozen=True, repr=False, eq=False)
class Tuning:
    """The best scheme, its sensitivity, and the trials, starting with the baseline; arm, path, q0, task are the motion.

    sensitivity is the change of the objective for a step down and a step up of one parameter of the best scheme: 0.05
    for alpha, within [0, 1], and 10 % for all others. The change is NaN if the parameter cannot step, and infinite if
    the step is infeasible. After an interruption, sensitivity is empty. objective is a name; the unit of a user's
    function is empty.
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
        """The best of all feasible trials."""
        return cast(FPBM, self.trials.schemes[self.trials.best()])

    @property
    def value(self) -> float:
        """The objective of the best scheme."""
        return float(self.trials.value[self.trials.best()])

    @property
    def parameters(self) -> dict[str, Any]:
        """The tunable parameters of the best scheme, by the names of FPBM."""
        return tunable(self.scheme)

    @property
    def front(self) -> Trials:
        """The Pareto front of peak velocity and peak acceleration: feasible trials, sorted by peak velocity."""
        return self.trials[pareto_front(*self.trials.peaks().T)]

    @property
    def baseline(self) -> FPBM:
        """The scheme that the best is compared with."""
        return cast(FPBM, self.trials.schemes[0])

    @property
    def baseline_value(self) -> float:
        """The objective of the baseline; NaN if the baseline is infeasible."""
        return float(self.trials.scores()[0])

    @property
    def improvement(self) -> float:
        """Decrease from the baseline to the best, relative to the baseline's value; NaN if that value is NaN or 0."""
        before = self.baseline_value
        return (before - self.value) / abs(before) if before else np.nan

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
