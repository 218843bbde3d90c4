"""Show how far long work has come."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Union

#: Whether a terminal or a notebook shows the progress, or a callable that is called with the number
#: of paths that are done, the number expected in all, and what is being done.
Progress = Union[Callable[[int, int, str], object], bool, None]

#: What the engine calls with the progress, if anybody sees it.
Callback = Union[Callable[[int, int, str], object], None]

#: Work that takes less than this many seconds shows nothing.
SILENT_UNTIL = 2.0


@contextmanager
def shown(progress: Progress) -> Iterator[Callback]:
    """The callable that the engine calls with the progress; None if nobody sees it."""
    if callable(progress):
        yield progress
    elif progress and _is_seen():
        line = _Line()
        try:
            yield line.show
        finally:
            line.write("")
    else:
        yield None


def _is_seen() -> bool:
    """Whether standard error is a terminal or the output of a notebook."""
    stream = sys.stderr
    is_notebook = type(stream).__module__.startswith("ipykernel")
    return stream is not None and (is_notebook or stream.isatty())


class _Line:
    """A line that is written anew every second, which terminals and notebooks can do."""

    def __init__(self) -> None:
        self.begun, self.second, self.width = time.monotonic(), 0, 0

    def show(self, done: int, expected: int, stage: str) -> None:
        seconds = time.monotonic() - self.begun
        if seconds < SILENT_UNTIL or int(seconds) == self.second:
            return
        self.second = int(seconds)
        text = stage + (f": {done:,} of {expected:,} paths" if expected else "")
        text += f", {_clock(seconds)}"
        if 0 < done < expected:
            text += f", about {_clock(seconds * (expected / done - 1))} left"
        self.write(text)

    def write(self, text: str) -> None:
        """Replace the line by this text."""
        if text or self.width:
            text = text[: shutil.get_terminal_size().columns - 1]
            sys.stderr.write("\r" + text.ljust(self.width) + ("" if text else "\r"))
            sys.stderr.flush()
            self.width = len(text)


def _clock(seconds: float) -> str:
    return f"{seconds // 3600:.0f}:{seconds // 60 % 60:02.0f}:{int(seconds % 60):02}"
