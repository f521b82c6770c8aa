"""The claims of the paper, confirmed or corrected, and findings of our own; all numbers are computed here."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..motion.run import Run
from ..schemes import FPBM, MAN, Balanced, Scheme
from .cases import DT, NAMES, Paper, Result, of_figures

COARSE = 0.2  # Step of the coarse runs [s]: 50 steps over a path.
HOLD = 30.0  # [s]
CIRCLES = 20


@dataclass(frozen=True)
class Claim:
    """A statement, whether it holds, and the numbers that show it."""

    statement: str
    verdict: str
    evidence: str


def check_claims(paper: Paper, results: Sequence[Result]) -> list[Claim]:
    """All claims, the paper's first."""
    fpbm = FPBM(**paper.figure(2).fpbm)
    return [*_of_figures(paper, fpbm, results), *_of_remarks(paper, fpbm, results), *_ours(paper, fpbm, results)]


def _of_figures(paper: Paper, fpbm: FPBM, results: Sequence[Result]) -> Iterator[Claim]:
    """Claims of the paper on MAN and FPBM."""
    schemes = (MAN(), fpbm)
    man, ours = (paper.simulate("circle", s, dt=COARSE).error_norms()[0] for s in schemes)
    man_held, ours_held = (paper.simulate("circle", s, dt=COARSE, hold=HOLD).error_norms()[0][-1] for s in schemes)
    man_fine, ours_fine = (paper.simulate("circle", s).max_error() for s in schemes)
    yield Claim(
        "MAN's tip error diverges, FPBM's does not",
        _verdict(bool(man.max() > 10 * ours.max()) and man.argmax() == len(man) - 1 > ours.argmax()),
        f"Circle, the same RK4 with {len(man) - 1} steps (dt = {COARSE} s): MAN's error reaches {man.max():.1e} m, "
        f"{man.max() / ours.max():.0f} times FPBM's {ours.max():.1e} m. At T, MAN's error is {man[-1] / man.max():.0%} "
        f"of its maximum, FPBM's {ours[-1] / ours.max():.0%}. After {HOLD:g} s more at the target, MAN's error is "
        f"{man_held:.1e} m, FPBM's {ours_held:.1e} m. At 1 kHz, the largest errors are {man_fine:.1e} m and "
        f"{ours_fine:.1e} m.",
    )

    lower, numbers = _against_man(results, _peak)
    holds = [NAMES[path].lower() for path, ratio in lower.items() if ratio < 1]
    yield Claim(
        "FPBM's peak joint velocity is lower than MAN's",
        _verdict(len(holds) == len(lower), f"corrected (holds only on: {', '.join(holds) or 'no path'})"),
        f"Largest velocity of any joint, rad/s. {numbers}.",
    )

    lower, numbers = _against_man(results, _speed)
    yield Claim(
        "FPBM's final joint velocity is near zero, MAN's is not",
        _verdict(max(lower.values()) < 0.25),
        f"Norm of the final joint velocity, rad/s. {numbers}. A velocity near zero is not zero: see below.",
    )


def _of_remarks(paper: Paper, fpbm: FPBM, results: Sequence[Result]) -> Iterator[Claim]:
    """Claims of the paper on FPBM only."""
    run, *scaled = (paper.simulate("circle", replace(fpbm, weights=c * fpbm.weights)) for c in (1, 2, 1000))
    changes = [max(float(np.abs(getattr(s, a) - getattr(run, a)).max()) for a in ("q", "qd", "qdd")) for s in scaled]
    rows = sorted((r for r in results if r.case.row), key=lambda r: _speed(r.run))
    largest = max(rows, key=lambda r: sum(r.case.fpbm["weights"]))
    yield Claim(
        "Larger entries of W give smaller errors and final velocities (Remark 2)",
        _verdict(max(changes) > 1e-9, "corrected (only ratios matter)"),
        f"W → 2W changes q, qd and qdd over the whole motion by at most {changes[0]:.2g}, W → 1000W by "
        f"{changes[1]:.2g} (rad, rad/s, rad/s²). Norm of the final joint velocity in Tables 2 and 3, rad/s: "
        f"{' < '.join(f'{r.case.row} {_speed(r.run):.3f}' for r in rows)}. The largest entries, "
        f"{largest.case.weights}, have rank {rows.index(largest) + 1} of {len(rows)}: equal entries have no effect.",
    )

    moved, middle = _moved_on_hold(paper, fpbm), CIRCLES // 2
    runs, halved = chained(paper, fpbm), chained(paper, fpbm, dt=DT / 2)
    peaks = [_peak(run) for run in runs]
    apart = [float(np.abs(a.q[-1] - b.q[-1]).max()) for a, b in zip(runs, halved)]
    yield Claim(
        "A final joint velocity near zero is equivalent to zero",
        _verdict(moved < 0.01),
        f"FPBM of Fig. 2, target at rest for {HOLD:g} s after T: the tip is at rest, the joints move by {moved:.2f} "
        f"rad. Over {CIRCLES} circles, each from the end of the previous circle, the peak joint velocity grows from "
        f"{peaks[0]:.2f} to {max(peaks):.2f} rad/s (circle {np.argmax(peaks) + 1}). The motion becomes sensitive to "
        f"the step: with half the step, the end of circle 1 changes by {apart[0]:.0e} rad, of circle {middle} by "
        f"{apart[middle - 1]:.0e} rad, of circle {CIRCLES} by {apart[-1]:.1g} rad. The paper has no damping of the "
        "self-motion.",
    )

    both = [(r.case.printed_error, r.run.max_error()) for r in results if r.case.printed_error and r.case.fpbm]
    printed, ours = np.array(both).T
    yield Claim(
        "FPBM's tip error is about 1e-5 m",
        _verdict(bool(ours.max() > 0.1 * printed.min())),
        f"The printed errors, {printed.min():.1e} to {printed.max():.1e} m, are the tolerance of the paper's variable-"
        f"step solver: RK4 at 1 kHz gives {ours.min():.1e} to {ours.max():.1e} m. The printed errors "
        "contain no information on α or W.",
    )


def _ours(paper: Paper, fpbm: FPBM, results: Sequence[Result]) -> Iterator[Claim]:
    """Findings that are not in the paper."""
    damped = replace(fpbm, null_damping=2.0)
    moved = _moved_on_hold(paper, damped)
    runs = chained(paper, replace(damped, rest_posture=paper.q0, null_stiffness=1.0))
    ends = [float(np.abs(b.q[-1] - a.q[-1]).max()) for a, b in pairwise(runs)]
    yield Claim(
        "Null-space damping brings the joints to rest and does not change the task (not in the paper)",
        _verdict(moved < 0.01 and max(ends) < 1e-4),
        f"With null_damping = 2 s⁻¹, the joints move by {moved:.4f} rad in the same {HOLD:g} s. With the rest posture "
        f"q(0) too (null_stiffness = 1 s⁻²), circle 2 ends {ends[0]:.1e} rad from circle 1, and circle 3 "
        f"{ends[1]:.1e} rad from circle 2. In {CIRCLES} circles, no joint velocity is above "
        f"{max(map(_peak, runs)):.3f} rad/s and no tip error above {max(run.max_error() for run in runs):.1e} m.",
    )

    schemes = {
        "MAN": MAN(),
        "MAN with feedback": replace(fpbm, alpha=0.0),
        "balance without feedback": Balanced(fpbm.alpha, fpbm.weights),
        "FPBM": fpbm,
    }
    coarse = {name: paper.simulate("circle", scheme, dt=COARSE) for name, scheme in schemes.items()}
    man, feedback, balance, _ = coarse.values()
    yield Claim(
        "Feedback alone bounds the tip error, the balance alone lowers the final joint velocity (not in the paper)",
        _verdict(feedback.max_error() < man.max_error() / 10 and _speed(balance) < _speed(man) / 10),
        f"Largest tip error and norm of the final joint velocity, circle, dt = {COARSE} s. "
        f"{'; '.join(f'{name}: {run.max_error():.1e} m, {_speed(run):.3f} rad/s' for name, run in coarse.items())}.",
    )

    rows = [r for r in results if r.case.table == "1"]
    alphas, speeds, peaks = zip(*sorted((r.case.fpbm["alpha"], _speed(r.run), _peak(r.run)) for r in rows))
    final, peak = (", ".join(f"{v:.3f}" for v in values) for values in (speeds, peaks))
    yield Claim(
        "A larger alpha lowers the final joint velocity and raises the peak (not in the paper)",
        _verdict(bool(np.all(np.diff(speeds) < 0) and np.all(np.diff(peaks) > 0))),
        f"Table 1, α = {', '.join(map(str, alphas))}: norm of the final joint velocity {final} rad/s, peak velocity of "
        f"any joint {peak} rad/s.",
    )


def chained(paper: Paper, scheme: Scheme, dt: float = DT) -> list[Run]:
    """Circles one after another, each from the joint state at the end of the previous circle."""
    runs = [paper.simulate("circle", scheme, dt=dt)]
    for _ in range(CIRCLES - 1):
        runs.append(paper.simulate("circle", scheme, dt=dt, q0=runs[-1].q[-1], qd0=runs[-1].qd[-1]))
    return runs


def _against_man(results: Sequence[Result], measure: Callable[[Run], float]) -> tuple[dict[str, float], str]:
    """Ratio of FPBM's largest measure to MAN's for each path of the figures, and a sentence with all measures."""
    shown = of_figures(results)
    ratios, words = {}, []
    for man in (r for r in shown if not r.case.fpbm):
        path = man.case.path
        others = [r for r in shown if r.case.fpbm and r.case.path == path]
        ratios[path] = max(measure(r.run) for r in others) / measure(man.run)
        listed = ", ".join(f"{measure(r.run):.3f} (Fig. {r.case.figure})" for r in others)
        words.append(f"{NAMES[path]}: MAN {measure(man.run):.3f} (Fig. {man.case.figure}), FPBM {listed}")
    return ratios, "; ".join(words)


def _moved_on_hold(paper: Paper, scheme: Scheme) -> float:
    """Largest joint motion while the target is held after T [rad]."""
    run = paper.simulate("circle", scheme, hold=HOLD)
    start = len(run.t) - 1 - round(HOLD / DT)
    return float(np.abs(run.q[start:] - run.q[start]).max())


def _peak(run: Run) -> float:
    """Largest velocity of any joint [rad/s]."""
    return float(np.abs(run.qd).max())


def _speed(run: Run) -> float:
    """Norm of the final joint velocity [rad/s]."""
    return float(np.linalg.norm(run.qd[-1]))


def _verdict(holds: bool, otherwise: str = "corrected") -> str:
    return "confirmed" if holds else otherwise
