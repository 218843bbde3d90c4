"""Show the progress of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Union

from .errors import wrong_argument

#: None for no display, True for a bar of tqdm, or a callable that is called with the number of
#: paths that are done and the number expected in all.
Progress = Union[Callable[[int, int], object], bool, None]


@contextmanager
def shown(progress: Progress) -> Iterator[Callable[[int, int], object] | None]:
    """The callable that the engine calls with the progress; a bar is open as long as the context
    is."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    else:
        try:
            from tqdm.auto import tqdm
        except ModuleNotFoundError:
            raise wrong_argument(
                "progress",
                progress,
                "tqdm is not installed",
                "pip install tqdm, or give a callable (done, expected)",
            ) from None
        with tqdm(unit="path", unit_scale=True) as bar:

            def tell(done: int, expected: int) -> None:
                bar.total = expected
                bar.update(done - bar.n)

            yield tell
