"""Finished motions, and what becomes of them: files and back, replays, tables, datasets, bags."""

from .load import load
from .run import Run
from .status import RunStatus

__all__ = ["Run", "RunStatus", "load"]
