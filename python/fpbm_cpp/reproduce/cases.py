"""The data of the paper: the arm, the paths, and the 18 motions with printed and correct numbers."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

import numpy as np

from .._types import Array
from ..arms import PlanarArm
from ..motion.run import Run
from ..motion.simulation import simulate
from ..paths import PATHS, Path
from ..schemes import FPBM, MAN, Scheme
from ..table import from_table

DT = 1e-3  # [s]
NAMES = {"circle": "Circle", "lissajous": "Lissajous figure", "tricuspid": "Tricuspid"}


@dataclass(frozen=True)
class Case:
    """One motion of the paper: its printed numbers, and the last sample of an independent solution."""

    path: str  # 'circle', 'lissajous' or 'tricuspid'.
    reference_q: Sequence[float]  # [rad]
    reference_qd: Sequence[float]  # [rad/s]
    fpbm: Mapping[str, Any] = field(default_factory=dict)  # Parameters of FPBM; empty for MAN.
    table: str | None = None  # '1' or '2, 3'.
    row: str | None = None
    figure: int = 0
    printed_qd: Sequence[float] | None = None  # Final joint velocities [rad/s].
    printed_error: float | None = None  # Largest tip error [m].
    misprinted_joint: int = 0  # Joint with a misprinted velocity, 1 to n; 0: none.

    @property
    def scheme(self) -> Scheme:
        """MAN, or FPBM with the case's parameters."""
        return FPBM(**self.fpbm) if self.fpbm else MAN()

    @property
    def weights(self) -> str:
        """'diag(1, 2, 3, 4)'; empty for MAN."""
        return f"diag({', '.join(map(str, self.fpbm['weights']))})" if self.fpbm else ""


@dataclass(frozen=True, eq=False)
class Paper:
    source: str
    arm: PlanarArm
    q0: Array
    paths: Mapping[str, Path]
    errata: Sequence[Mapping[str, Any]]  # A text, and the printed posture [deg] or radius of the circle [m].
    cases: Sequence[Case]

    def simulate(self, path: str, scheme: Scheme, **options: Any) -> Run:
        """A motion from the paper's start; options as for fpbm_cpp.simulate."""
        return simulate(self.arm, self.paths[path], scheme, **{"q0": self.q0, "dt": DT, **options})

    def figure(self, number: int) -> Case:
        """The case that a figure shows."""
        return next(case for case in self.cases if case.figure == number)


@dataclass(frozen=True, eq=False)
class Result:
    """A case and its run in this package."""

    case: Case
    run: Run

    @property
    def from_reference(self) -> float:
        """Largest difference of final positions [rad] and velocities [rad/s] from the independent solution."""
        reference = [self.case.reference_q, self.case.reference_qd]
        return float(np.abs([self.run.q[-1], self.run.qd[-1]] - np.array(reference)).max())

    @property
    def from_printed(self) -> float | None:
        """Largest difference of final velocities from the printed values [rad/s], without misprints."""
        if self.case.printed_qd is None:
            return None
        good = np.arange(1, len(self.case.printed_qd) + 1) != self.case.misprinted_joint
        return float(np.abs(self.run.qd[-1] - self.case.printed_qd)[good].max())


def load() -> Paper:
    """The paper's set-up and numbers, from paper.json."""
    data = json.loads(files(__package__ or "fpbm_cpp.reproduce").joinpath("paper.json").read_text("utf-8"))
    return Paper(
        source=data["source"],
        arm=PlanarArm(data["links"]),
        q0=np.deg2rad(data["q0_degrees"]),
        paths={kind: from_table({"kind": kind, **shape}, PATHS) for kind, shape in data["paths"].items()},
        errata=data["errata"],
        cases=[Case(**case) for case in data["cases"]],
    )


def of_figures(results: Sequence[Result]) -> list[Result]:
    """The results that have a figure, in the figures' order."""
    return sorted((result for result in results if result.case.figure), key=lambda result: result.case.figure)
