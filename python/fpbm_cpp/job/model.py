"""A job: an arm, a path, a scheme and how to run them, as a file or options say it."""

from typing import Annotated, Any, Literal, Optional

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from .._core import Arm, JointLimits
from .arms import AnyArm
from .explain import explain
from .paths import AnyPath, Circle
from .schemes import FPBM, AnyScheme
from .section import Numbers, Section


class RunOptions(Section):
    """How a motion is run."""

    task: Literal["position", "pose"] = Field(default="position", description="What the tip keeps to.")
    q0: Optional[Numbers] = Field(
        default=None, description="Joint positions at the start [rad]; a ready posture unless given."
    )
    qd0: Optional[Numbers] = Field(
        default=None, description="Joint velocities at the start [rad/s]; at rest unless given."
    )
    dt: float = Field(default=1e-3, description="Step [s].")
    hold: float = Field(default=0.0, description="How long to stay on the path's end [s].")


class Limits(Section):
    """Joint limits to be kept: the arm's own, but for what is given here, for each joint or for all."""

    lower: Optional[Numbers] = Field(
        default=None, description="Lowest joint positions [rad], the arm's own unless given."
    )
    upper: Optional[Numbers] = Field(
        default=None, description="Highest joint positions [rad], the arm's own unless given."
    )
    velocity: Optional[Numbers] = Field(
        default=None, description="Highest joint speeds [rad/s], the arm's own unless given."
    )
    acceleration: Optional[Numbers] = Field(
        default=None, description="Highest joint accelerations [rad/s^2], the arm's own unless given."
    )

    def build(self, arm: Arm) -> JointLimits:
        """The limits, for this arm."""
        own = arm.limits
        names = ("lower", "upper", "velocity", "acceleration")
        return JointLimits(**{name: self._of(arm, name, getattr(own, name)) for name in names})

    def _of(self, arm: Arm, name: str, own: Any) -> Any:
        value = getattr(self, name)
        if value is None:
            return own
        return np.full(arm.dof, value) if isinstance(value, float) else value


def _pieces(value: Any) -> Any:
    return [value] if isinstance(value, dict) else value


def _circle() -> list[AnyPath]:
    return [Circle()]


class Job(Section):
    """One motion. Several paths follow one another."""

    arm: AnyArm
    path: Annotated[list[AnyPath], BeforeValidator(_pieces), Field(min_length=1)] = Field(default_factory=_circle)
    scheme: AnyScheme = FPBM()
    run: RunOptions = RunOptions()
    limits: Optional[Limits] = None

    @classmethod
    def of(cls, table: dict[str, Any]) -> "Job":
        """The job that a table describes. Raises JobError, with everything that is wrong with it."""
        try:
            return cls.model_validate(table)
        except ValidationError as error:
            raise explain(error, cls, table) from None

    def with_scheme(self, options: dict[str, Any]) -> "Job":
        """This job with other options of its scheme. Raises JobError, as of() does."""
        table = self.model_dump(exclude_none=True)
        return Job.of({**table, "scheme": {**table["scheme"], **options}})

    def sections(self) -> dict[str, Section]:
        """Its sections by name."""
        paths = (
            {"path": self.path[0]}
            if len(self.path) == 1
            else {f"path[{i}]": piece for i, piece in enumerate(self.path)}
        )
        return {"arm": self.arm, **paths, "scheme": self.scheme, "run": self.run, "limits": self.limits or Limits()}
