"""Jobs: a motion as a file says it, checked key by key, and made real.

from fpbm_cpp.job import prepare, read_job
run = prepare(read_job("job.toml")).run()
"""

from .complaint import Complaint, JobError
from .file import read_job, read_table, write_job
from .model import Job
from .motion import Motion, prepare

__all__ = ["Complaint", "Job", "JobError", "Motion", "prepare", "read_job", "read_table", "write_job"]
