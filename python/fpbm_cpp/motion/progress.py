"""Progress of something long, as its caller wants to see it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

Progress: TypeAlias = bool | Callable[[int, int], object] | None


@contextmanager
def reporting(progress: Progress, total: int) -> Iterator[Callable[[int], object]]:
    """A function to call with how many of the total are done.

    progress: True for a bar on the terminal or in a notebook, or what to call with (done, total). Raises ImportError,
    with what to install, where the bar's library is missing.
    """
    if callable(progress):
        yield lambda done: progress(done, total)
    elif progress:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError('progress=True needs tqdm: pip install "fpbm_cpp[progress]"') from None
        with tqdm(total=total, unit="motion") as bar:
            yield lambda done: bar.update(done - bar.n)
    else:
        yield lambda done: None
