"""All motions of a sweep, divided into chunks and put together again."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Status
from .._types import Array
from ..arms import Arm
from ..paths import Path
from ..schemes import Scheme
from .chunks import Chunk
from .simulation import LimitOptions, make_run, motion_options
from .sweep_result import Sweep

# A chunk's motions are a multiple of GROUP, the largest number of lanes. There are at least CHUNKS chunks, for many
# workers to share, of at most SAMPLES samples each, some tenths of a second of work. The number of workers plays no
# part, so that the results do not depend on it.
GROUP, CHUNKS, SAMPLES = 8, 64, 200_000

# By their numbers in the compiled part; the last, at -1, is that of a motion that was not run.
STATUSES = np.array([*Status, None], dtype=object)


@dataclass(frozen=True)
class Plan:
    """Every scheme from every start: motion i is of schemes[i // K] from starts[i % K], with K starts."""

    arm: Arm
    path: Path
    schemes: tuple[Scheme, ...]
    starts: Array
    dt: float
    hold: float
    task: str
    limited: LimitOptions | None
    motions: bool
    samples: int

    def __len__(self) -> int:
        return len(self.schemes) * len(self.starts)

    def parts(self) -> list[slice]:
        """The motions of each chunk, of one scheme unless its motions are too few to fill a chunk."""
        size = min(-(-len(self) // CHUNKS), max(1, SAMPLES // self.samples))
        size = GROUP * -(-size // GROUP)
        row = len(self) if len(self.starts) < size else len(self.starts)
        ends = range(row, len(self) + 1, row)
        return [slice(i, min(i + size, end)) for end in ends for i in range(end - row, end, size)]

    def chunk(self, part: slice) -> Chunk:
        """What a worker needs to run these motions."""
        law, start = np.divmod(np.arange(part.start, part.stop), len(self.starts))
        schemes, which = list(self.schemes[law[0] : law[-1] + 1]), (law - law[0]).tolist()
        how = self.dt, self.hold, self.task, self.motions, self.limited
        return Chunk(self.arm, self.path, schemes, which, self.starts[start], *how)

    def result(self, outcomes: NDArray[Any], arrays: list[Any]) -> Sweep:
        """The sweep of all outcomes, and of each motion's arrays if the whole motions are wanted."""
        shape = len(self.schemes), len(self.starts)
        status = STATUSES[outcomes["status"]]
        motions = np.full(len(self), None, dtype=object)
        if self.motions:
            limited = {} if self.limited is None else self.limited._asdict()
            for i in np.flatnonzero(outcomes["status"] >= 0):
                _, samples, time, _ = outcomes[i]
                k, j = divmod(i, len(self.starts))
                made_of = self.starts[j], self.arm, self.path, self.schemes[k], self.task
                options = {**motion_options(self.arm, self.dt, self.hold), **limited}
                motions[i] = make_run(status[i], float(time), int(samples), arrays[i], *made_of, options)
        summary = outcomes["summary"]
        return Sweep(
            status=status.reshape(shape),
            time=outcomes["time"].reshape(shape).copy(),
            motions=motions.reshape(shape) if self.motions else None,
            arm=self.arm,
            path=self.path,
            schemes=self.schemes,
            q0s=self.starts,
            task=self.task,
            **{name: summary[name].reshape(shape).copy() for name in summary.dtype.names or ()},
        )
