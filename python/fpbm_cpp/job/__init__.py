"""Jobs: motions that a file describes, checked key by key.

from fpbm_cpp.job import prepare, read_job
run = prepare(read_job("job.toml")).run()

A job is a table of plain data, as in TOML: arm, path, scheme, run, limits.
"""

from .motion import Motion, prepare, read_job, write_job
from .sections import JobError

__all__ = ["JobError", "Motion", "prepare", "read_job", "write_job"]
