"""What is wrong with a job."""

from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import ParameterError
from .sections import SECTIONS, Table, known


class JobError(ValueError):
    """A job that cannot be run, and everything that is wrong with it.

    Attributes
    ----------
    errors : tuple of ParameterError
        One at least, named by their keys: 'path.radius'.
    """

    def __init__(self, *errors: ParameterError) -> None:
        super().__init__("\n".join(map(str, errors)))
        self.errors = errors


@contextmanager
def within(job: Table, section: str) -> Iterator[None]:
    """Say by the job's keys what the library refuses; this section's key goes before another's of that name."""
    try:
        yield
    except ParameterError as error:
        if error.name.partition(".")[0] in SECTIONS:
            raise JobError(error) from None
        for each in (section, *job):
            tables = job.get(each, {})
            kind = None if isinstance(tables, list) else tables.get("kind")
            if error.name in known(each, kind):
                raise JobError(error.within(each)) from None
        raise JobError(ParameterError(section, error.index, error.value, f"{section}: {error}")) from None
