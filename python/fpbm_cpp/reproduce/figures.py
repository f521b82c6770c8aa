"""Figures 1 to 8 of the paper."""

from io import BytesIO

from matplotlib.figure import Figure

from ..plot import plot_run
from .cases import NAMES, Case, Result

PANELS = ("arm", "axis_errors", "velocities", "accelerations")


def caption(case: Case) -> str:
    """Path, scheme and parameters in words."""
    if not case.fpbm:
        return f"{NAMES[case.path]} under MAN: minimum acceleration norm, no feedback"
    p = case.fpbm
    gains = f"k₁ = {p['k1']:g} s⁻¹, k₂ = {p['k2']:g} s⁻²"
    return f"{NAMES[case.path]} under FPBM: α = {p['alpha']}, W = {case.weights}, {gains}"


def make_figure(result: Result) -> Figure:
    """The figure of a case; the paper's figures of the tricuspid have no accelerations."""
    title = f"Fig. {result.case.figure}   {caption(result.case)}"
    return plot_run(result.run, title, PANELS[:3] if result.case.path == "tricuspid" else PANELS)


def rendered(drawn: Figure, kind: str) -> bytes:
    """The figure as 'png' or 'pdf': the same bytes every time."""
    file = BytesIO()
    drawn.savefig(file, format=kind, metadata={"CreationDate": None} if kind == "pdf" else None)
    drawn.set_layout_engine("none")  # The second file takes the layout of the first.
    return file.getvalue()
