"""What a job may say: sections, the kinds of each, and their keys, as they are declared."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

from .._types import OptionalArrayField
from ..arms import ARMS, JointLimits
from ..parameter import Data, Parameter, data, parameter
from ..paths import PATHS
from ..schemes import SCHEMES
from ..table import Makers, keys, to_table

Table = dict[str, Any]


@data
class RunOptions(Data):
    """How a motion is run."""

    kind: ClassVar[str] = "run"
    task: str = parameter(default="position", choices=("position", "pose"), help="What the tip keeps to.")
    q0: OptionalArrayField = parameter(
        default=None, shape="(n,)", unit="rad", help="Joint positions at the start; a ready posture unless given."
    )
    qd0: OptionalArrayField = parameter(
        default=None, shape="(n,)", unit="rad/s", help="Joint velocities at the start; at rest unless given."
    )
    dt: float = parameter(default=1e-3, unit="s", low=0.0, open_low=True, help="Step.")
    hold: float = parameter(default=0.0, unit="s", low=0.0, help="How long to stay on the path's end.")


# What each section may be. Of runs and limits there is but one kind, which no file says.
SECTIONS: dict[str, Makers] = {
    "arm": ARMS,
    "path": PATHS,  # Or a list of tables, of paths one after another.
    "scheme": SCHEMES,
    "run": {RunOptions.kind: RunOptions},
    "limits": {JointLimits.kind: JointLimits},
}
FREE = {"path": "circle", "scheme": "fpbm"}  # The kind that is taken where the section is missing.


def known(section: str, kind: object = None) -> dict[str, Parameter]:
    """The keys of a section of this kind; none where there is no such kind."""
    maker = SECTIONS[section].get(section if section in SECTIONS[section] else str(kind))
    found = keys(maker) if maker else {}
    if section != "limits":
        return found
    return {name: replace(each, default=None, shape=f"{each.shape} or ()") for name, each in found.items()}


def tidy(section: str, said: Any) -> Any:
    """A section that is sound as a file has it: keys in the order of their declarations, numbers and lists of them."""
    if isinstance(said, list):
        return [tidy(section, each) for each in said]
    kind = {"kind": said["kind"]} if section in FREE or section == "arm" else {}
    declared = known(section, said.get("kind")).values()
    return {**kind, **{each.name: _plain(each, said[each.name]) for each in declared if each.name in said}}


def _plain(declared: Parameter, value: Any) -> Any:
    return to_table(declared.check(value)) if declared.shape or declared.type is float else value
