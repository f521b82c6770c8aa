"""What a job may say: sections, the kinds of each, and their keys, as they are declared."""

from __future__ import annotations

from typing import Any, ClassVar

from .._types import OptionalArrayField
from ..arms import ARMS, JointLimits
from ..parameter import Data, Parameter, data, parameter
from ..paths import PATHS
from ..schemes import SCHEMES
from ..table import Makers, keys

Table = dict[str, Any]


@data
class RunOptions(Data):
    """How a motion is run."""

    kind: ClassVar[str] = "run"
    task: str = parameter(default="position", choices=("position", "pose"), help="What the tip keeps to.")
    q0: OptionalArrayField = parameter(default=None, shape="(n,)", unit="rad", help="Joint positions at the start.")
    qd0: OptionalArrayField = parameter(default=None, shape="(n,)", unit="rad/s", help="Joint velocities at the start.")
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
    return keys(maker) if maker else {}


def in_order(section: str, said: Any) -> Any:
    """A section with its keys in the order of their declarations."""
    if isinstance(said, list):
        return [in_order(section, each) for each in said]
    return {key: said[key] for key in ("kind", *known(section, said.get("kind"))) if key in said}
